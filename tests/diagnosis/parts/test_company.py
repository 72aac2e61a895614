"""A part has the same verdict alone and in company: what says nothing of it changes nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from helpers_balls import balls
from helpers_models import ARM, arm_log
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.check import COPIES, Check, agreed
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.selection.model_choice import Told, as_good, choice, pays, ratio
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import LOUD, WORTH_OF_REST
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.registry import all_effects, effect
from spacerobot.model.library import load
from spacerobot.recordings.study import Study

LIGHT, HEAVY = (0.05, 0.003), (8.0, 0.003)

READINGS = 20


@dataclass(frozen=True, eq=False)
class Tried:
    """As much of a candidate as its worth hangs on."""

    size: int
    held_out: HeldOut
    sites: tuple[Site, ...] = ()
    loud: float = 0.0

    @property
    def error(self) -> float:
        return float(np.sqrt(self.held_out.mean_square))


def tried(size: int, noise: np.ndarray, off: Sequence[float], silent: int) -> Candidate:
    """A candidate that predicts each trial wrong by so many standard deviations, and others as every candidate does."""
    wrong = np.concatenate([off, np.zeros(silent)])
    residual = {f"t{k}": own + w for k, (own, w) in enumerate(zip(noise, wrong, strict=False))}
    return cast(Candidate, Tried(size, HeldOut(residual, {k: np.ones(READINGS, bool) for k in residual})))


def noises(trials: int) -> np.ndarray:
    return np.random.default_rng(5).standard_normal((trials, READINGS))


def named(trials: int) -> list[TrialData]:
    return [TrialData(f"t{k}", "", {}, (), 0.0, 1.0) for k in range(trials)]


OFF = st.floats(0.0, 4.0)


@given(st.lists(st.tuples(OFF, OFF, OFF), min_size=1, max_size=5), st.integers(0, 40))
def test_trials_that_tell_no_two_models_apart_decide_nothing(
    told: list[tuple[float, float, float]], silent: int
) -> None:
    noise, count = noises(len(told) + silent), len(told)
    answers = []
    for more in (0, silent):
        baseline, one, other = (tried(k, noise, [t[k] for t in told], more) for k in range(3))
        trials = named(count + more)
        worth = (pays(one, baseline, trials), pays(other, baseline, trials), as_good(one, other, baseline))
        answers.append((*worth, choice([one, other], baseline, trials).size, round(ratio(one, other), 9)))
    assert answers[0] == answers[1]


def in_channels(size: int, noise: np.ndarray, off: Sequence[float], silent: np.ndarray) -> Candidate:
    """A candidate tried on trials with a further channel each, which every candidate predicts as well."""
    rows = zip(noise, off, silent, strict=True)
    residual = {f"t{k}": np.concatenate([own + w, beside]) for k, (own, w, beside) in enumerate(rows)}
    counted = {k: np.ones(r.size, bool) for k, r in residual.items()}
    cuts = dict.fromkeys(residual, (READINGS,) if silent.size else ())
    return cast(Candidate, Tried(size, HeldOut(residual, counted, cuts=cuts)))


@given(st.lists(st.tuples(OFF, OFF, OFF), min_size=1, max_size=5), st.floats(0.1, 100.0))
def test_channels_that_tell_no_two_models_apart_decide_nothing(
    told: list[tuple[float, float, float]], loud: float
) -> None:
    """A platform that does not turn says nothing against the friction that stops it, however noisy its compass is."""
    noise, answers, trials = noises(len(told)), [], named(len(told))
    for silent in (np.zeros((len(told), 0)), loud * noises(len(told))[:, ::-1]):
        baseline, one, other = (in_channels(k, noise, [t[k] for t in told], silent) for k in range(3))
        worth = (pays(one, baseline, trials), pays(other, baseline, trials), as_good(one, other, baseline))
        answers.append((*worth, round(ratio(one, other), 9)))
    assert answers[0] == answers[1]


@given(st.floats(2.0, 100.0), st.floats(1.0, 10.0))
def test_what_is_louder_than_the_stated_noise_is_not_as_good_as_what_is_not(bad: float, loud: float) -> None:
    """Friction beside a load of a hundred times its torque: without it twice the noise is left, with it the noise."""
    noise, trials = noises(4), 4
    size = 200.0 * bad
    baseline, one, other = (tried(k, noise, [off] * trials, 0) for k, off in enumerate((size, 2.0, 0.0)))
    stated = [cast(Candidate, replace(cast(Tried, c), loud=x)) for c, x in ((one, 1.0 + loud), (other, 1.0))]
    assert as_good(one, other, baseline), "where no noise is stated it is no effect worth naming"
    assert as_good(*stated, baseline) == (1.0 + loud <= LOUD)
    assert as_good(stated[1], stated[0], baseline)


def test_a_rule_that_pools_over_all_trials_would_be_turned_by_them() -> None:
    """What the test above would find: the error over all trials hardly falls where one of many tells everything."""
    noise = noises(41)
    old, new = (tried(k, noise, [off], 40) for k, off in enumerate((1.5, 0.0)))
    assert new.error > (1.0 - WORTH_OF_REST) * old.error
    assert ratio(new, old) < 0.7
    assert pays(new, old, named(41))


def test_a_trial_that_is_predicted_exactly_outweighs_no_other() -> None:
    """Seven trials in which a model does ten times better, and one, a joint at rest, of which it leaves nothing."""
    readings = np.full(8, 50.0)
    one, other = np.full(8, 0.01), np.full(8, 1.0)
    one[7] = 0.0
    told = Told(one, other, np.full(8, 1.0), readings)
    assert told.better(np.arange(8))
    worse = Told(np.append(np.full(7, 1.3), 0.0), other, np.full(8, 1.0), readings)
    assert not worse.better(np.arange(8))


def said(study: Study) -> dict[str, Any]:
    kept = ("quadratic_drag", "viscous_drag", "payload", "scale")
    return dict(diagnose(study, jobs=1, without=[n for n in all_effects() if n not in kept]).verdict)


def of(verdict: Mapping[str, Any], name: str) -> dict[str, Any]:
    (found,) = [p for p in verdict["parts"] if p["part"] == name]
    return {k: v for k, v in found.items() if k != "part"}


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.slow
def test_a_light_ball_lacks_its_drag_whatever_else_is_dropped(tmp_path: Path, stated: bool) -> None:
    alone = said(balls(tmp_path / "alone", {"light": LIGHT}, stated=stated))
    company = said(balls(tmp_path / "all", {"iron": HEAVY, "light": LIGHT, "lead": HEAVY}, stated=stated))
    assert of(company, "light") == of(alone, "light")
    assert of(company, "light")["verdict"] == "named"
    assert [(e["effect"], e["part"]) for e in company["effects"]] == [("quadratic_drag", "light")]
    assert {of(company, n)["verdict"] for n in ("iron", "lead")} == {"nothing_missing"}


@pytest.mark.parametrize(
    ("bad", "passed"), [((), True), ((0,), True), ((1, 2), True), ((0, 2), False), ((0, 1, 2), False)]
)
def test_no_single_draw_of_noise_takes_an_answer_back(bad: tuple[int, ...], passed: bool) -> None:
    asked: list[int] = []

    def copy(number: int) -> tuple[Check, ...]:
        asked.append(number)
        return (Check("a", True, ""), Check("b", number not in bad, "x"))

    found = {c.name: c.passed for c in agreed(copy)}
    assert found == {"a": True, "b": passed}
    assert asked == list(range(COPIES if 0 in bad else 1))


def test_what_is_missing_at_one_joint_says_nothing_of_another() -> None:
    """The elbow's own friction moves no digit of what is found at the shoulder."""
    robot = load(ARM)
    found = []
    for elbow in ((0.0, 0.0, 0.0), (2.0, 0.5, 0.3)):
        planted = {"shoulder": (1.2, 0.0, 0.0), "elbow": elbow}
        grids = {f"run{n}": (arm_log(robot, n, planted, seconds=8.0), f"motion {n}", {}) for n in range(2)}
        model = InverseDynamics(robot, (0.0, 0.0, -9.81), grids, ("shoulder", "elbow"), compared=["shoulder"])
        found.append(Part(grow(model, effects=[effect("coulomb_friction")])))
    one, other = found
    assert one.verdict == other.verdict == "named"
    assert one.fit.values() == other.fit.values()
    assert one.confidence == other.confidence
