"""Machines under a recorded drive: from corner to corner exactly, where all that acts is straight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import StateSpace, lsim

from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Coordinate, Mechanism
from spacerobot.effects.primitives import Force, Input
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.affine import DRIVEN
from spacerobot.simulation.reduced.integrate import CORNERS
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.reduced.stepper import ORDER

MOTOR, LINK, DAMPING, STIFFNESS = 0.3, 0.5, 0.8, 90.0
STEP = 0.01


def driven(*, link: bool = True) -> Mechanism:
    """A motor that a recorded force pushes, and what it pushes through a spring."""
    coordinates = {"joint.motor": Coordinate("joint.motor", MOTOR)} | (
        {"joint.link": Coordinate("joint.link", LINK)} if link else {}
    )
    ports = {n: {n: 1.0} for n in coordinates} | (
        {"joint.between": {"joint.link": 1.0, "joint.motor": -1.0}} if link else {}
    )
    springs = (Force("spring", "joint.between", SPRING, (STIFFNESS,), role="spring"),) if link else ()
    damper = Force("damper", "joint.motor", DAMPER, (DAMPING,))
    drive = (Input("drive", "joint.motor", "command", 2.0),)
    return Mechanism(coordinates=coordinates, ports=ports, forces=(damper, *springs), inputs=drive)


def run(mechanism: Mechanism, drive: np.ndarray, step: float = STEP, **options: float) -> ReducedRun:
    time = step * np.arange(drive.size)
    return simulate(mechanism, end=float(time[-1]), inputs=(time, {"command": drive}), **options)


def exact(drive: np.ndarray, times: np.ndarray, stiffness: float = STIFFNESS) -> np.ndarray:
    """Positions of motor and link under a drive that is joined by lines, shape (T, 2)."""
    a = np.array(
        [
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [-stiffness / MOTOR, stiffness / MOTOR, -DAMPING / MOTOR, 0],
            [stiffness / LINK, -stiffness / LINK, 0, 0],
        ]
    )
    b = np.array([[0], [0], [2.0 / MOTOR], [0]])
    fine = np.interp(times, STEP * np.arange(drive.size), drive)
    return np.asarray(lsim(StateSpace(a, b, np.eye(2, 4), np.zeros((2, 1))), fine, times)[1])


DRIVES = st.lists(st.floats(-5.0, 5.0), min_size=8, max_size=120).map(np.array)


@settings(max_examples=40, deadline=None)
@given(DRIVES)
def test_from_corner_to_corner_it_is_exact(drive: np.ndarray) -> None:
    """At a loose tolerance too, between the corners as at them."""
    ours = run(driven(), drive, tolerance=1e-4)
    times = 0.5 * STEP * np.arange(2 * drive.size - 1)
    assert (ours.steps.order == DRIVEN).all()
    assert ours.positions(times) == pytest.approx(exact(drive, times), abs=1e-10)


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_a_stiff_link_stays_where_its_motor_takes_it(stiffness: float) -> None:
    """Its own motion, ten times and more within a step of the drive, grows out of nothing."""
    time = STEP * np.arange(400)
    drive = 3.0 * np.sin(2.0 * time)
    mechanism = driven()
    springs = tuple(replace(f, p=(stiffness,)) if f.name == "spring" else f for f in mechanism.forces)
    ours = run(replace(mechanism, forces=springs), drive, tolerance=1e-6)
    assert ours.positions(time) == pytest.approx(exact(drive, time, stiffness), abs=1e-7)


def test_a_drive_that_held_until_its_next_corner_would_be_seen() -> None:
    drive = np.random.default_rng(0).uniform(-5.0, 5.0, 100)
    times = STEP * np.arange(100)
    steps = np.repeat(drive, 2)[:-1]
    held = simulate(
        driven(),
        end=float(times[-1]),
        inputs=(np.repeat(times, 2)[1:] - 1e-9 * (np.arange(199) % 2 == 0), {"command": steps}),
    )
    assert np.abs(held.positions(times) - exact(drive, times)).max() > 1e-4


@pytest.mark.parametrize(
    "name", ["coulomb_friction", "asymmetric_friction", "backlash", "end_stop", "stribeck_friction"]
)
def test_it_is_what_the_general_method_says(name: str) -> None:
    """Which is asked where corners come more often than its steps: the same drive, with corners between its corners."""
    values = {
        "coulomb_friction": {"force_N": 1.5},
        "asymmetric_friction": {"force_plus_N": 2.0, "force_minus_N": 1.0},
        "backlash": {"half_gap_m": 0.01},
        "end_stop": {"travel_m": 0.05, "stiffness_N_m": 400.0},
        "stribeck_friction": {"static_force_N": 2.0, "coulomb_force_N": 1.0, "velocity_m_s": 0.1},
    }
    time = STEP * np.arange(300)
    drive = 4.0 * np.sin(9.0 * time) + np.cos(23.0 * time)
    mechanism = effect(name).apply(driven(), "joint.between" if name == "backlash" else "joint.motor", values[name])
    finer = 4 * CORNERS
    often = np.interp(STEP / finer * np.arange(finer * 299 + 1), time, drive)
    ours = run(mechanism, drive, tolerance=1e-9)
    general = run(mechanism, often, STEP / finer, tolerance=1e-11, max_step=STEP)
    assert (general.steps.order == ORDER).all()
    assert (ours.steps.order == DRIVEN).mean() > (0.0 if name == "stribeck_friction" else 0.9)  # it may stick
    assert ours.positions(time) == pytest.approx(general.positions(time), abs=1e-6)


@given(st.floats(0.5, 4.0), st.floats(3.0, 30.0))
@settings(max_examples=25, deadline=None)
def test_a_ramp_breaks_friction_when_it_reaches_its_level(level: float, slope: float) -> None:
    """And from there on what moves has the cube of the time: 2 (s t - f / 2)."""
    mechanism = replace(
        effect("coulomb_friction").apply(driven(link=False), "joint.motor", {"force_N": level}), forces=()
    )
    time = np.linspace(0.0, 2.0, 11)
    ours = run(mechanism, slope * time, 0.2, tolerance=1e-6)
    begins = level / (2.0 * slope)
    (when,) = ours.switches()
    assert when == pytest.approx(begins, abs=1e-9)
    since = np.clip(time - begins, 0.0, None)
    assert ours.positions(time)[:, 0] == pytest.approx(2.0 * slope * since**3 / (6.0 * MOTOR), rel=1e-7, abs=1e-9)


def test_what_acts_before_and_after_the_record_is_its_end() -> None:
    mechanism = driven(link=False)
    ours = simulate(mechanism, end=3.0, inputs=(np.array([1.0, 2.0]), {"command": np.array([1.0, 1.0])}))
    speed = ours.states(np.array([3.0]))[1][0, 0]
    assert speed == pytest.approx(2.0 / DAMPING * (1.0 - np.exp(-3.0 * DAMPING / MOTOR)), rel=1e-9)


def test_the_drives_work_is_accounted_for() -> None:
    time = STEP * np.arange(200)
    ours = run(driven(), np.sin(20.0 * time), tolerance=1e-6)
    x, v = ours.states(time[-1:])
    stored = ours.kinetic(v)[0] + 0.5 * STIFFNESS * (x[0, 1] - x[0, 0]) ** 2
    done = {n: w[-1] for n, w in ours.work().items()}
    assert done["inputs"] + done["damper"] == pytest.approx(stored, rel=1e-9)
    assert done["damper"] < 0.0 < done["inputs"]
