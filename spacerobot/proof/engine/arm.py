"""A whole arm in MuJoCo, from the same URDF, with the wrist's slider on it and a target before it.

Joints move on servo springs or are welded; a chaser's base floats. Reflected rotor inertia is set by hand, and shapes
weigh nothing. What the reduced model calls the hand is here whatever the arm does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np

from spacerobot.model.library import load
from spacerobot.model.wrist import aim
from spacerobot.proof.engine.rig import FRICTION_TIME, Joint, Rig, Values

CHAIN = ("S1", "S2", "S3", "E1", "E2", "W1", "W2")
"""The arm's joints from base to tip."""

POSE = tuple(np.radians([0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0]).tolist())
"""The pose of the rig's arm [rad]."""

AHEAD = np.array([1.0, 0.0, 0.0])

TARGET = ("target", "target.y", "target.z")
"""A target in space is pushed aside where the face that it meets turns."""

STICKS = [0.9995, 0.9999, 0.001, 0.5, 2.0]
"""How well MuJoCo's friction holds a joint that sticks: its creep is to be small beside a joint's slow motions."""

BASE_JOINTS = (("base.x", "1 0 0"), ("base.y", "0 1 0"), ("base.z", "0 0 1"))
BASE_TURNS = (("base.roll", "1 0 0"), ("base.pitch", "0 1 0"), ("base.yaw", "0 0 1"))


@dataclass(frozen=True)
class Servo:
    """Springs and dampers that hold the joints of an arm: one stiffness [N m/rad], a damping for each [N m s/rad]."""

    stiffness: float
    damping: tuple[float, ...] = (0.0,) * 7


@dataclass
class ArmRig(Rig):
    """A rig whose hand is the end of an arm.

    Attributes:
        servo: what holds the joints; None welds them.
        floating: whether the base is a free spacecraft.
    """

    servo: Servo | None = None
    floating: bool = False
    tip: ClassVar[str | None] = "tip"
    mount: ClassVar[str | None] = "mount"
    steps: ClassVar[tuple[float, float, float]] = (4e-4, 4e-4, 1e-4)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.joints.pop("hand", None)
        self.joints |= {name: Joint() for name in TARGET[1:]}
        self.joints |= {f"joint.{name}": Joint(kind="hinge") for name in CHAIN}
        self._index: dict[str, int] = {}

    @property
    def index(self) -> dict[str, int]:
        """Joint -> its degree of freedom in MuJoCo."""
        if not self._index:
            self.compile()
        return self._index

    def add_hand(self, mass: float, stiffness: float, damping: float) -> None:
        """Let the joints give way on servo springs that together are the hand's; the mass is the arm's own.

        All joints are equally stiff and, as far as their inertias differ, equally damped: c_j in proportion to
        sqrt(I_j). Then K_hand = K / sum j^2 and c_hand = (K_hand / K)^2 sum j^2 c_j.
        """
        row, inertia = tip_row()
        lever = float(row @ row)
        even = np.sqrt(inertia)
        share = damping * lever**2 / float(row**2 @ even)
        self.servo = Servo(stiffness * lever, tuple((share * even).tolist()))

    def compile(self) -> Any:
        """The MuJoCo model."""
        import mujoco

        spec = shapeless(_urdf(self.floating))
        spec.option.gravity = [0.0, 0.0, 0.0]
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
        spec.option.timestep = 5e-5
        if self.floating:
            self._float(spec)
        self._arm(spec)
        self._wrist(spec)
        self._target(spec)
        model = spec.compile()
        self._index = {model.joint(i).name: int(model.jnt_dofadr[i]) for i in range(model.njnt)}
        return model

    def _float(self, spec: Any) -> None:
        import mujoco

        for joint in list(spec.joints):
            if joint.type == mujoco.mjtJoint.mjJNT_FREE:
                spec.delete(joint)
        body = spec.body("spacecraft")
        for names, sort in ((BASE_JOINTS, mujoco.mjtJoint.mjJNT_SLIDE), (BASE_TURNS, mujoco.mjtJoint.mjJNT_HINGE)):
            for name, axis in names:
                joint = body.add_joint(name=name, type=sort, axis=[float(a) for a in axis.split()])
                joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE

    def _arm(self, spec: Any) -> None:
        import mujoco

        robot = load("pa10")
        for number, (name, angle) in enumerate(zip(CHAIN, POSE, strict=True)):
            joint = spec.joint(name)
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            if self.servo is not None:
                own = replace(
                    self.joints[f"joint.{name}"], stiffness=self.servo.stiffness, damping=self.servo.damping[number]
                )
                set_joint(joint, own)
                joint.solimp_friction = STICKS
            joint.armature = float(robot.model.armature[robot.velocity_index(name)])
            # the pose becomes the model's own zero, so that springs rest there and welds hold it
            body = joint.parent
            turn = np.zeros(4)
            mujoco.mju_axisAngle2Quat(turn, np.array(joint.axis), angle)
            turned = np.zeros(4)
            mujoco.mju_mulQuat(turned, np.array(body.quat), turn)
            body.quat = turned
            joint.name = f"joint.{name}"
            if self.servo is None:
                spec.delete(joint)

    def _wrist(self, spec: Any) -> None:
        import mujoco

        joint, own = spec.joint("wrist_slider"), self.joints["wrist"]
        joint.name = "wrist"
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        set_joint(joint, own)
        body = joint.parent
        ratio = self.masses["wrist"] / body.mass
        body.mass, body.fullinertia = self.masses["wrist"], np.array(body.fullinertia) * ratio  # as a URDF is read
        length = 2.0 * float(body.ipos[2])  # its centre of mass is half way to the tip
        body.add_site(name="tip", pos=[0.0, 0.0, length])
        spec.body("wrist_mount").add_site(name="mount")
        for spring in self.tendons:
            if spring.joint in self.joints:
                tendon = spec.add_tendon(stiffness=[spring.stiffness, 0.0, 0.0], springlength=[spring.low, spring.high])
                tendon.wrap_joint(spring.joint, 1.0)

    def _target(self, spec: Any) -> None:
        import mujoco

        body = spec.worldbody.add_body(name="target", mass=self.masses["target"], inertia=[0.1, 0.1, 0.1])
        body.explicitinertial = True
        for name, axis in zip(TARGET, np.eye(3).tolist(), strict=True):
            joint = body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
            set_joint(joint, self.joints[name])
        if "slosh" in self.joints:
            inner = body.add_body(name="slosh", mass=self.masses["slosh"], inertia=[0.1, 0.1, 0.1])
            inner.explicitinertial = True
            joint = inner.add_joint(name="slosh", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=AHEAD.tolist())
            set_joint(joint, self.joints["slosh"])


