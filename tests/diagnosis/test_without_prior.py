"""A belief that the right set bends far is given up for it, one that it does not bend is kept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from spacerobot.diagnosis.answer.verdict import alternative
from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fit_store import task_name
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.starts import known_rows
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import without_prior as freed
from spacerobot.diagnosis.selection.judge import MARGIN, Judgement, judge, moved
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.decision import EARN, PENALTY
from spacerobot.diagnosis.terms.hypothesis import LOOSE
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, NOTHING_MISSING, WRONG_PARAMETER
from spacerobot.recordings.study import load_study
from tests.diagnosis.rigs import write_study

LABEL = (("low_pass", "force_sensor"),)
KEY = "low_pass@force_sensor.cutoff_Hz"
DAMPING = "wrist.equivalent_damping"


@pytest.fixture(scope="module")
def masked(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """A slow force sensor, and a c_eq far from the true one because it was fitted without knowing of it."""
    folder: Path = tmp_path_factory.mktemp("masked")
    planted = [("low_pass", "force_sensor", {"cutoff_Hz": 40.0})]
    return Workshop(write_study(folder, planted=planted, believed={DAMPING: 1.0}))


def fitted(shop: Workshop, label: Any = (), start: Any = None, **more: Any) -> Fit:
    fit = shop.run(Task(label, start or {}, **more))
    assert fit is not None
    return fit


def searched(shop: Workshop, monkeypatch: pytest.MonkeyPatch, *fits: Fit) -> Found:
    def run_tasks(pool: Pool, found: Found, tasks: Sequence[Task], *rest: Any) -> list[Task]:
        for task in tasks:
            found.keep(shop.run(task))
        return []

    monkeypatch.setattr(freed, "run_tasks", run_tasks)
    found = Found(fitted(shop))
    for fit in fits:
        found.keep(fit)
    freed.set_free(cast(Pool, None), found, lambda *a: None)
    return found


def test_a_constant_that_was_fitted_to_look_right_is_given_up(
    masked: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    bent = fitted(masked, LABEL, {KEY: 40.0})
    assert moved(bent) == (DAMPING,)
    fit = searched(masked, monkeypatch, bent).fits[LABEL]
    assert fit.hypothesis.freed == (DAMPING,)
    assert moved(fit) == (DAMPING,)
    assert fit.values()[DAMPING] == pytest.approx(5.0, rel=0.1)
    assert fit.values()[KEY] == pytest.approx(40.0, rel=0.05)
    assert score(fit) < score(bent)
    assert score(fit) == pytest.approx(fit.cost + 2 * PENALTY)  # of the effect's one number, and of the belief


def test_a_right_belief_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shop = Workshop(write_study(tmp_path, planted=[("low_pass", "force_sensor", {"cutoff_Hz": 40.0})]))
    right = fitted(shop, LABEL, {KEY: 40.0})
    assert searched(shop, monkeypatch, right).fits == {LABEL: right}


def test_a_freed_value_is_counted_in_stated_sigmas(masked: Workshop) -> None:
    bent = fitted(masked, LABEL, {KEY: 40.0})
    loose = fitted(masked, LABEL, near=bent, freed=(DAMPING,))
    index = loose.hypothesis.keys.index(DAMPING)
    assert loose.hypothesis.free[index].step == pytest.approx(LOOSE * bent.hypothesis.free[index].step)
    wanted = (loose.values()[DAMPING] - 1.0) / 0.15
    assert loose.hypothesis.sigmas(loose.z)[DAMPING] == pytest.approx(wanted)
    assert abs(bent.hypothesis.sigmas(bent.z)[DAMPING] - bent.z[index]) == 0.0


def test_derivatives_go_over_in_the_larger_steps(masked: Workshop) -> None:
    bent = fitted(masked, LABEL, {KEY: 40.0})
    loose = fitted(masked, LABEL, near=bent, freed=(DAMPING,)).hypothesis
    fitter = masked.fitter()
    rows = known_rows(fitter, loose, bent)
    assert rows is not None
    own = fitter.rows_at(bent)
    index = loose.keys.index(DAMPING)
    for trial, wide in rows.items():
        assert wide[:, index] == pytest.approx(LOOSE * own[trial][:, index])
        rest = np.delete(np.arange(wide.shape[1]), index)
        assert np.array_equal(wide[:, rest], own[trial][:, rest])


def test_what_is_freed_is_part_of_a_tasks_name(masked: Workshop) -> None:
    assert task_name(Task(LABEL, {})) != task_name(Task(LABEL, {}, freed=(DAMPING,)))


def judged(shop: Workshop, *fits: Fit) -> tuple[Judgement, Fit | None]:
    base = fitted(shop)
    out = moved(base)
    loose = fitted(shop, near=base, freed=out) if out else None
    found = Found(base)
    for fit in fits:
        found.keep(fit)
    left = Left((), 1.0)  # nothing but noise
    all_fits = [base, *fits, *([loose] if loose else [])]
    return judge(found, {id(f): left for f in all_fits}, loose, ()), loose


def test_one_effect_instead_of_several_wrong_values_is_ambiguous(tmp_path: Path) -> None:
    """A camera whose scale is off makes everything lighter at once."""
    path = write_study(tmp_path, planted=[("scale", "mocap", {"factor": 0.97})]).path
    text = path.read_text(encoding="utf-8").replace('"wrist.mass" = 0.01', '"wrist.mass" = 0.002')
    path.write_text(text, encoding="utf-8")
    shop = Workshop(load_study(path))
    scale = fitted(shop, (("scale", "mocap"),), {"scale@mocap.factor": 0.98})
    assert set(moved(fitted(shop))) == {"wrist.mass", "target.mass"}
    assert moved(scale) == ()
    judgement, loose = judged(shop, scale)
    assert judgement.verdict == AMBIGUOUS
    assert judgement.chosen is scale
    assert loose in judgement.alternatives
    assert loose is not None
    told = alternative(loose, scale)
    assert told.effects == []
    assert set(told.parameters) <= set(moved(loose))
    assert told.parameters


def test_a_scale_that_does_clearly_more_than_one_wrong_value_is_ambiguous_with_it(tmp_path: Path) -> None:
    shop = Workshop(write_study(tmp_path, planted=[("scale", "mocap", {"factor": 0.97})]))
    scale = fitted(shop, (("scale", "mocap"),), {"scale@mocap.factor": 0.98})
    judgement, loose = judged(shop, scale)
    assert loose is not None
    assert moved(loose) == ("target.mass",)
    assert MARGIN < score(loose) - score(scale) < EARN
    assert judgement.verdict == AMBIGUOUS
    assert judgement.alternatives == (scale, loose)


def test_one_wrong_value_stays_a_wrong_value(tmp_path: Path) -> None:
    shop = Workshop(write_study(tmp_path, truth={"wrist.mass": 0.77}))
    scale = fitted(shop, (("scale", "mocap"),), {"scale@mocap.factor": 0.98})
    judgement, _ = judged(shop, scale)
    assert judgement.verdict == WRONG_PARAMETER
    assert judgement.moved == ("wrist.mass",)


@pytest.mark.parametrize(("truth", "wrong"), [(0.604, True), (0.67, False)])
def test_a_value_that_holds_off_readings_which_tell_it_badly_is_wrong(
    tmp_path: Path, truth: float, wrong: bool
) -> None:
    """The fit stays near what is stated, for that is thought to be known better than the readings say."""
    shop = Workshop(write_study(tmp_path, truth={"wrist.mass": truth}, pressed=False, tracking=4e-4))
    base = fitted(shop)
    assert moved(base) == ()
    with Pool(shop, 1) as pool:
        loose = freed.baseline_freed(pool, base)
    left = {id(f): Left((), 1.0) for f in (base, loose) if f is not None}
    said = judge(Found(base), left, loose, ())
    assert (said.verdict, said.moved) == ((WRONG_PARAMETER, ("wrist.mass",)) if wrong else (NOTHING_MISSING, ()))
    if loose is not None:
        loud = {key: Left((), 3.0) for key in left}
        assert loose.values()["wrist.mass"] == pytest.approx(truth, rel=0.05)
        assert judge(Found(base), loud, loose, ()).verdict == NOTHING_MISSING


def test_a_damper_several_times_what_is_stated_is_the_one_value_that_is_wrong(tmp_path: Path) -> None:
    """Held off, it drags the spring and the masses with it; set free together with them it brings them back."""
    study = write_study(tmp_path, truth={DAMPING: 0.0, "wrist.damping": 14.0}, pressed=False)
    lines = study.path.read_text().splitlines(keepends=True)
    study.path.write_text("".join(line for line in lines if "equivalent_damping" not in line))
    shop = Workshop(load_study(tmp_path))
    base = fitted(shop)
    assert len(moved(base)) > 1
    with Pool(shop, 1) as pool:
        fit = freed.baseline_freed(pool, base)
    assert fit is not None
    assert fit.hypothesis.freed == ("wrist.damping",)
    assert fit.values()["wrist.damping"] == pytest.approx(14.0, rel=0.03)
    assert fit.prior < 6.0  # what is given up counts for nothing more
