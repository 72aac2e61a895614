"""The air-bed rig as a MuJoCo model, and the hooks through which left-out physics enters it.

The slider, its spring, damper and dry friction, stops and tethers are MuJoCo's own joints and tendons; the contact and
whatever MuJoCo has no element for are explicit forces. x grows along the target's direction of motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from spacerobot.support.errors import InputError

Law = Callable[[list[float], list[float], float, float, list[float]], None]
"""(positions, velocities, time, normal contact force, generalised forces to add to): one explicit force."""

Level = Callable[[float, float, float, float], float]
"""(velocity, net force, position, normal contact force) -> dry friction level of a joint [N]."""

STANDARD_GRAVITY = 9.80665

FRICTION_TIME = 6e-4
"""Time constant [s] of MuJoCo's friction constraint; it must exceed two steps."""


@dataclass(frozen=True)
class Values:
    """The rig as built, in one trial. SI.

    Attributes:
        wrist_mass, wrist_stiffness, wrist_damping: of the slider; the damping is the whole of it.
        contact_stiffness, contact_damping: of the tip.
        target_mass, yaw_inertia: of the target; a NaN inertia holds its attitude.
        ahead, lateral: contact point from the target's centre of mass [m].
        sideways: whether the target may move along y.
        hand_mass: of a hand that floats freely; infinite holds it.
    """

    wrist_mass: float = 0.7
    wrist_stiffness: float = 1020.0
    wrist_damping: float = 8.0
    contact_stiffness: float = 68000.0
    contact_damping: float = 60.0
    target_mass: float = 9.0
    yaw_inertia: float = math.nan
    ahead: float = 0.0
    lateral: float = 0.0
    sideways: bool = False
    hand_mass: float = math.inf

    def __post_init__(self) -> None:
        for name in ("wrist_mass", "target_mass", "contact_stiffness", "hand_mass"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"{name} must be positive", given=getattr(self, name))


@dataclass
class Joint:
    """One degree of freedom of the MuJoCo model: a slide along x or y, or a hinge about z."""

    axis: str = "1 0 0"
    kind: str = "slide"
    stiffness: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass
class Tendon:
    """A MuJoCo tendon with a dead band: a spring that acts on one joint beyond a range."""

    joint: str
    stiffness: float
    low: float
    high: float


@dataclass
class ContactLaw:
    """The explicit force of the tip: k d_ref (d/d_ref)^n (1 + chi d') + c d', d_ref = 1 mm, and its holding force.

    A further force of the penetration may be added to it.
    """

    stiffness: float
    damping: float
    exponent: float = 1.0
    chi: float = 0.0
    hold: float = 0.0
    ahead: float = 0.0
    lateral: float = 0.0
    mu: float = 0.0
    further: Callable[[float], float] | None = None

    def force(self, d: float, rate: float) -> float:
        """Force, positive in compression, before it is cut off [N]."""
        if self.exponent == 1.0:
            elastic = self.stiffness * d
        else:
            elastic = math.copysign(self.stiffness * 1e-3 * (abs(d) / 1e-3) ** self.exponent, d)
        own = elastic * (1.0 + self.chi * rate) + self.damping * rate
        return own if self.further is None else own + self.further(d)


