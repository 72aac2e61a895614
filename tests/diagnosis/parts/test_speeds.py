"""The same path run through faster: what is inertia grows with the square, damping with the speed, dry friction not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.model.library import load

SHOULDER = "joint.shoulder"

LAWS: dict[str, tuple[Mapping[str, float], int]] = {
    "payload": ({"mass_kg": 0.3}, 2),
    "quadratic_damping": ({"coefficient_Ns2_m2": 0.4}, 2),
    "viscous_friction": ({"coefficient_Ns_m": 0.4}, 1),
    "coulomb_friction": ({"force_N": 1.2}, 0),
    "preload": ({"force_N": 0.7}, 0),
}
"""Effect -> its numbers, and the power of the speed with which its torque grows."""


@pytest.fixture(scope="module")
def model() -> InverseDynamics:
    robot = load(ARM)
    grids = {"run": (arm_log(robot, 0, {}, noise=0.0, seconds=8.0), "motion", {})}
    logged = InverseDynamics(robot, (0.0, 0.0, -9.81), grids, ("shoulder", "elbow"), compared=["shoulder"])
    return logged.faster(1.0)  # its laws alone: where the joint may rest, friction asks the log of its drive


def torque(model: InverseDynamics, effect: str | None) -> np.ndarray:
    """What the model asks for of the shoulder, with an effect or without."""
    known = {s.label: s for s in model.sites()}
    made = hypothesis(model.believed, [known[effect, SHOULDER]] if effect else [])
    values = {f"{effect}@{SHOULDER}.{k}": v for k, v in LAWS[effect][0].items()} if effect else {}
    z = made.start(values)
    out = []
    for trial in model.trials:
        (block,) = model.predict(model.trial_mechanism(made, z, trial), trial, np.zeros(0)).blocks
        out.append(block.ravel())
    return np.concatenate(out)


@pytest.mark.parametrize("effect", LAWS)
@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_torque_grows_with_the_right_power_of_the_speed(model: InverseDynamics, effect: str, factor: float) -> None:
    other = model.faster(factor)
    usual = torque(model, effect) - torque(model, None)
    faster = torque(other, effect) - torque(other, None)
    assert np.abs(usual).max() > 1e-2
    np.testing.assert_allclose(faster, factor ** LAWS[effect][1] * usual, atol=1e-9 * np.abs(usual).max())


def test_weight_stays_and_all_else_of_a_rigid_body_grows_with_the_square(model: InverseDynamics) -> None:
    weight = 0.0 * torque(model, None)
    one, two, three = (torque(model.faster(f), None) - weight for f in (1.0, 2.0, 3.0))
    still = (4.0 * one - two) / 3.0
    np.testing.assert_allclose(three, still + 9.0 * (one - still), atol=1e-9 * np.abs(three).max())
    assert np.abs(still).max() > 1.0
    np.testing.assert_allclose(torque(model.faster(1e-6), None), still, atol=1e-9 * np.abs(still).max())


def test_an_added_inertia_pushes_against_the_acceleration(model: InverseDynamics) -> None:
    """m a, along the joint: a payload of one kilogram metre squared asks for as many newton metres as rad/s^2."""
    with_it = torque(model, "payload") - torque(model, None)
    asked = np.concatenate(
        [model.seen(t, 0.3 * model.measured(t).acceleration[:, model.joints.index("shoulder")]) for t in model.trials]
    )
    np.testing.assert_allclose(with_it, asked, atol=1e-9)


@pytest.mark.parametrize(
    ("effect", "asked"),
    [
        ("viscous_friction", lambda v: 0.4 * v),
        ("quadratic_damping", lambda v: 0.4 * np.abs(v) * v),
        ("coulomb_friction", lambda v: 1.2 * np.sign(v)),
        ("preload", lambda v: np.full_like(v, -0.7)),
    ],
)
def test_a_drive_is_asked_for_what_takes_from_the_motion(model: InverseDynamics, effect: str, asked: Any) -> None:
    """The measured torque balances the joint's own: with friction it is larger in the direction of motion.

    What leaps is seen through what the motion was seen through too.
    """
    found = torque(model, effect) - torque(model, None)
    at = model.joints.index("shoulder")
    wanted = []
    for trial in model.trials:
        motion = model.measured(trial)
        torques = asked(motion.velocity[:, at])
        wanted.append(model.seen(trial, motion.lens.blurred(torques) if effect == "coulomb_friction" else torques))
    np.testing.assert_allclose(found, np.concatenate(wanted), atol=1e-9)
