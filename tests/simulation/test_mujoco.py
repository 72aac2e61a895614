"""The same scene in MuJoCo, an engine that shares no code with ours: its wrist spring and damper are joint
properties there, the contact an explicit force at the point, its own contacts are off."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.model.locking import with_locked
from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate

mujoco = pytest.importorskip("mujoco")


def engine_of(scene: Scene, *, stiffness: float | None = None):
    """MuJoCo's model of a scene: the prepared robot's URDF and a free target."""
    robot = scene.prepared
    if scene.joints == "locked":
        robot = with_locked(robot, np.array(scene.pose), robot.chain)
    spec = mujoco.MjSpec.from_string(robot.urdf)
    spec.compiler.inertiafromgeom = False
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_FREE:
            joint.armature = float(robot.model.armature[robot.velocity_index(joint.name)])
            joint.limited = 0
    target = spec.worldbody.add_body(name="the_target")
    target.add_freejoint()
    target.mass = scene.target.mass
    target.inertia = np.diag(scene.target.inertia_matrix())
    target.explicitinertial = True
    spec.option.gravity = [0.0, 0.0, 0.0]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    engine = spec.compile()
    slider = engine.joint(robot.slider)
    engine.jnt_stiffness[slider.id] = scene.wrist.stiffness if stiffness is None else stiffness
    engine.dof_damping[slider.dofadr[0]] = scene.wrist.damping + scene.wrist.equivalent_damping
    return engine


class Meeting:
    """State and right-hand side of MuJoCo's scene, integrated here with the classical Runge-Kutta method."""

    def __init__(self, scene: Scene, **options: float) -> None:
        self.scene, self.engine = scene, engine_of(scene, **options)
        self.data = mujoco.MjData(self.engine)
        robot = scene.prepared
        if scene.joints != "locked":
            for name, value in zip(robot.chain, scene.pose, strict=True):
                self.data.qpos[self.engine.joint(name).qposadr[0]] = value
        self.body = self.engine.body("the_target").id
        self.rod = self.engine.body("wrist_rod").id
        mujoco.mj_forward(self.engine, self.data)
        self.local = np.array([0.0, 0.0, 0.16])
        tip = self.tip()
        lever = scene.attitude @ np.array(scene.target.contact_point)
        self.point = np.array(scene.target.contact_point)
        joint = self.engine.joint(self.engine.body("the_target").jntadr[0])
        at, of = joint.qposadr[0], joint.dofadr[0]
        self.data.qpos[at : at + 3] = tip - lever - scene.target.gap * np.array(scene.approach)
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, scene.attitude.ravel())
        self.data.qpos[at + 3 : at + 7] = quaternion
        self.data.qvel[of : of + 3] = scene.target.speed * np.array(scene.approach)
        self.data.qvel[of + 3 : of + 6] = scene.attitude.T @ np.array(scene.target.spin)
        self.of = of
        self.touching = False
        self.row = np.zeros((3, self.engine.nv))

    def tip(self) -> np.ndarray:
        return self.data.xpos[self.rod] + self.data.xmat[self.rod].reshape(3, 3) @ self.local

    def force(self) -> tuple[float, np.ndarray, float]:
        """Contact force, the generalised direction it acts along, and the penetration."""
        mujoco.mj_fwdPosition(self.engine, self.data)
        normal = -self.data.xmat[self.rod].reshape(3, 3)[:, 2]
        touch = self.data.xpos[self.body] + self.data.xmat[self.body].reshape(3, 3) @ self.point
        rows = []
        for body in (self.body, self.rod):
            mujoco.mj_jac(self.engine, self.data, self.row, None, touch, body)
            rows.append(normal @ self.row)
        row = rows[0] - rows[1]
        depth = float(normal @ (touch - self.tip()))
        contact = self.scene.contact
        wanted = contact.stiffness * depth + contact.damping * float(row @ self.data.qvel)
        return (max(wanted, 0.0) if depth > 0.0 else 0.0), row, depth

    def rate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        self.data.qpos[:], self.data.qvel[:] = q, v
        force, row, _ = self.force()
        self.data.qfrc_applied[:] = -force * row
        mujoco.mj_forward(self.engine, self.data)
        return self.data.qacc.copy()

    def moved(self, q: np.ndarray, v: np.ndarray, step: float) -> np.ndarray:
        out = q.copy()
        mujoco.mj_integratePos(self.engine, out, v, step)
        return out

    def restitution(self, end: float, step: float) -> float:
        """Of the target's centre of mass along the approach."""
        approach = np.array(self.scene.approach)
        q, v = self.data.qpos.copy(), self.data.qvel.copy()
        for _ in range(round(end / step)):
            a1 = self.rate(q, v)
            v2 = v + 0.5 * step * a1
            a2 = self.rate(self.moved(q, v, 0.5 * step), v2)
            v3 = v + 0.5 * step * a2
            a3 = self.rate(self.moved(q, v2, 0.5 * step), v3)
            v4 = v + step * a3
            a4 = self.rate(self.moved(q, v3, step), v4)
            q = self.moved(q, (v + 2 * v2 + 2 * v3 + v4) / 6.0, step)
            v = v + step * (a1 + 2 * a2 + 2 * a3 + a4) / 6.0
        return -float(approach @ v[self.of : self.of + 3]) / self.scene.target.speed


WRIST = Wrist(stiffness=5100.0, damping=4.0, equivalent_damping=6.0)
CONTACT = ContactLaw(damping=60.0)
SCENES = {
    "held arm": Scene("pa10_wrist", wrist=WRIST, contact=CONTACT, target=Target(speed=0.07)),
    "held arm, off centre": Scene(
        "pa10_wrist",
        wrist=WRIST,
        contact=CONTACT,
        target=Target(
            speed=0.07, contact_point=(0.15, 0.03, -0.02), inertia=(0.3, 0.4, 0.5), attitude=(0.1, -0.2, 0.3)
        ),
    ),
    "chaser, joints locked": Scene("chaser_pa10_wrist", wrist=WRIST, contact=CONTACT, target=Target(speed=0.07)),
    "chaser, joints free": Scene(
        "chaser_pa10_wrist",
        joints="free",
        wrist=WRIST,
        contact=CONTACT,
        target=Target(speed=0.07, contact_point=(0.15, 0.02)),
    ),
}


@pytest.mark.parametrize("name", list(SCENES))
def test_restitution_agrees(name: str) -> None:
    scene = SCENES[name]
    end, step = 0.16, 5e-5
    ours = simulate(scene, duration=end, tolerance=1e-10)
    assert ours.restitution.touches >= 1
    speed = np.array([ours[f"target.velocity.{a}"][-1] for a in "xyz"])
    expected = -float(speed @ np.array(scene.approach)) / scene.target.speed
    assert Meeting(scene).restitution(end, step) == pytest.approx(expected, abs=1e-4)


def test_a_different_spring_is_seen() -> None:
    scene = SCENES["held arm"]
    found = Meeting(scene, stiffness=1.05 * 5100.0).restitution(0.16, 1e-4)
    assert abs(found - simulate(scene, duration=0.16).restitution.target) > 1e-3
