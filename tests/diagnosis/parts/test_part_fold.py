"""Trials of a part that are kept aside: nothing that is fitted or chosen knows them, and a set that fails them goes."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers_sliding import sliding
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.selection import part_fold
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.selection.kept_aside import Fold, Unseen
from spacerobot.diagnosis.selection.part_fold import decided, decided_without, keep_aside, settled
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.kinds import OPEN, OTHER, PART, SAME
from spacerobot.effects.registry import all_effects, effect
from spacerobot.support.errors import SimulationError

CATALOGUE = ("viscous_drag", "quadratic_drag", "coulomb_friction")


@pytest.fixture(scope="module")
def growth(tmp_path_factory: pytest.TempPathFactory) -> Growth:
    """A sliding body with drag that is plain to see, its noise unstated: weights come from what is left over."""
    study = sliding(tmp_path_factory.mktemp("study"), "viscous_drag", 0.4, stated=False)
    (model,) = models_for(study)
    return grow(model, effects=[effect(name) for name in CATALOGUE])


def other(block: Block) -> Block:
    """Readings about as large as the true ones."""
    noise = np.random.default_rng(3).standard_normal(block.value.shape)
    return replace(block, value=1.3 * block.value + 20.0 / block.weight * noise)


def corrupted(growth: Growth, out: Sequence[str]) -> Growth:
    """The same search with other readings in some trials, wherever its model keeps them."""

    def changed(trial: TrialData) -> TrialData:
        return replace(trial, blocks=tuple(other(b) for b in trial.blocks)) if trial.id in out else trial

    bench, model = copy(growth.bench), copy(growth.bench.model)
    assert isinstance(model, Simulated)
    model.trials = tuple(changed(t) for t in model.trials)
    model.recorded = {k: changed(t) for k, t in model.recorded.items()}
    model._starts = {}
    bench.model, bench.trials = model, tuple(changed(t) for t in bench.trials)
    return replace(growth, bench=bench)


def known_before(growth: Growth, out: Sequence[str]) -> Any:
    """All that is fitted and chosen in a fold, to the last bit."""
    said = decided(growth, out)
    fits = {k: None if f is None else (f.hypothesis.label, f.z.tobytes(), f.cost) for k, f in said.fits.items()}
    return fits, dict(said.weights), said.growth.after.label, [r.label for r in said.growth.rivals]


def test_readings_that_are_kept_aside_change_nothing_that_is_fitted_or_chosen(growth: Growth) -> None:
    out = ("s1",)
    assert growth.after.label == (("viscous_drag", "target"),)
    bad = corrupted(growth, out)
    assert known_before(growth, out) == known_before(bad, out)
    true, false = (decided_without(g, out)[1]["after"].residual["s1"] for g in (growth, bad))
    assert np.abs(true - false).max() > 1.0  # what is predicted wrong are these readings


@pytest.mark.parametrize("leak", ["trials", "weights"])
def test_a_leak_would_be_seen(growth: Growth, monkeypatch: pytest.MonkeyPatch, leak: str) -> None:
    def all_of_it(model: Machine, out: Sequence[str]) -> Machine:
        return model

    if leak == "trials":
        monkeypatch.setattr(type(growth.bench.model), "but_for", all_of_it)
    else:
        whole = part_fold.among

        def leaking(bench: Any, *rest: Any) -> Any:
            every = Bench(growth_now.bench.model)  # weights from what the baseline leaves over of all trials
            every.sharpen(every.baseline())
            bench.sharpen = lambda fit: setattr(bench, "weights", every.weights)
            return whole(bench, *rest)

        monkeypatch.setattr(part_fold, "among", leaking)
    found = []
    for growth_now in (growth, corrupted(growth, ("s1",))):
        found.append(known_before(growth_now, ("s1",)))
    assert found[0] != found[1]


def changed_window(model: Simulated, window: TrialData) -> Simulated:
    """The model of recordings that say something else in one window."""
    (whole,) = model.recorded.values()
    (block,) = whole.blocks
    value = np.where((block.time >= window.start) & (block.time < window.end), block.value + 1.0, block.value)
    again = copy(model)
    again.recorded, again._starts = {whole.id: replace(whole, blocks=(replace(block, value=value),))}, {}
    return again


@pytest.mark.parametrize("aside", range(4))
def test_a_window_begins_by_no_reading_that_is_kept_aside(tmp_path: Path, aside: int) -> None:
    """Of one slide cut into windows; of what is not kept aside the readings before a window tell how it begins."""
    (model,) = models_for(sliding(tmp_path, "viscous_drag", 0.4, speeds=(0.4,)))
    assert isinstance(model, Simulated)
    assert len(model.trials) == 4
    out = model.trials[aside]
    again = changed_window(model, out)
    one, other = (m.but_for([out.id]) for m in (model, again))
    assert {t.id: one.nuisances(t) for t in one.trials} == {t.id: other.nuisances(t) for t in other.trials}
    parts = one.in_windows((out.end - out.start) / 2).trials
    assert parts
    assert not any(p.start < out.end - 1e-6 and out.start < p.end - 1e-6 for p in parts)
    if aside < 3:  # the whole model knows it
        after = model.trials[aside + 1]
        assert model.nuisances(after) != again.nuisances(again.trials[aside + 1])


def test_every_trial_is_predicted_once_and_better(growth: Growth) -> None:
    unseen = keep_aside(growth)
    ids = [t.id for t in growth.bench.model.trials]
    assert sorted(t for f in unseen.folds for t in f.out) == sorted(ids) == sorted(unseen.after.residual)
    assert len(unseen.leading_to(SAME)) == len(unseen.folds)
    assert unseen.check(whole=False).passed
    assert unseen.after.mean_square < 0.1 * unseen.before.mean_square
    for id in ids:
        assert np.array_equal(unseen.after.residual[id], unseen.selected.residual[id])


def test_what_cannot_be_fitted_counts_as_its_mean_and_is_listed(
    growth: Growth, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*args: Any) -> Any:
        raise SimulationError("made to fail")

    monkeypatch.setattr(part_fold, "among", none)
    fold, told = decided_without(growth, ("s1",))
    assert fold.leads_to == OTHER
    assert all(h.failed == {"s1": "made to fail"} for h in told.values())
    (trial,) = [t for t in growth.bench.trials if t.id == "s1"]
    (block,) = trial.blocks
    assert np.allclose(told["after"].residual["s1"], ((block.value.mean() - block.value) * block.weight).ravel())


ERRORS = st.floats(0.1, 2.0)
FOLD = st.tuples(st.sampled_from([SAME, OPEN, PART, OTHER]), ERRORS, ERRORS)


@given(st.lists(FOLD, min_size=1, max_size=6))
def test_what_predicts_no_better_or_is_not_found_again_is_not_named(folds: list[tuple[str, float, float]]) -> None:
    """Each fold one trial, which the baseline leaves one sigma of; edges too: half of the folds, and the same error.

    Where most folds choose otherwise, what they choose must not predict their trials as well.
    """
    ids = [f"t{k}" for k in range(len(folds))]
    counted = {i: np.ones(1, dtype=bool) for i in ids}
    before = HeldOut({i: np.ones(1) for i in ids}, counted)
    after, selected = (
        HeldOut({i: np.array([fold[k]]) for i, fold in zip(ids, folds, strict=True)}, counted) for k in (1, 2)
    )
    parts = tuple(Fold((i,), (), fold[0]) for i, fold in zip(ids, folds, strict=True))
    strays = [(x, own) for what, x, own in folds if what == OTHER]
    agreed = 2 * len(strays) <= len(folds) or sum(x**2 for x, _ in strays) < sum(own**2 for _, own in strays)
    telling = [x for what, x, _ in folds if what in (SAME, OPEN)] or [x for _, x, _ in folds]
    better = any(sum(x**2 for x in some) < len(some) for some in (telling, [x for _, x, _ in folds]))
    assert Unseen("", parts, before, after, selected).check(whole=False).passed == (agreed and better)


@pytest.mark.parametrize(("found", "its_error"), [(4, 0.5), (3, 0.5), (2, 0.5), (4, 1.0)])
def test_no_more_is_named_than_most_folds_find_where_that_foretells_better(
    growth: Growth, monkeypatch: pytest.MonkeyPatch, found: int, its_error: float
) -> None:
    """`found` of four folds choose viscous drag alone, which leaves so much of their trials; the whole set leaves 1."""
    more = next(c for c in growth.considered if len(c.sites) == 2 and growth.after.label[0] in c.label)
    chosen, ids = replace(growth, after=more), [t.id for t in growth.bench.trials]
    counted = {i: np.ones(1, dtype=bool) for i in ids}
    errors = [HeldOut({i: np.array([x]) for i in ids}, counted) for x in (2.0, 1.0, its_error)]
    said = [(growth.after.label, PART)] * found + [(more.label, SAME)] * (4 - found)
    folds = tuple(Fold((i,), label, to) for i, (label, to) in zip(ids, said, strict=True))
    true = part_fold.keep_aside
    monkeypatch.setattr(part_fold, "keep_aside", lambda g: Unseen("", folds, *errors) if g is chosen else true(g))
    fewer, unseen = settled(chosen)
    if found > 2 and its_error < 1.0:
        assert fewer.after.label == growth.after.label
        assert more.label in fewer.refused
        assert len(unseen.leading_to(SAME)) == 4
    else:
        assert fewer is chosen


def test_the_verdict_says_what_was_decided_without_what_it_predicts(tmp_path: Path) -> None:
    study = sliding(tmp_path, "viscous_drag", 0.4)
    held = diagnose(study, jobs=1, without=[n for n in all_effects() if n not in CATALOGUE]).verdict["held_out"]
    assert [f["leads_to"] for f in held["folds"]] == [SAME] * 4
    assert held["same_set"] == 4
    assert held["overall"]["rms_selected"] == held["overall"]["rms_after"] < 1.3
    assert held["failed"] == []
