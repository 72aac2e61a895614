"""Machines too stiff for explicit steps: the collocated steps that take them obey the same laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.multibody.radau import NODES, A, C
from spacerobot.simulation.multibody.run import MultibodyRun, integrate_scene
from spacerobot.simulation.parts import Servo, Target, Wrist
from spacerobot.simulation.scene import Scene

SPEED, END = 0.07, 0.05
STIFF = Scene(
    "chaser_pa10_wrist",
    joints="servo",
    servo=Servo(stiffness=1e5, damping=1000.0),
    wrist=Wrist(stiffness=530.0, equivalent_damping=9.69),
    target=Target(mass=9.0, speed=SPEED),
)


def last(run: MultibodyRun) -> np.ndarray:
    """Configuration and velocity at the end, over what the approach makes of them."""
    q, v = run.dynamics.nq, run.dynamics.nv
    return run.steps.last[: q + v] / SPEED


def speed_after(scene: Scene) -> float:
    """Of the target at the end [m/s]."""
    run = integrate_scene(scene, END, tolerance=1e-9)
    return float(run.port("target", run.sample(np.array([END])).velocity)[0])


def test_the_method_integrates_polynomials_of_its_order() -> None:
    """Radau IIA: each node exactly to degree s - 1, the end to degree 2s - 2, and not beyond."""
    powers = np.arange(2 * NODES)
    at_end = np.abs(A[-1] @ C[:, None] ** powers - 1.0 / (powers + 1))
    assert at_end[:-1].max() < 1e-13 < 1e-9 < at_end[-1]
    inside = A @ C[:, None] ** powers[:NODES] - C[:, None] ** (powers[:NODES] + 1) / (powers[:NODES] + 1)
    assert np.abs(inside).max() < 1e-13
    # L-stable: what decays at once is gone at the step's end
    far = np.eye(NODES) + 1e12 * A
    assert abs(1.0 - 1e12 * A[-1] @ np.linalg.solve(far, np.ones(NODES))) < 1e-10


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_as_explicit_steps_short_enough_to_be_stable(tolerance: float) -> None:
    scene = replace(STIFF, servo=Servo(stiffness=1e4, damping=100.0))
    free = integrate_scene(scene, END, tolerance=tolerance)
    short = integrate_scene(scene, END, tolerance=1e-11, max_step=1e-4)
    assert free.steps.time.size < 0.5 * short.steps.time.size
    assert len(free.events) == len(short.events)
    assert np.abs(last(free) - last(short)).max() < tolerance
    times = np.linspace(0.0, END, 97)
    assert np.abs(free.sample(times).velocity - short.sample(times).velocity).max() < tolerance * SPEED


def test_halving_the_step_shows_the_order() -> None:
    """Of order s + 1 at least while the servos are far stiffer than a step resolves (Hairer and Wanner II, IV.15)."""
    scene = replace(STIFF, target=Target(mass=9.0, speed=SPEED, gap=0.0))
    end = 0.008
    exact = last(integrate_scene(scene, end, tolerance=1e-12))
    errors = [
        np.abs(last(integrate_scene(scene, end, max_step=h, first_step=h, fixed=True)) - exact).max()
        for h in (4e-3, 2e-3, 1e-3)
    ]
    assert errors[0] > 2.0**6 * errors[1] > 2.0**12 * errors[2]


def test_endlessly_stiff_servos_are_locked_joints() -> None:
    """What is left of the difference falls as the stiffness grows."""
    locked = speed_after(replace(STIFF, joints="locked", servo=None))
    found = [
        abs(speed_after(replace(STIFF, servo=Servo(stiffness=k, damping=1e-2 * k))) - locked) for k in (1e6, 1e7, 1e8)
    ]
    assert found[0] > 8.0 * found[1] > 64.0 * found[2]


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_momentum_and_energy(stiffness: float) -> None:
    servo = Servo(stiffness=stiffness, damping=1e-2 * stiffness)
    run = integrate_scene(replace(STIFF, servo=servo), 0.3, tolerance=1e-8)
    sample = run.sample(np.linspace(0.0, 0.3, 200))
    whole = np.abs(sample.momentum[0]).max()
    assert np.abs(sample.momentum - sample.momentum[0]).max() < 1e-8 * whole
    gained = sample.kinetic - sample.kinetic[0] - sample.work.sum(axis=1)
    assert np.abs(gained).max() < 1e-8 * sample.kinetic[0]
