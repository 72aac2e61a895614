"""Trials kept aside: nothing of them is known before they are predicted, what was taken from them is said."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.held_out import of_rig, of_rivals
from spacerobot.diagnosis.answer.record import written
from spacerobot.diagnosis.fitting.fit_store import again, plainly
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import intervals, unseen
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, HeldOut, folds, scheme_of
from spacerobot.diagnosis.selection.judge import Judgement, Rival
from spacerobot.diagnosis.selection.kept_aside import Fold, Unseen
from spacerobot.diagnosis.selection.rig_fold import Predictions, folded, hold_out
from spacerobot.diagnosis.selection.unseen import foretell, nothing_foretold, seen_sites
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.diagnosis.terms.kinds import NAMED, OPEN, OTHER, PART, SAME
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import SimulationError
from spacerobot.support.jsonio import plain
from tests.diagnosis.rigs import write_study

RUB = Site(effect("coulomb_friction"), "wrist")
RIVALS = [(Site(effect("asymmetric_friction"), "wrist"),), (Site(effect("adhesion"), "contact"),)]
TOLD = ("before", "after", "selected")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """Friction; two conditions of two trials; the spring put on anew for each."""
    folder = tmp_path_factory.mktemp("study")
    write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.35})])
    return with_scatter(folder)


def with_scatter(folder: Path) -> Workshop:
    file = folder / "study.toml"
    scatter = '[baseline.scatter]\n"wrist.stiffness" = 0.003\n[streams.mocap]'
    file.write_text(file.read_text().replace("[streams.mocap]", scatter, 1))
    return Workshop(load_study(folder))


def corrupted(workshop: Workshop, ids: Sequence[str]) -> Workshop:
    """The same study with other readings in some trials, about as large as the true ones."""
    random = np.random.default_rng(3)

    def other(block: Block) -> Block:
        return replace(block, value=1.03 * block.value + 20.0 / block.weight * random.standard_normal())

    again = Workshop(workshop.study)
    again.trials = tuple(
        replace(t, blocks=tuple(other(b) for b in t.blocks)) if t.id in ids else t for t in again.trials
    )
    again.model = again.make_model(again.study, again.trials)
    return again


def known_before(fold: Predictions) -> dict[str, Any]:
    """All of a fold but what is taken from the trials that are predicted."""
    told = {k: {n: getattr(getattr(fold, k), n) for n in ("label", "freed", "only", "values")} for k in TOLD}
    return {**told, "leads_to": fold.leads_to}


def test_a_fold_takes_back_what_it_does_not_show(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    """As all trials do: an effect whose interval there holds nothing is not what the fold leads to."""
    (_, out), _ = folds(workshop.trials)

    def holds_nothing(fit: Fit, key: str, inflation: float) -> tuple[float, tuple[float, float]]:
        return 0.0, (-1.0, 1.0)

    monkeypatch.setattr(intervals, "interval", holds_nothing)
    said = folded(workshop, out, [RUB], [], False)
    assert said.leads_to == PART
    assert said.selected.label == ()
    assert said.after.label  # the chosen set predicts all the same


def test_what_the_catalogue_was_to_do_without_no_fold_chooses(workshop: Workshop) -> None:
    """Friction of two levels that are one, and friction of one left out of what is looked for."""
    (_, out), _ = folds(workshop.trials)
    two = RIVALS[0][0]
    assert folded(workshop, out, [two], [], False).selected.label == (RUB.label,)
    said = folded(workshop, out, [two], [], False, [two.label])
    assert said.selected.label == (two.label,)
    assert said.leads_to == SAME


def test_readings_that_are_kept_aside_change_nothing_that_is_fitted_or_chosen(workshop: Workshop) -> None:
    """To the last bit."""
    (_, out), _ = folds(workshop.trials)
    true = folded(workshop, out, [RUB], RIVALS, True)
    false = folded(corrupted(workshop, out), out, [RUB], RIVALS, True)
    assert known_before(true) == known_before(false)
    starts, others = ({k: v.tolist() for k, v in fold.after.starts.items()} for fold in (true, false))
    assert starts != others  # these are theirs
    assert true.leads_to == SAME


@pytest.mark.parametrize("leak", ["their readings are fitted", "the start is the optimum of all"])
def test_a_leak_of_them_does(workshop: Workshop, leak: str, monkeypatch: pytest.MonkeyPatch) -> None:
    (_, out), _ = folds(workshop.trials)
    if leak == "their readings are fitted":
        monkeypatch.setattr(Workshop, "but_for", lambda self, out: self)
        said = [folded(w, out, [RUB], [], False) for w in (workshop, corrupted(workshop, out))]
    else:
        said = []
        for one in (workshop, corrupted(workshop, out)):
            whole = one.run(Task((RUB.label,), {RUB.key("force_N"): 0.2}, max_iterations=4))
            assert whole is not None
            monkeypatch.setattr("spacerobot.diagnosis.selection.refit._promising", lambda *a, at=whole: at.values())
            said.append(folded(one, out, [RUB], [], False))
    assert known_before(said[0]) != known_before(said[1])


def test_a_conditions_own_is_found_from_its_other_trials(workshop: Workshop) -> None:
    """What is judged tells nothing of itself but how it starts."""
    (_, out), _ = folds(workshop.trials)
    fit = workshop.but_for(out).run(Task((RUB.label,), {RUB.key("force_N"): 0.3}, max_iterations=8))
    assert fit is not None
    one, other = out
    clean = foretell(workshop.model, fit, [t for t in workshop.trials if t.id in out])
    spoilt = corrupted(workshop, [one])
    told = foretell(spoilt.model, fit, [t for t in spoilt.trials if t.id in out])
    assert told.own[one] == clean.own[one]  # from the other one, which is as it was
    assert told.own[other] != clean.own[other]
    assert clean.paid == {one: 0.0, other: 0.0}
    assert all(0.98 < value < 1.02 for own in clean.own.values() for value in own.values())


def test_of_a_lonely_trial_it_costs_what_its_prior_says(tmp_path: Path) -> None:
    """Least chi-squared plus prior is chi-squared with the condition's own marginalised: r^T (1 + J J^T)^-1 r."""
    write_study(tmp_path, planted=[("coulomb_friction", "wrist", {"force_N": 0.35})], speeds=(0.08,))
    workshop = with_scatter(tmp_path)
    lonely = workshop.trials[0]
    fit = workshop.but_for([lonely.id]).run(Task((RUB.label,), {RUB.key("force_N"): 0.3}, max_iterations=8))
    assert fit is not None
    told = foretell(workshop.model, fit, [lonely])
    ((key, value),) = told.own[lonely.id].items()
    assert told.paid[lonely.id] == pytest.approx(((value - 1.0) / 0.003) ** 2, rel=1e-6)
    row = told.residual(workshop.model, lonely)
    assert row is not None

    def cost(factor: float) -> float:
        moved = replace(told, own={lonely.id: {key: factor}}).residual(workshop.model, lonely)
        assert moved is not None
        return float(moved @ moved) + ((factor - 1.0) / 0.003) ** 2

    least = float(row @ row) + told.paid[lonely.id]
    assert least == pytest.approx(cost(value), rel=1e-9)
    assert min(cost(value - 0.001), cost(value + 0.001)) > least - 0.5  # the start is not found anew


