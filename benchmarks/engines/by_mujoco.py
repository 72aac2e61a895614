"""MuJoCo: its own contact at its nearest to a spring, and a tendon as unilateral spring; every integrator."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.engines.meeting import DURATION, SCENES, Outcome, read
from spacerobot.model.locking import with_locked
from spacerobot.simulation.scene import Scene

FAR = 1e4
"""Length [m] of the tendon that stands for the contact's plane: sideways motion s changes it by s^2 over twice that."""

RADIUS = 1e-3
SOFT = 1e-4
"""Least impedance that MuJoCo takes. At d the contact also cancels d times what else accelerates the point; so d small."""

STEPS = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6)
INTEGRATORS = ("Euler", "implicitfast", "implicit", "RK4")


def bare_urdf(text: str) -> str:
    """A URDF without shapes."""
    return re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.DOTALL)


def model_of(scene: Scene, contact: str, integrator: str, step: float) -> tuple[Any, Any]:
    """MuJoCo's model and data at the start."""
    import mujoco

    robot = scene.prepared
    if scene.joints == "locked":
        robot = with_locked(robot, np.array(scene.pose), robot.chain)
    spec = mujoco.MjSpec.from_string(bare_urdf(robot.urdf))
    spec.compiler.inertiafromgeom = False
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_FREE:
            joint.armature = float(robot.model.armature[robot.velocity_index(joint.name)])
            joint.limited = 0
    rod = spec.body("wrist_rod")
    rod.add_site(name="far", pos=[0.0, 0.0, 0.16 - FAR])
    target = spec.worldbody.add_body(name="the_target")
    target.add_freejoint()
    target.mass, target.inertia = scene.target.mass, np.diag(scene.target.inertia_matrix())
    target.explicitinertial = True
    target.add_site(name="face")
    gauge = spec.add_tendon(name="gauge")
    gauge.wrap_site("far")
    gauge.wrap_site("face")
    gauge.springlength = [FAR, 10.0 * FAR]
    sensor = spec.add_sensor(name="length", type=mujoco.mjtSensor.mjSENS_TENDONPOS)
    sensor.objtype, sensor.objname = mujoco.mjtObj.mjOBJ_TENDON, "gauge"
    if contact == "native":
        half = 0.05
        flags = {"condim": 1, "friction": [0.0, 0.0, 0.0], "mass": 0.0}
        rod.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[half] * 3, pos=[0.0, 0.0, 0.16 - half], **flags)
        target.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[RADIUS, 0.0, 0.0], **flags)
    else:
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.gravity = [0.0, 0.0, 0.0]
    spec.option.timestep = step
    spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    engine = spec.compile()
    engine.tendon_stiffness[:] = scene.contact.stiffness if contact == "tendon" else 0.0
    slider = engine.joint(robot.slider)
    engine.jnt_stiffness[slider.id] = scene.wrist.stiffness
    engine.dof_damping[slider.dofadr[0]] = scene.wrist.damping + scene.wrist.equivalent_damping
    data = mujoco.MjData(engine)
    _place(scene, robot, engine, data)
    if contact == "native":
        _soften(scene, engine, data)
    return engine, data


def _place(scene: Scene, robot: Any, engine: Any, data: Any) -> None:
    import mujoco

    if scene.joints != "locked":
        for name, value in zip(robot.chain, scene.pose, strict=True):
            data.qpos[engine.joint(name).qposadr[0]] = value
    mujoco.mj_forward(engine, data)
    rod, body = engine.body("wrist_rod").id, engine.body("the_target").id
    tip = data.xpos[rod] + data.xmat[rod].reshape(3, 3) @ np.array([0.0, 0.0, 0.16])
    joint = engine.joint(engine.body("the_target").jntadr[0])
    at, of = joint.qposadr[0], joint.dofadr[0]
    shift = RADIUS if engine.ngeom else 0.0
    data.qpos[at : at + 3] = tip - shift * np.array(scene.approach)
    data.qpos[at + 3] = 1.0
    data.qvel[of : of + 3] = scene.target.speed * np.array(scene.approach)
    mujoco.mj_forward(engine, data)
    assert body > 0


def _soften(scene: Scene, engine: Any, data: Any) -> None:
    """Let MuJoCo's contact push as the spring does: (A + R) f = stiffness/d depth, with its own A and R."""
    import mujoco

    engine.geom_solimp[:] = [SOFT, SOFT, 1e-3, 0.5, 2.0]
    engine.geom_solref[:] = [-1.0, -1e-9]
    joint = engine.joint(engine.body("the_target").jntadr[0])
    at, probe = joint.qposadr[0], mujoco.MjData(engine)
    probe.qpos[:] = data.qpos
    probe.qpos[at : at + 3] += 1e-4 * np.array(scene.approach)
    mujoco.mj_forward(engine, probe)
    assert probe.ncon == 1, "the surfaces overlap, and nothing touches"
    share = float(probe.efc_R[0]) + float(probe.efc_diagA[0])
    engine.geom_solref[:, 0] = -scene.contact.stiffness * SOFT * share


def collide(scene: Scene, engine: Any, data: Any) -> Outcome:
    """One run, all steps inside MuJoCo."""
    import mujoco
    from mujoco import rollout

    count = round(DURATION / engine.opt.timestep)
    start = np.empty(mujoco.mj_stateSize(engine, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(engine, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state, sensed = rollout.rollout(engine, mujoco.MjData(engine), start[None], nstep=count)
    joint = engine.joint(engine.body("the_target").jntadr[0])
    velocity = state[0, -1, 1 + engine.nq + joint.dofadr[0] : 1 + engine.nq + joint.dofadr[0] + 3]
    shift = RADIUS if engine.ngeom else 0.0
    depth = FAR - sensed[0, :, 0] + shift
    # the sensor is that of the step's beginning
    time = engine.opt.timestep * np.arange(count)
    return read(scene, time, depth, float(velocity @ np.array(scene.approach)))


def _steps(contact: str, integrator: str) -> tuple[float, ...]:
    """Own contact ends at its softness, and first order at patience; only the fourth order is worth the smallest step."""
    if contact == "native":
        return STEPS[:3]
    return STEPS if integrator == "RK4" else STEPS[:5]


def runs(name: str, quick: bool) -> Iterator[tuple[str, str, Callable[[], Outcome]]]:
    """(engine, setting, run)."""
    scene = SCENES[name]
    for contact in ("tendon", "native"):
        for integrator in INTEGRATORS[-1:] if quick else INTEGRATORS:
            for step in STEPS[1:2] if quick else _steps(contact, integrator):
                engine, data = model_of(scene, contact, integrator, step)
                label = f"MuJoCo {integrator}, {'spring' if contact == 'tendon' else 'own contact'}"
                yield label, f"{step:g} s", lambda engine=engine, data=data: collide(scene, engine, data)