@dataclass
class Rig:
    """A rig under construction: effects edit it, then `xml` is compiled.

    Attributes:
        values: as built.
        joints: by name, in MuJoCo's order: hand (where it moves), wrist, target, target.y, target.yaw, slosh.
        masses: of the bodies that slide, by joint.
        tendons: springs with a dead band.
        contact: the tip's law.
        laws: explicit forces.
        levels: dry friction whose level changes, by joint.
        kicks: (time, joint, momentum).
        tilt: acceleration of whatever floats along x [m/s^2].
        trial: number of the trial in its campaign, from 0, for what changes with use.
        tip, mount: names of the sites that touch and that carry the slider, where a whole arm moves.
        steps: of the integration where joints alone act, smoothly and well apart; apart; in contact [s].
    """

    values: Values
    trial: int = 0
    joints: dict[str, Joint] = field(default_factory=dict)
    masses: dict[str, float] = field(default_factory=dict)
    tendons: list[Tendon] = field(default_factory=list)
    laws: list[Law] = field(default_factory=list)
    levels: dict[str, Level] = field(default_factory=dict)
    kicks: list[tuple[float, str, float]] = field(default_factory=list)
    tilt: float = 0.0
    tip: ClassVar[str | None] = None
    mount: ClassVar[str | None] = None
    steps: ClassVar[tuple[float, float, float]] = (5e-4, 2.5e-4, 1e-4)

    def __post_init__(self) -> None:
        v = self.values
        if math.isfinite(v.hand_mass):
            self.joints["hand"] = Joint()
            self.masses["hand"] = v.hand_mass
        self.joints["wrist"] = Joint(stiffness=v.wrist_stiffness, damping=v.wrist_damping)
        self.joints["target"] = Joint()
        self.masses.update({"wrist": v.wrist_mass, "target": v.target_mass})
        turning = math.isfinite(v.yaw_inertia)
        if v.sideways or turning:
            self.joints["target.y"] = Joint(axis="0 1 0")
        if turning:
            self.joints["target.yaw"] = Joint(axis="0 0 1", kind="hinge")
        self.contact = ContactLaw(v.contact_stiffness, v.contact_damping, ahead=v.ahead, lateral=v.lateral)

    def add_hand(self, mass: float, stiffness: float, damping: float) -> None:
        """Let the hand move on a spring; it comes first among the joints."""
        self.joints = {"hand": Joint(stiffness=stiffness, damping=damping), **self.joints}
        self.masses["hand"] = mass

    @property
    def smooth(self) -> bool:
        """Whether springs and dampers of joints are all there is while tip and target are apart."""
        return not (self.laws or self.levels or self.tendons or any(j.friction for j in self.joints.values()))

    @property
    def index(self) -> dict[str, int]:
        """Joint -> its number in MuJoCo."""
        return {name: i for i, name in enumerate(self.joints)}

    def compile(self) -> Any:
        """The MuJoCo model."""
        import mujoco

        return mujoco.MjModel.from_xml_string(self.xml())

    def xml(self) -> str:
        """The model as MJCF."""
        inside = self._body("wrist", ["wrist"], "gravcomp='1'")
        if "hand" in self.joints:
            inside = self._body("hand", ["hand"], "gravcomp='1'", inside)
        slosh = self._body("slosh", ["slosh"]) if "slosh" in self.joints else ""
        target = self._body("target", [n for n in self.joints if n.startswith("target")], "", slosh)
        springs = "".join(
            f"<fixed stiffness='{t.stiffness!r}' springlength='{t.low!r} {t.high!r}'>"
            f"<joint joint='{t.joint}' coef='1'/></fixed>"
            for t in self.tendons
        )
        return (
            "<mujoco><compiler inertiafromgeom='false' angle='radian'/>"
            f"<option timestep='5e-5' integrator='RK4' gravity='{self.tilt!r} 0 0'><flag contact='disable'/></option>"
            f"<worldbody>{inside}{target}</worldbody>"
            f"<tendon>{springs}</tendon></mujoco>"
        )

    def _body(self, name: str, joints: list[str], attributes: str = "", inside: str = "") -> str:
        turn = self.values.yaw_inertia if name == "target" and math.isfinite(self.values.yaw_inertia) else 0.1
        found = "".join(self._joint(j) for j in joints)
        return (
            f"<body name='{name}' {attributes}><inertial pos='0 0 0' mass='{self.masses[name]!r}' "
            f"diaginertia='{turn!r} {turn!r} {turn!r}'/>{found}{inside}</body>"
        )

    def _joint(self, name: str) -> str:
        j = self.joints[name]
        # a level that changes needs the constraint from the start
        friction = max(j.friction, 1e-9) if name in self.levels else j.friction
        return (
            f"<joint name='{name}' type='{j.kind}' axis='{j.axis}' stiffness='{j.stiffness!r}' "
            f"damping='{j.damping!r}' frictionloss='{friction!r}' solreffriction='{FRICTION_TIME} 1' "
            "solimpfriction='0.95 0.999 0.001'/>"
        )
