"""What a joint feels where the base floats: the torque that makes this very motion, by another algorithm."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.model.library import load

JOINTS = ("S1", "S2", "E1")


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 0.0, -9.80665), (3.0, -4.0, 8.0)])
def test_torques_of_a_floating_arm_are_those_that_moved_it(gravity: tuple[float, float, float]) -> None:
    """Forward dynamics (ABA), what carries the base added as a force on it, against the balance along the motion."""
    rng = np.random.default_rng(3)
    arm = Rigid(load("pa10", floating=True), gravity, JOINTS)
    model, data, free = arm.model, arm.data, arm._afloat
    for _ in range(5):
        position, velocity, acceleration = rng.normal(size=(3, len(JOINTS)))
        said = arm.torque(position[None], velocity[None], acceleration[None])[0]
        q, v, a = arm.written(position), np.zeros(model.nv), np.zeros(model.nv)
        v[arm.index], a[arm.index] = velocity, acceleration
        v[:6], a[:6] = arm._base(q, v, a)
        tau = pin.rnea(model, data, q, v, a)
        np.testing.assert_allclose(pin.aba(model, data, q, v, tau), a, atol=1e-8)
        np.testing.assert_allclose(free.T @ tau[:6], 0.0, atol=1e-9)  # nothing pushes where nothing carries
        np.testing.assert_allclose(tau[arm.index], said, atol=1e-9)
        momentum = pin.crba(model, data, q)
        whole = np.triu(momentum) + np.triu(momentum, 1).T
        np.testing.assert_allclose(free.T @ (whole @ v)[:6], 0.0, atol=1e-9)  # it began at rest
        if free.shape[1] == 3:
            up = free[3:, 2]
            turned = arm.torque(position[None], velocity[None], acceleration[None], np.array([0.7]))[0]
            v[:6], a[:6] = arm._base(q, v, a, 0.7)
            tau = pin.rnea(model, data, q, v, a)
            np.testing.assert_allclose(pin.aba(model, data, q, v, tau), a, atol=1e-8)
            np.testing.assert_allclose(free.T @ tau[:6], 0.0, atol=1e-9)
            np.testing.assert_allclose(tau[arm.index], turned, atol=1e-9)
            assert v[3:6] @ up == pytest.approx(0.7)
        held = Rigid(load("pa10", floating=False), gravity, JOINTS)
        assert np.abs(held.torque(position[None], velocity[None], acceleration[None])[0] - said).max() > 0.01


def test_a_joint_of_a_floating_arm_moves_less_than_a_held_one() -> None:
    poses = np.random.default_rng(4).normal(size=(20, len(JOINTS)))
    free, held = (Rigid(load("pa10", floating=f), (0.0, 0.0, 0.0), JOINTS).inertia(poses) for f in (True, False))
    assert np.all(np.linalg.eigvalsh(held - free) > -1e-9)
    assert np.all(np.linalg.eigvalsh(free) > 0.0)