def off_by(workshop: Workshop, shift: float, width: float) -> Fit:
    """A fit to the first trials, its friction off by so many standard deviations, each `width` of the friction."""
    rest = workshop.but_for(["10", "11"])
    fit = rest.run(Task((RUB.label,), {"coulomb_friction@wrist.force_N": 0.2}))
    assert fit is not None
    assert fit.covariance is not None
    k = fit.hypothesis.keys.index("coulomb_friction@wrist.force_N")
    sigma = width * 0.35 / fit.hypothesis.free[k].step
    z, covariance = fit.z.copy(), fit.covariance.copy()
    z[k] += shift * sigma
    covariance[k, :] = covariance[:, k] = 0.0
    covariance[k, k] = sigma**2
    return replace(fit, z=z, covariance=covariance)


def foretold(workshop: Workshop, fit: Fit) -> list[tuple[float, float | None]]:
    """Of the trials that were kept aside: squared error a sample, and the friction where a trial has its own."""
    trials = [t for t in workshop.trials if t.id in ("10", "11")]
    told, found = foretell(workshop.model, fit, trials), []
    for trial in trials:
        row = told.residual(workshop.model, trial)
        assert row is not None
        friction = told.own[trial.id].get("coulomb_friction@wrist.force_N")
        found.append((float(row @ row) / int(trial.valid.sum()), friction))
    return found