def shapeless(urdf: str) -> Any:
    """A URDF as MuJoCo's specification: inertia as stated, no shapes, and no contact of MuJoCo's own."""
    import mujoco

    spec = mujoco.MjSpec.from_string(urdf)
    spec.compiler.inertiafromgeom = False
    spec.compiler.fusestatic = False
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    for geom in list(spec.geoms):
        spec.delete(geom)
    return spec


def mass_matrix(model: Any, data: Any) -> np.ndarray:
    """Joint-space inertia at the data's position, shape (nv, nv)."""
    import mujoco

    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def set_joint(joint: Any, own: Joint, friction_time: float = FRICTION_TIME) -> None:
    """Spring, damper and dry friction of a joint; the first two are polynomials, of which the linear part is used."""
    joint.stiffness, joint.damping = [own.stiffness, 0.0, 0.0], [own.damping, 0.0, 0.0]
    joint.frictionloss = own.friction
    joint.solref_friction = [friction_time, 1.0]
    joint.solimp_friction = [0.95, 0.999, 0.001, 0.5, 2.0]


@cache
def _urdf(floating: bool) -> str:
    robot = load("chaser_pa10_wrist" if floating else "pa10_wrist")
    return str(aim(robot, np.array(POSE), AHEAD).urdf)


def hand_mass(rig: ArmRig) -> float:
    """What the slider's mount feels as mass along x, the slider left out: 1/(J M^-1 J^T) in MuJoCo [kg]."""
    import mujoco

    model = rig.compile()
    data = mujoco.MjData(model)
    full = mass_matrix(model, data)
    row = np.zeros((3, model.nv))
    mujoco.mj_jacSite(model, data, row, None, model.site("mount").id)
    # an apparent mass behind the slider: the slider's own share of M is taken off along its axis
    keep = [i for i in range(model.nv) if i not in (rig.index["wrist"], rig.index["target"])]
    slide = rig.index["wrist"]
    reduced = full[np.ix_(keep, keep)] - np.outer(full[keep, slide], full[slide, keep]) / full[slide, slide]
    j = row[0][keep]
    return float(1.0 / (j @ np.linalg.solve(reduced, j)))


@cache
def tip_row() -> tuple[np.ndarray, np.ndarray]:
    """The arm's Jacobian row along x at the mount, shape (7,) [m], and its joints' inertias, shape (7,) [kg m^2]."""
    import mujoco

    rig = ArmRig(Values(), servo=Servo(1.0))
    model = rig.compile()
    data = mujoco.MjData(model)
    full = mass_matrix(model, data)
    row = np.zeros((3, model.nv))
    mujoco.mj_jacSite(model, data, row, None, model.site("mount").id)
    joints = [i for name, i in rig.index.items() if name.startswith("joint.")]
    return row[0][joints], np.diag(full)[joints]


@cache
def arm_mass(*, floating: bool) -> float:
    """Effective mass behind the wrist along x, from MuJoCo: of a chaser, its joints welded, or of free joints [kg]."""
    return hand_mass(ArmRig(Values(), floating=floating, servo=None if floating else Servo(1.0)))
