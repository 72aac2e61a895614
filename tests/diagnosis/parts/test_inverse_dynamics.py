"""Torque balance along measured motion: planted friction comes back, a right model is left alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from helpers_models import ARM, arm_log, in_own_unit, real_study
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.part_verdict import furthest_moved
from spacerobot.diagnosis.fitting.descent import SETTLED
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import floor_of, reweighted
from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.measured import port_forces, through_sensor
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.held_out import folds
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.candidates import plainest
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.catalogue.coulomb_friction import level as coulomb
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Friction
from spacerobot.model.library import load
from spacerobot.support.errors import NotFoundError

GRAVITY = (0.0, 0.0, -9.81)
PLANTED = {"shoulder": (1.2, 0.4, 0.0), "elbow": (0.0, 0.0, 0.0)}


def model_of(extra: dict[str, tuple[float, float, float]], joint: str) -> InverseDynamics:
    robot = load(ARM)
    grids = {f"run{n}": (arm_log(robot, n, extra), f"motion {n}", {}) for n in range(2)}
    return InverseDynamics(robot, GRAVITY, grids, ("shoulder", "elbow"), compared=[joint])


def fitted(model: InverseDynamics, *labels: tuple[str, str]) -> Fit:
    by = {s.label: s for s in model.sites()}
    made = hypothesis(model.believed, [by[label] for label in labels])
    fit = Fitter(model, model.trials).fit(made)
    return Fitter(model, heard(model, fit)).fit(made, warm=fit.values())


def heard(model: InverseDynamics, fit: Fit) -> tuple[TrialData, ...]:
    """Its trials under the noise that a fit leaves."""
    return reweighted(model.trials, floor_of(fit.residuals(), model.trials))


def errors(fit: Fit, keys: Sequence[str]) -> np.ndarray:
    """Standard errors of these values."""
    steps = np.array([f.slope(z) for f, z in zip(fit.hypothesis.free, fit.z, strict=True)])
    every = np.sqrt(np.diag(fit.covariance)) * steps
    return every[[fit.hypothesis.keys.index(key) for key in keys]]


@pytest.mark.parametrize("effect", ["coulomb_friction", "stribeck_friction", "quadratic_damping"])
def test_differences_to_both_sides_find_nothing_more_along_a_given_motion(effect: str) -> None:
    model = model_of(PLANTED, "shoulder")
    usual = fitted(model, (effect, "joint.shoulder"))
    usual, careful = (
        Fitter(model, heard(model, usual), careful=c).fit(usual.hypothesis, warm=usual.values()) for c in (False, True)
    )
    assert usual.converged
    assert usual.cost - careful.cost < SETTLED


def test_planted_friction_comes_back_within_its_error() -> None:
    place = "joint.shoulder"
    fit = fitted(model_of(PLANTED, "shoulder"), ("coulomb_friction", place), ("viscous_friction", place))
    found = np.array([fit.values()[f"{e}@{place}.{p}"] for e, p in _NAMES])
    error = errors(fit, [f"{e}@{place}.{p}" for e, p in _NAMES])
    assert np.abs(found - [1.2, 0.4]) == pytest.approx([0.0, 0.0], abs=0.02)
    assert (np.abs(found - [1.2, 0.4]) < 4.0 * error).all()


_NAMES = (("coulomb_friction", "force_N"), ("viscous_friction", "coefficient_Ns_m"))


def test_a_right_model_leaves_the_torque_noise_alone() -> None:
    """A residual as small as the noise seen through the test functions: the balance itself adds nothing."""
    model = model_of({}, "elbow")
    fit = fitted(model)
    state = Fitter(model, model.trials).state(fit.hypothesis, fit.z, {t.id: np.zeros(0) for t in model.trials})
    rest = in_own_unit(state, model.trials)
    assert np.sqrt(np.mean(rest**2)) < 0.02


def test_growth_names_what_was_planted_and_nothing_else() -> None:
    found = grow(model_of(PLANTED, "shoulder"))
    assert set(found.after.label) == {("coulomb_friction", "joint.shoulder"), ("viscous_friction", "joint.shoulder")}
    before, after = found.rms()
    assert after["joint.shoulder.torque"] < 0.05 * before["joint.shoulder.torque"]


def test_growth_adds_nothing_to_a_right_model() -> None:
    found = grow(model_of({}, "elbow"))
    assert found.after.label == ()
    assert found.rms()[0] == found.rms()[1]


def test_folds_are_conditions_then_parts() -> None:
    two = model_of({}, "elbow").trials
    assert [name for name, _ in folds(two)] == ["motion 0", "motion 1"]
    one = [t for t in two if t.condition == "motion 0"]
    parts = folds(one)
    assert len(parts) == 4
    assert sorted(i for _, ids in parts for i in ids) == sorted(t.id for t in one)


@pytest.mark.real
def test_emps_friction_against_the_published_values() -> None:
    """Janot, Gautier, Brunot (2019): M 95.1 kg, F_v 203.5, F_c 20.4 N, offset 3.2 N; relative error 4.1 % and 6.0 %."""
    (model,) = models_for(real_study("emps"))
    by = {s.label: s for s in model.sites()}
    names = ("coulomb_friction", "viscous_friction", "preload")
    made = hypothesis(model.believed, [by[(n, "joint.axis")] for n in names])
    seen = [t for t in model.trials if t.condition == "plain"]
    fit = Fitter(model, seen).fit(made)
    found = fit.values()
    assert found["joint.axis.mass"] == pytest.approx(95.1, rel=0.02)
    assert found["coulomb_friction@joint.axis.force_N"] == pytest.approx(20.4, rel=0.05)
    assert found["viscous_friction@joint.axis.coefficient_Ns_m"] == pytest.approx(203.5, rel=0.03)
    assert abs(found["preload@joint.axis.force_N"]) == pytest.approx(3.2, rel=0.1)
    state = Fitter(model, model.trials).state(made, fit.z, {t.id: np.zeros(0) for t in model.trials})
    for condition, limit in (("plain", 0.041), ("pulses", 0.054)):
        chosen = [t for t in model.trials if t.condition == condition]
        error = np.sum(in_own_unit(state, chosen) ** 2)
        assert np.sqrt(error / sum(np.sum(t.blocks[0].value ** 2) for t in chosen)) < limit


@pytest.mark.slow
@pytest.mark.real
def test_franka_joints_have_friction() -> None:
    models = models_for(real_study("franka_exciting"))
    assert [m.name for m in models] == [f"panda_joint{i}" for i in range(1, 8)]
    found = grow(models[6], most=2)
    # dry friction, whichever law has it: a drive that gives a little before it slides is Dahl's
    assert ("coulomb_friction", "joint.panda_joint7") in plainest(found.after.label)
    before, after = (x["joint.panda_joint7.torque"] for x in found.rms())
    assert before == pytest.approx(0.28, abs=0.03)
    assert after < 0.07


def test_a_link_that_is_heavier_than_its_urdf_says_is_weighed() -> None:
    """The forearm of the recorded arm weighs 1.3 kg; the believed one 1 kg, within a fifth or so."""
    real = load(
        ARM.replace('<mass value="1"/>\n    <inertia ixx="0.005"', '<mass value="1.3"/>\n    <inertia ixx="0.005"')
    )
    grids = {f"run{n}": (arm_log(real, n, {}), f"motion {n}", {}) for n in range(2)}
    doubts = {"link.fore.mass": 0.2, "link.upper.mass": 0.2}
    model = InverseDynamics(load(ARM), GRAVITY, grids, ("shoulder", "elbow"), compared=["elbow"], sigma=doubts)
    assert model.links == ("fore",)  # the elbow does not carry the upper arm
    fit = fitted(model)
    assert fit.values()["link.fore.mass"] == pytest.approx(1.3, abs=0.02)


def test_a_doubted_link_that_is_not_there_is_named() -> None:
    robot = load(ARM)
    grids = {"run": (arm_log(robot, 0, {}, seconds=4.0), "motion", {})}
    with pytest.raises(NotFoundError, match="hand"):
        InverseDynamics(robot, GRAVITY, grids, ("shoulder", "elbow"), sigma={"link.hand.mass": 0.1})


def misread(gain: float, bias: float, **believed: object) -> InverseDynamics:
    """A right model whose torque is logged in other units, with a zero of its own."""
    robot = load(ARM)
    grids = {}
    for n in range(2):
        grid = arm_log(robot, n, {})
        name = "joint.shoulder.torque"
        read = {**grid.value, name: (grid.value[name] + bias) / gain}
        grids[f"run{n}"] = (replace(grid, value=read), f"motion {n}", {})
    return InverseDynamics(robot, GRAVITY, grids, ("shoulder", "elbow"), compared=["shoulder"], **believed)  # type: ignore[arg-type]


def left_over(model: InverseDynamics, gain: float) -> float:
    """What the fitted baseline leaves, rms [N m]."""
    fit = fitted(model)
    state = Fitter(model, model.trials).state(fit.hypothesis, fit.z, {t.id: np.zeros(0) for t in model.trials})
    rest = in_own_unit(state, model.trials)
    return gain * float(np.sqrt(np.mean(rest**2)))


@settings(max_examples=4, deadline=None)
@given(st.floats(0.05, 40.0), st.floats(-2.0, 2.0))
def test_a_stated_motor_constant_and_zero_are_no_mismatch(gain: float, bias: float) -> None:
    """In whatever unit the torque is logged, what is left is its noise; left unsaid, it is not."""
    stated = {"joint.shoulder.gain": gain, "joint.shoulder.bias": bias}
    assert left_over(misread(gain, bias, values=stated), gain) < 0.02
    assert left_over(misread(2.0 * gain, bias, values=stated), 2.0 * gain) > 0.1


@given(st.floats(0.05, 40.0), st.floats(-2.0, 2.0))
def test_a_log_is_read_back_as_it_was_written(gain: float, bias: float) -> None:
    said = {"joint.a.gain": gain, "joint.a.bias": bias}
    true = np.linspace(-3.0, 3.0, 7)
    logs = through_sensor(torque_log.logged(said, "a"), true, 0.01)
    np.testing.assert_allclose(torque_log.torque(said, "a", logs), true, atol=1e-12)


def test_a_doubted_motor_constant_and_zero_come_back() -> None:
    """Believed within their sigmas and wrong, both are found within their errors; no effect takes their place."""
    names = ("joint.shoulder.gain", "joint.shoulder.bias")
    doubt = {"values": dict(zip(names, (2.1, 0.5), strict=True)), "sigma": dict(zip(names, (0.05, 0.5), strict=True))}
    model = misread(2.0, 0.8, **doubt)
    fit = fitted(model)
    found = np.array([fit.values()[n] for n in names])
    error = errors(fit, names)
    assert found == pytest.approx([2.0, 0.8], rel=0.01)
    assert (np.abs(found - [2.0, 0.8]) < 4.0 * error).all()
    told = furthest_moved([cast(Part, SimpleNamespace(fit=fit, model=model))], names)
    assert list(told) == ["joint.shoulder.bias", "joint.shoulder.gain"]  # the furthest first
    assert [told[n].in_sigmas for n in names] == pytest.approx([-0.1 / 0.105, 0.3 / 0.25], rel=0.15)
    assert ("preload", "joint.shoulder") not in {s.label for s in model.sites()}
    assert ("preload", "joint.shoulder") in {s.label for s in misread(2.0, 0.8).sites()}


def test_what_sticks_takes_what_is_asked_of_it_up_to_its_level() -> None:
    """A drive that winds up until its joint breaks away: friction follows the drive, and is no late or sluggish log."""
    time = np.arange(400) * 0.01
    drive = 2.0 * np.sin(1.5 * time)
    level = 1.2
    held = np.abs(drive) < level
    rate = np.where(held, 1e-9, np.sign(drive) * 0.3)
    mechanism = Mechanism(
        coordinates={"joint.j": Coordinate("joint.j", 1.0, angular=True)},
        ports={"joint.j": {"joint.j": 1.0}},
        forces=(),
        frictions=(Friction("friction", "joint.j", coulomb, (level,), steady=True),),
    )
    motion = {"joint.j": np.cumsum(rate) * 0.01}, {"joint.j": rate}
    told = port_forces(mechanism, *motion, 0.01, None, {"joint.j": (-drive, 0.01)})["joint.j"]
    np.testing.assert_allclose(told[held], -drive[held], atol=1e-12)
    np.testing.assert_allclose(told[~held], -level * np.sign(drive[~held]))
    blind = port_forces(mechanism, *motion, 0.01)["joint.j"]
    assert np.abs(blind[held] + drive[held]).max() > level
    asked = port_forces(mechanism, *motion, 0.01, None, {"joint.j": (-2.0 * drive, 0.01)})["joint.j"]
    assert np.abs(asked).max() <= level


def test_what_holds_takes_what_a_coupled_drive_leaves() -> None:
    """Wherever friction of the coupled drive stands in the list: at rest all forces together are what is asked."""
    time = np.arange(400) * 0.01
    asked, level, coupled = 0.3 * np.sin(1.5 * time), 1.2, 0.4
    still, other = np.full(400, 1e-9), np.cos(time)
    joints = ("joint.a", "joint.b")
    frictions = [
        Friction("own", "joint.a", coulomb, (level,), steady=True),
        Friction("coupling", "joint.b", coulomb, (coupled,), steady=True),
    ]
    motion = dict.fromkeys(joints, np.zeros(400)), dict(zip(joints, (still, other), strict=True))
    held = {"joint.a": (asked, 0.01), "joint.b": (np.zeros(400), 0.01)}
    for order in (frictions, frictions[::-1]):
        mechanism = Mechanism(
            coordinates={j: Coordinate(j, 1.0, angular=True) for j in joints},
            ports={"joint.a": {"joint.a": 1.0}, "joint.b": {"joint.b": 1.0, "joint.a": 1.0}},
            frictions=tuple(order),
        )
        acting = port_forces(mechanism, *motion, 0.01, None, held)
        np.testing.assert_allclose(acting["joint.a"] + acting["joint.b"], asked, atol=1e-12)
        alone = port_forces(mechanism, *motion, 0.01, None, held, joints)
        assert all(np.array_equal(alone[j], acting[j]) for j in joints)