def test_a_trial_is_predicted_within_what_the_others_leave_open(workshop: Workshop) -> None:
    """Values off by less than the others' own uncertainty contradict nothing."""
    told = foretold(workshop, off_by(workshop, 1.5, 0.2))
    assert [error for error, _ in told] == pytest.approx([1.0, 1.0], abs=0.1)
    assert [f for _, f in told] == pytest.approx([0.35, 0.35], rel=0.25)


def test_values_that_the_others_are_sure_of_stay(workshop: Workshop) -> None:
    """However little they fit."""
    told = foretold(workshop, off_by(workshop, 60.0, 0.01))
    assert [f for _, f in told] == [None, None]
    assert min(error for error, _ in told) > 1.2


def test_a_trial_that_cannot_be_simulated_is_said_and_counts(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Against the set that cannot, as if it had predicted nothing."""
    usual, one = unseen._one, workshop.trials[0].id

    def fails(model: Any, fit: Any, trial: TrialData, rest: Any) -> Any:
        if trial.id == one and fit.hypothesis.sites:
            raise SimulationError("it would not")
        return usual(model, fit, trial, rest)

    whole = predicted(workshop)
    monkeypatch.setattr(unseen, "_one", fails)
    held = predicted(workshop)
    entry = written(of_rig(workshop.trials, held))
    assert {"trial": one, "model": "after", "why": "it would not"} in entry["failed"]
    assert held.after.failed == {one: "it would not"}
    assert not held.before.failed
    assert set(held.after.chi2) == {t.id for t in workshop.trials}
    nothing = nothing_foretold(workshop.trials[0])
    assert held.after.chi2[one] == pytest.approx(float(nothing @ nothing))
    assert held.after.total > held.before.total > whole.after.total
    assert not held.check().passed
    assert whole.check().passed


def predicted(workshop: Workshop) -> Unseen:
    """Friction as the chosen set of all trials."""
    fit = workshop.run(Task((RUB.label,), {RUB.key("force_N"): 0.3}, max_iterations=2))
    assert fit is not None
    with Pool(workshop, 1) as pool:
        held = hold_out(pool, Judgement(NAMED, 0.9, fit, (), (), ()))()
    assert held is not None
    return held


def test_what_was_done_is_said(workshop: Workshop) -> None:
    held = predicted(workshop)
    entry = written(of_rig(workshop.trials, held))
    assert entry["scheme"] == "leave one condition out"
    assert entry["same_set"] == 2 == len(entry["folds"])
    assert [f["left_out"] for f in entry["folds"]] == [["00", "01"], ["10", "11"]]
    assert entry["folds"][0]["selected"] == [{"effect": "coulomb_friction", "where": "wrist"}]
    assert entry["overall"]["rms_after"] == pytest.approx(entry["overall"]["rms_selected"])
    assert entry["overall"]["rms_after"] < 1.05 < entry["overall"]["rms_before"]
    assert entry["taken_from_unseen"] == list(held.taken)
    assert "wrist.stiffness, from its other trials" in held.taken[1]
    samples = {t.id: t.samples for t in workshop.trials}
    total = sum(f["rms_after"] ** 2 * sum(samples[t] for t in f["left_out"]) for f in entry["folds"])
    assert total == pytest.approx(entry["overall"]["chi2_after"])


def test_a_store_gives_back_the_same_to_the_last_bit(workshop: Workshop) -> None:
    (_, out), _ = folds(workshop.trials)
    there = folded(workshop, out, [RUB], [], False)
    back = again(json.loads(json.dumps(plain(plainly(there)))), Predictions)
    for trial in workshop.trials[:2]:
        for name in TOLD:
            rows = [getattr(f, name).residual(workshop.model, trial) for f in (there, back)]
            np.testing.assert_array_equal(*rows)
    assert plainly(back) == plainly(there)


def test_a_rival_predicts_what_was_kept_aside_too(workshop: Workshop) -> None:
    """Friction hidden: a tilted bed, fitted without the trials, foretells them worse than friction, and is told so."""
    fit = workshop.run(Task((RUB.label,), {RUB.key("force_N"): 0.3}, max_iterations=2))
    other = workshop.run(Task((("table_tilt", "target"),), {}, max_iterations=4))
    assert fit is not None
    assert other is not None
    with Pool(workshop, 1) as pool:
        held = hold_out(pool, Judgement(NAMED, 0.9, fit, (), (Rival(other, 50.0, ""),), ()))()
    assert held is not None
    told = of_rivals(workshop.trials, held)
    entry = of_rig(workshop.trials, held).overall
    assert set(told) == {other.hypothesis.label}
    assert told[other.hypothesis.label] > 1.1 * float(entry.rms_after or 0.0)


def test_a_knock_in_a_trial_kept_aside_is_foretold_by_nobody() -> None:
    knock = Site(effect("external_impulse"), "target", ("02",))
    assert seen_sites([RUB, knock], ["02", "03"]) == [RUB]
    assert seen_sites([RUB, knock], ["01"]) == [RUB, knock]


@given(st.lists(st.integers(0, 9), min_size=2, max_size=30))
def test_every_trial_is_left_out_once_and_no_condition_is_torn(conditions: list[int]) -> None:
    trials = [TrialData(str(k), str(c), {}, (), 0.0, 1.0) for k, c in enumerate(conditions)]
    scheme, sets = scheme_of(trials, MOST_FOLDS), [out for _, out in folds(trials, MOST_FOLDS)]
    assert sorted(id for s in sets for id in s) == sorted(t.id for t in trials)
    assert 2 <= len(sets) <= MOST_FOLDS
    if len(set(conditions)) > 1:
        where = {t.id: k for k, s in enumerate(sets) for t in trials if t.id in s}
        assert len({(t.condition, where[t.id]) for t in trials}) == len(set(conditions))
        assert "condition" in scheme
    assert ("every" in scheme) == (len({t.condition for t in trials if "condition" in scheme} or trials) > MOST_FOLDS)


def outcome(leads_to: Sequence[str], before: float, after: float, everywhere: bool = True) -> Unseen:
    """Folds of one trial each, with these errors in the first one and worse than before in those that tell nothing."""
    parts = tuple(Fold((str(k),), (), what) for k, what in enumerate(leads_to))
    silent = {str(k): 5.0 for k, what in enumerate(leads_to) if k and what not in (SAME, OPEN)}
    rest = {str(k): 0.0 for k in range(1, len(parts))}

    def errors(chi2: float, by: Mapping[str, float]) -> HeldOut:
        return HeldOut({k: np.zeros(1) for k in [*rest, "0"]}, {}, {**rest, "0": chi2, **by})

    return Unseen("", parts, errors(before, {}), errors(after, silent), errors(after, silent), everywhere)


@pytest.mark.parametrize(
    ("held", "passed"),
    [
        (outcome([SAME] * 4, 2.0, 1.0), True),
        (outcome([SAME, SAME, OTHER, OTHER], 2.0, 1.0), True),  # a half is no majority
        (outcome([SAME, OTHER, OTHER], 2.0, 1.0), False),
        (outcome([SAME, OPEN, OTHER, OTHER], 2.0, 1.0), True),
        (outcome([SAME, PART, PART], 2.0, 1.0), True),  # where less is known, less is shown
        (outcome([PART, PART, PART], 11.0, 1.0 - 1e-9), True),  # all have to do where none leads to it
        (outcome([PART, PART, PART], 11.0, 1.0), False),
        (outcome([SAME] * 4, 1.0, math.nextafter(1.0, 0.0)), True),
        (outcome([SAME] * 4, 1.0, 1.0), False),
        (outcome([SAME] * 4, 1.0, 1.0, everywhere=False), True),  # a knock in one trial foretells no other
    ],
)
def test_nothing_is_named_that_most_folds_contradict_or_that_predicts_no_better(held: Unseen, passed: bool) -> None:
    check = held.check()
    assert check.passed is passed
    assert check.detail


def test_nothing_foretold_is_the_spread_of_the_readings(workshop: Workshop) -> None:
    trial = workshop.trials[1]
    row, expected = nothing_foretold(trial), 0.0
    for channel in trial.channels:
        _, value, weight = trial.channel(channel)
        expected += float(np.var(value) * weight[0] ** 2 * value.size)
    assert float(row @ row) == pytest.approx(expected)


@pytest.mark.slow
def test_effects_that_are_not_there_predict_no_better_on_average(tmp_path: Path) -> None:
    """Though every one of them fits the trials that it has seen better than the baseline does."""
    gained, fitted = [], []
    forced = [("table_tilt", "target"), ("adhesion", "contact"), ("quadratic_damping", "wrist")]
    for seed in (1, 2, 3):
        folder = tmp_path / str(seed)
        folder.mkdir()
        workshop = Workshop(write_study(folder, seed=seed))
        base = workshop.run(Task((), {}))
        assert base is not None
        for name, where in forced:
            site = Site(effect(name), where)
            fit = workshop.run(Task((site.label,), {}, near=base, max_iterations=20))
            assert fit is not None
            fitted.append(base.cost - fit.cost)
            with Pool(workshop, 1) as pool:
                held = hold_out(pool, Judgement("ambiguous", 0.5, fit, (), (), ()))()
            assert held is not None
            gained.append(held.before.total - held.after.total)
    assert np.mean(gained) < 0.0 < np.mean(fitted)


def test_what_began_one_day_goes_on_in_trials_that_were_kept_aside(tmp_path: Path) -> None:
    """A force sensor that reads five per cent more from the third trial on; each condition has trials of both days."""
    study = write_study(tmp_path, masses=(9.0, 23.2, 51.0), speeds=(0.08,))
    later = ("10", "20")
    for name in later:
        path = tmp_path / f"{name}_force.csv"
        rows = np.loadtxt(path, delimiter=",", skiprows=1)
        rows[:, 1] *= 1.05
        np.savetxt(path, rows, "%.6f", ",", header="time_s,f_contact_N", comments="")
    workshop = Workshop(load_study(study.path))
    label = (("scale", "force_sensor"),)
    fit = workshop.run(Task(label, {}, max_iterations=30, only=((label[0], later),)))
    assert fit is not None
    with Pool(workshop, 1) as pool:
        held = hold_out(pool, Judgement("ambiguous", 0.5, fit, (), (), ()))()
    assert held is not None
    for trial in later:
        assert held.after.chi2[trial] < held.before.chi2[trial]


def test_what_is_known_of_values_is_the_inverse_of_their_covariance(workshop: Workshop) -> None:
    """Counted from a fit, nothing is off there; what rounding alone tells apart is not known."""
    fit = off_by(workshop, 0.0, 0.2)
    assert fit.covariance is not None
    about = fit.hypothesis.about(fit.z, fit.covariance)
    np.testing.assert_allclose(about.precision @ fit.covariance, np.eye(fit.z.size), atol=1e-6)
    assert about.values(np.zeros(fit.z.size)) == pytest.approx(fit.values())
    assert about.start(fit.values()) == pytest.approx(np.zeros(fit.z.size), abs=1e-9)
    alike = fit.covariance.copy()
    alike[0], alike[:, 0] = alike[1], alike[:, 1]
    alike[0, 0] = alike[0, 1] = alike[1, 0] = alike[1, 1]
    for none in (alike, np.full_like(alike, np.nan), -alike):
        with pytest.raises(np.linalg.LinAlgError):
            fit.hypothesis.about(fit.z, none)
