from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.dynamics.mobility import by_forward_dynamics, by_inverse, by_split
from spacerobot.dynamics.regime import Regime
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.robot import Robot
from tests.dynamics.support import DEFAULT, REGIMES, directions, poses, robot, turn, with_base

ROBOTS = ["pa10", "pa10c", "pa10_wrist", "chaser_pa10_wrist", "panda"]


def disagreement(model: Robot, q: np.ndarray, n: np.ndarray, regime: Regime, frame: str | None) -> float:
    """Largest difference between the three routes, relative to the largest mobility."""
    terms = terms_of(model, q, regime, frame)
    inverse = by_inverse(terms)[:3, :3]
    split = by_split(terms)[:3, :3]
    force = by_forward_dynamics(model, q, n, regime, frame)
    largest = max(np.linalg.norm(inverse, 2), 1e-300)
    along = n @ inverse @ n
    return max(abs(along - n @ split @ n), abs(along - force)) / largest


@pytest.mark.parametrize("regime", REGIMES, ids=str)
@pytest.mark.parametrize("name", ROBOTS)
def test_three_routes_agree(name: str, regime: Regime) -> None:
    model = robot(name)
    if regime.base == "free" and not model.floating:
        model = robot(name, floating=True)
    frames = [None] + ([model.contact] if model.contact else [])
    singular = np.zeros(len(model.chain))
    near = singular + 1e-7
    for pose in [*poses(model, 4), singular, near]:
        q = model.configuration(pose)
        for n in directions(2):
            for frame in frames:
                assert disagreement(model, q, n, regime, frame) < 1e-10


def test_routes_agree_at_any_base_attitude() -> None:
    model = robot("chaser_pa10_wrist")
    quaternion = np.array([0.3, -0.5, 0.1, 0.7])
    q = with_base(model, model.configuration(DEFAULT), quaternion, np.array([1.0, -2.0, 3.0]))
    for n in directions(3):
        assert disagreement(model, q, n, Regime("free", "free"), None) < 1e-10
    level = by_inverse(terms_of(model, model.configuration(DEFAULT), Regime("free", "free")))
    tilted = by_inverse(terms_of(model, q, Regime("free", "free")))
    both = np.kron(np.eye(2), turn(quaternion))
    np.testing.assert_allclose(tilted, both @ level @ both.T, rtol=1e-10, atol=1e-12)


def test_the_check_notices_a_missing_rotor_inertia() -> None:
    model = robot("pa10")
    bare = model.model.copy()
    bare.armature = np.zeros(bare.nv)
    wrong = replace(model, model=bare)
    q, n, regime = model.configuration(DEFAULT), np.array([1.0, 0.0, 0.0]), Regime("fixed", "free")
    right = n @ by_inverse(terms_of(model, q, regime))[:3, :3] @ n
    assert abs(by_forward_dynamics(wrong, q, n, regime) - right) > 0.2 * right


def test_locked_joints_make_one_body() -> None:
    """H_b of the locked robot is the composite body's mass and inertia."""
    model = robot("chaser_pa10_wrist")
    q = model.configuration(DEFAULT)
    h = joint_space_inertia(model, q)[:6, :6]
    total = sum(inertia.mass for inertia in model.model.inertias)
    np.testing.assert_allclose(h[:3, :3], total * np.eye(3), rtol=1e-14, atol=1e-12)
    import pinocchio as pin

    data = model.model.createData()
    pin.forwardKinematics(model.model, data, q)
    whole = pin.Inertia.Zero()
    for joint in range(1, model.model.njoints):
        whole += data.oMi[joint].act(model.model.inertias[joint])
    np.testing.assert_allclose(h, whole.matrix(), rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(
        by_inverse(terms_of(model, q, Regime("free", "locked", "locked"), "spacecraft")),
        np.linalg.inv(whole.matrix()),
        rtol=1e-11,
        atol=1e-15,
    )
