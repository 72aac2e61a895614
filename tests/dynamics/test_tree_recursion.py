"""The compiled recursion over any tree of joints against Pinocchio's articulated-body algorithm."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.dynamics.tree_arrays import TreeArrays, TreeWork, tree_arrays
from spacerobot.dynamics.tree_recursion import recursion, tree_work
from spacerobot.support.errors import InputError

few = settings(max_examples=60, deadline=None, derandomize=True)
seeds = st.integers(0, 10**6)


def random_tree(rng: np.random.Generator) -> pin.Model:
    """Up to twelve joints of every kind, each on any earlier one; gravity oblique."""
    model = pin.Model()
    for i in range(int(rng.integers(1, 13))):
        axis = rng.normal(size=3)
        kinds = [
            pin.JointModelRX(),
            pin.JointModelRZ(),
            pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis)),
            pin.JointModelRUBY(),
            pin.JointModelPY(),
            pin.JointModelPrismaticUnaligned(axis / np.linalg.norm(axis)),
            pin.JointModelSpherical(),
            pin.JointModelFreeFlyer(),
        ]
        joint = model.addJoint(
            int(rng.integers(0, model.njoints)), kinds[rng.integers(len(kinds))], placement(rng), f"j{i}"
        )
        half = rng.normal(size=(3, 3))
        body = pin.Inertia(rng.uniform(0.1, 20.0), rng.normal(size=3), half @ half.T + np.eye(3))
        model.appendBodyToJoint(joint, body, placement(rng))
    model.armature = rng.uniform(0.0, 1.0, model.nv)
    model.gravity.linear = rng.normal(size=3) * 9.8
    return model


def placement(rng: np.random.Generator) -> pin.SE3:
    half = rng.normal(size=4)
    return pin.SE3(pin.Quaternion(half / np.linalg.norm(half)).toRotationMatrix(), rng.normal(size=3))


def state(model: pin.Model, rng: np.random.Generator, reach: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    turned = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv) * reach)
    return turned, rng.normal(size=model.nv) * 2.0


def evaluated(model: pin.Model, q: np.ndarray, v: np.ndarray) -> tuple[TreeArrays, TreeWork]:
    tree = tree_arrays(model)
    work = tree_work(tree)
    recursion(tree, work, q, v)
    return tree, work


@few
@given(seeds)
def test_accelerations_are_those_of_articulated_bodies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    model = random_tree(rng)
    q, v = state(model, rng)
    torque = rng.normal(size=model.nv) * 10.0
    wanted = pin.aba(model, model.createData(), q, v, torque)
    _, work = evaluated(model, q, v)
    found = np.linalg.solve(work.inertia, torque - work.load)
    assert np.abs(found - wanted).max() <= 1e-12 * np.linalg.cond(work.inertia) * max(1.0, np.abs(wanted).max())


@few
@given(seeds)
def test_jacobian_and_drift_move_every_body_as_pinocchio_does(seed: int) -> None:
    rng = np.random.default_rng(seed)
    model = random_tree(rng)
    q, v = state(model, rng)
    data = model.createData()
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    tree, work = evaluated(model, q, v)
    for i in range(model.njoints - 1):
        placed = data.oMi[i + 1]
        assert np.allclose(work.rotation[i].reshape(3, 3), placed.rotation, atol=1e-12)
        assert np.allclose(work.point[i] + work.place[i], placed.translation, atol=1e-11)
        about = pin.SE3(np.eye(3), work.point[i])
        assert np.allclose(work.speed[i], about.actInv(placed.act(data.v[i + 1])).vector, atol=1e-10)
        wanted = about.actInv(placed.act(data.a[i + 1])).vector
        assert np.allclose(work.bias[i], wanted, atol=1e-9 * max(1.0, np.abs(wanted).max()))
        above, rows = i, []
        while above >= 0:
            first = tree.joint[above, 3]
            rows += range(first, first + model.joints[int(above) + 1].nv)
            above = tree.joint[above, 0]
        assert np.allclose(work.motion[rows].T @ v[rows], work.speed[i], atol=1e-10)
        assert np.allclose(work.drift[rows].T @ v[rows], work.bias[i], atol=1e-9)


def test_a_body_that_has_flown_far_away_loses_no_digits() -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
    body = pin.Inertia(9.0, np.array([0.1, 0.0, 0.2]), np.diag([0.1, 0.2, 0.3]))
    model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    near, far = pin.neutral(model), pin.neutral(model)
    far[:3] = 1e8
    v = np.array([1e3, -2e3, 5e2, 0.3, -0.2, 0.1])
    here, there = (evaluated(model, q, v)[1] for q in (near, far))
    assert np.array_equal(here.inertia, there.inertia)
    assert np.array_equal(here.load, there.load)


def test_the_comparison_can_fail() -> None:
    rng = np.random.default_rng(3)
    model = random_tree(rng)
    q, v = state(model, rng)
    wanted = pin.aba(model, model.createData(), q, v, np.zeros(model.nv))
    model.inertias[1] = pin.Inertia(model.inertias[1].mass * 1.001, model.inertias[1].lever, model.inertias[1].inertia)
    _, work = evaluated(model, q, v)
    found = np.linalg.solve(work.inertia, -work.load)
    assert np.abs(found - wanted).max() > 1e-12 * np.linalg.cond(work.inertia) * max(1.0, np.abs(wanted).max())


def test_a_joint_without_compiled_dynamics_is_named() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "table")
    with pytest.raises(InputError, match="table"):
        tree_arrays(model)
