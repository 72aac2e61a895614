"""The same URDF in MuJoCo, an engine that shares no code with Pinocchio."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.model.robot import Robot
from tests.dynamics.support import poses, robot, turn, with_base

mujoco = pytest.importorskip("mujoco")

QUATERNION = np.array([0.2, -0.4, 0.5, 0.6])


def mass_matrix(model: Robot, q: np.ndarray, *, armature: bool = True) -> np.ndarray:
    """MuJoCo's mass matrix in Pinocchio's order and velocity frame."""
    spec = mujoco.MjSpec.from_string(model.urdf)
    spec.compiler.inertiafromgeom = False  # it would weigh the shapes of links that have no mass
    if armature:
        for joint in spec.joints:
            if joint.type != mujoco.mjtJoint.mjJNT_FREE:
                joint.armature = float(model.model.armature[model.velocity_index(joint.name)])
    engine = spec.compile()
    data = mujoco.MjData(engine)
    change = np.zeros((engine.nv, model.model.nv))
    for i in range(engine.njnt):
        joint = engine.joint(i)
        record = model.model.joints[model.joint_id(joint.name)]
        at, of = joint.qposadr[0], joint.dofadr[0]
        value = q[record.idx_q : record.idx_q + record.nq]
        if record.nq == 7:
            data.qpos[at : at + 7] = [*value[:3], value[6], *value[3:6]]  # the real part comes first there
            change[of : of + 3, :3] = turn(value[3:])  # its linear velocity is in the world frame
            change[of + 3 : of + 6, 3:6] = np.eye(3)
        else:
            data.qpos[at] = value[0]
            change[of, record.idx_v] = 1.0
    mujoco.mj_forward(engine, data)
    full = np.zeros((engine.nv, engine.nv))
    mujoco.mj_fullM(engine, data, full)
    return change.T @ full @ change


@pytest.mark.parametrize("name", ["pa10", "pa10c", "pa10_wrist", "pa10c_wrist", "chaser_pa10_wrist"])
def test_mass_matrix_agrees(name: str) -> None:
    model = robot(name)
    for pose in poses(model, 5):
        q = model.configuration(pose, slider=0.01)
        if model.floating:
            q = with_base(model, q, QUATERNION, np.array([0.3, -1.0, 2.0]))
        ours = joint_space_inertia(model, q)
        np.testing.assert_allclose(mass_matrix(model, q), ours, rtol=0.0, atol=1e-9 * abs(ours).max())


def test_the_check_notices_what_it_must() -> None:
    model = robot("chaser_pa10_wrist")
    q = with_base(model, model.configuration(poses(model, 1)[0]), QUATERNION, np.zeros(3))
    ours = joint_space_inertia(model, q)
    assert abs(mass_matrix(model, q, armature=False) - ours).max() > 0.1
    level = with_base(model, q, np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3))
    np.testing.assert_allclose(joint_space_inertia(model, level), ours, rtol=1e-9, atol=1e-9)
    moved = model.configuration(poses(model, 2)[1])
    assert abs(mass_matrix(model, moved) - ours).max() > 0.1


@pytest.mark.parametrize("name", ["wrist", "pa10_wrist", "pa10c_wrist", "chaser_pa10_wrist"])
def test_mujoco_weighs_the_bundled_robots_as_we_do_unasked(name: str) -> None:
    """Its URDF reader weighs the shapes of links that state no mass; ours state a zero."""
    arm = robot(name)
    weighed = mujoco.MjModel.from_xml_string(arm.urdf)
    fixed = 0.0 if arm.floating else arm.model.inertias[0].mass  # what is part of its world has no mass there
    assert weighed.body_mass.sum() == pytest.approx(sum(b.mass for b in arm.model.inertias) - fixed, rel=1e-12)
