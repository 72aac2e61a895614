"""Torque balances where the motion's noise is loud, where its log is late, and where what is missing has no name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.clear_width import clear_width
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.diagnosis.terms.kinds import NOTHING_MISSING, UNKNOWN
from spacerobot.effects.registry import effect
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.study import Study
from tests.diagnosis.parts.helpers_axis import STEP, followed

OFFERED = ("joint_flexibility", "viscous_friction", "coulomb_friction", "time_offset", "low_pass")


def chosen(study: Study) -> Candidate:
    (model,) = models_for(study)
    return grow(model, effects=[effect(n) for n in OFFERED]).after


def noisy(place: float, torque: float, step: float = 0.002, seconds: float = 40.0) -> Grid:
    """A sine of 2 rad/s and the force that moves 3 kg so, with white noise."""
    random, time = np.random.default_rng(0), np.arange(0.0, seconds, step)
    q, u = 0.3 * np.sin(2.0 * time), -3.0 * 1.2 * np.sin(2.0 * time)
    values = {
        "joint.j.position": q + place * random.standard_normal(time.size),
        "joint.j.torque": u + torque * random.standard_normal(time.size),
    }
    return Grid(time, step, values, np.ones(time.size, dtype=bool))


@settings(deadline=None, max_examples=20)
@given(st.floats(-5.0, -3.0), st.floats(-1.5, -0.3))
def test_at_its_width_the_motion_asks_for_no_more_noise_than_the_torque_shows(place: float, torque: float) -> None:
    """By the noise alone, seen through that bump: inertia times acceleration, and the torque's own."""
    grid, still = noisy(10.0**place, 10.0**torque), noisy(0.0, 0.0)
    width = clear_width([grid], "j", {"j": 3.0})
    bump = Bump.of(max(round(width / grid.step), 3), grid.step)
    q, u = (grid.value[f"joint.j.{k}"] - still.value[f"joint.j.{k}"] for k in ("position", "torque"))
    asked, shown = 3.0 * np.std(bump.acceleration(q)), np.std(bump.smooth(u))
    whole = np.sqrt(np.mean(grid.value["joint.j.torque"] ** 2))
    if bump.half > 12:  # of fewer samples a bump is no smooth one
        assert asked < 1.3 * max(shown, 0.005 * whole)
    assert clear_width([noisy(2.0 * 10.0**place, 10.0**torque)], "j", {"j": 3.0}) > width


@pytest.mark.slow
def test_no_link_swings_behind_a_motor_whose_encoder_is_noisy(tmp_path: Path) -> None:
    """What smooths the motion's noise predicts better than the truth, where that noise is what is left over."""
    study = followed(tmp_path, viscous=9.0, noise=1e-4, mass='"unknown"')
    verdict = diagnose(study, jobs=1).verdict
    assert [(e["effect"], e["where"]) for e in verdict["effects"]] == [("viscous_friction", "joint.j")]


def test_a_link_that_is_damped_past_swinging_is_none() -> None:
    """Critical: c = 2 sqrt(k J)."""
    made, sizes = effect("joint_flexibility"), Sizes(1.0, 1.0, 1.0)
    values = {"link_inertia_kg_m2": 0.25, "stiffness_N_m": 100.0}
    assert not made.implausible({**values, "damping_Ns_m": 9.99}, sizes)
    assert made.implausible({**values, "damping_Ns_m": 10.01}, sizes)


def test_an_encoder_that_is_late_is_named_with_its_sign(tmp_path: Path) -> None:
    """In one log, what is read of the torque is early beside the place."""
    after = chosen(followed(tmp_path, viscous=9.0, late=-5))
    assert after.label == (("time_offset", "log"), ("viscous_friction", "joint.j"))
    assert after.fit.values()["time_offset@log.delay_s"] == pytest.approx(-5.5 * STEP, rel=0.05)


@pytest.mark.parametrize(("late", "where"), [pytest.param(6, "drive", marks=pytest.mark.slow), (-5, "log")])
def test_of_two_streams_the_late_one_is_named(late: int, where: str, tmp_path: Path) -> None:
    """A held command is early by half a sample, whatever else."""
    after = chosen(followed(tmp_path, viscous=9.0, late=late, apart=True))
    assert after.label == (("time_offset", where), ("viscous_friction", "joint.j"))
    assert after.fit.values()[f"time_offset@{where}.delay_s"] == pytest.approx(5.5 * STEP, rel=0.05)


def test_a_moment_stays_within_its_sample_whatever_it_explains(tmp_path: Path) -> None:
    (model,) = models_for(followed(tmp_path, viscous=9.0, late=6))
    free = model.moment_free()
    assert free is not None
    ((name, most),) = free.believed.within.items()
    assert most == pytest.approx(STEP)
    assert most == pytest.approx(MOVED * model.moment[name])
    (own,) = (f for f in hypothesis(free.believed, ()).free if f.key == name)
    assert (own.value(-1e6), own.value(1e6)) == (-most, most)
    assert not hypothesis(replace(free.believed, absolute={}), ()).free


def test_more_inertia_and_a_torque_that_reads_too_much_are_both_said_beside_friction(tmp_path: Path) -> None:
    """Of friction nobody knows the level: one and the same, whatever a beam kept."""
    (model,) = models_for(followed(tmp_path, dry=1.5, viscous=4.0, reads=1.2))
    offered = ("coulomb_friction", "viscous_friction", "payload", "scale")
    growth = grow(model, effects=[effect(n) for n in offered])
    found = {frozenset(c.label) for c in (growth.after, *growth.rivals)}
    friction = {("coulomb_friction", "joint.j"), ("viscous_friction", "joint.j")}
    assert {frozenset(friction | {one}) for one in (("payload", "joint.j"), ("scale", "log"))} <= found


@pytest.mark.parametrize(("ripple", "said"), [(1.5, UNKNOWN), (0.0, NOTHING_MISSING)])
def test_quiet_logs_of_which_a_good_part_is_left_are_not_explained(ripple: float, said: str, tmp_path: Path) -> None:
    """Where no noise is stated the logs' own scatter is what a right model may leave."""
    (model,) = models_for(followed(tmp_path, ripple=ripple))
    free = model.moment_free()
    assert free is not None
    assert Part(grow(free, effects=[effect("coulomb_friction")])).verdict == said


@pytest.mark.slow
def test_a_ripple_is_learned_where_nothing_of_the_catalogue_shows(tmp_path: Path) -> None:
    """Cogging: no effect of the catalogue explains any of it, and no noise is stated that it would stand out of."""
    verdict = diagnose(followed(tmp_path, ripple=1.5), jobs=1).verdict
    assert verdict["verdict"] == "learned"
    (law,) = verdict["learned"]
    assert law["where"] == "joint.j"
    overall = verdict["held_out"]["overall"]
    assert min(overall["rms_after"], overall["rms_selected"]) < 0.3 * overall["rms_before"]
