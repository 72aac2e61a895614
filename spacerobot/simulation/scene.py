"""A scene: everything about one meeting of a robot's wrist and a free-flying body, checked when it is made."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.pose_limits import PoseLimitWarning, pose_limit_warnings
from spacerobot.dynamics.regime import BASES, JOINTS
from spacerobot.effects.mechanism import Mechanism
from spacerobot.model.describe import held_words
from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.model.spacecraft import SpacecraftSpec, float_base
from spacerobot.model.wrist import WristSpec, aim, attach_wrist
from spacerobot.simulation.arrival import arrival_time
from spacerobot.simulation.hand import Hand, hand_of
from spacerobot.simulation.parts import ContactLaw, EffectAt, Motion, Servo, Target, Wrist
from spacerobot.simulation.parts.checks import number, vector
from spacerobot.simulation.scene_mechanism import baseline, edited
from spacerobot.simulation.scene_table import rows
from spacerobot.simulation.scene_toml import made_from_file, text_of
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.files import write_text
from spacerobot.support.showing import brief, html_table

BACKENDS = ("reduced", "multibody")
PA10_POSE = tuple(math.radians(d) for d in (0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0))
"""Joint angles [rad] of the bundled seven-joint arm where a scene states none."""

PA10_JOINTS = ("S1", "S2", "S3", "E1", "E2", "W1", "W2")


def _turn(axis: int, angle: float) -> np.ndarray:
    """Rotation about a coordinate axis, shape (3, 3)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[j, i] = math.sin(angle)
    turn[i, j] = -turn[j, i]
    return turn


def _default_pose(robot: Robot) -> tuple[float, ...]:
    """The rig's pose for the bundled arm, else zero or the limit nearest to it."""
    if robot.chain == PA10_JOINTS:
        return PA10_POSE
    model, pose = robot.model, []
    for name in robot.chain:
        joint = model.joints[robot.joint_id(name)]
        low, high = model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]
        pose.append(float(min(max(0.0, low), high)) if joint.nq == 1 and low < high else 0.0)
    return tuple(pose)


def _is_default(scene: Scene, f: Field[Any]) -> bool:
    default = f.default_factory() if f.default_factory is not MISSING else f.default
    return bool(getattr(scene, f.name) == default)


@dataclass(frozen=True)
class Scene:
    """One meeting of wrist and target. SI, world axes; x of every result grows along `approach`.

    Attributes:
        robot: bundled name, example-robot-data name, URDF path or text, or a Robot; without a wrist it gets one
            at its tip.
        base: "fixed" or "free"; free where the robot floats if None.
        joints: "locked", "free" or "servo".
        pose: joint positions from base to tip [rad or m]; the rig's pose for the bundled arm, else zero or the
            limit nearest to it, if None.
        tip: frame that carries the wrist, of a robot that has none; the arm's tip if None.
        others: positions of joints outside the chain by name (fingers) [rad or m]; they are locked, neutral if absent.
        approach: unit vector, the target's direction of motion; the wrist is turned to point against it. Where none
            is given the target comes along the hand: against the way in which the wrist points at the pose.
        gravity: acceleration [m/s^2].
        wrist, contact, target: see there.
        servo: what holds servo joints.
        hand_speed: of a free chaser as a whole, against `approach`, toward the target [m/s].
        motion: what else moves at the start: base, joints, carried bodies.
        spacecraft: put under the arm to let its base float, or None.
        duration: of the simulation [s]; from arrival and predicted contact time if None.
        effects: of the catalogue, applied in order.
        backend: "reduced" or "multibody".
        title: one line.
    """

    robot: str | Path | Robot = "pa10_wrist"
    base: str | None = None
    joints: str = "locked"
    pose: tuple[float, ...] | None = None
    tip: str | None = None
    others: Mapping[str, float] = field(default_factory=dict)
    approach: tuple[float, ...] = ()
    gravity: tuple[float, ...] = (0.0, 0.0, 0.0)
    wrist: Wrist = field(default_factory=Wrist)
    contact: ContactLaw = field(default_factory=ContactLaw)
    target: Target = field(default_factory=Target)
    servo: Servo | None = None
    hand_speed: float = 0.0
    motion: Motion = field(default_factory=Motion)
    spacecraft: SpacecraftSpec | None = None
    duration: float | None = None
    effects: tuple[EffectAt, ...] = ()
    backend: str = "multibody"
    title: str = ""

    def __post_init__(self) -> None:
        def put(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        for name, kind in (("wrist", Wrist), ("contact", ContactLaw), ("target", Target), ("motion", Motion)):
            if not isinstance(getattr(self, name), kind):
                raise InputError(f"must be a {kind.__name__}", given=getattr(self, name), where=name)
        for name, known in (("joints", JOINTS), ("backend", BACKENDS)):
            if getattr(self, name) not in known:
                raise NotFoundError(f"value of {name!r}", str(getattr(self, name)), known, where=name)
        if self.base is not None and self.base not in BASES:
            raise NotFoundError("value of 'base'", str(self.base), BASES, where="base")
        put("gravity", vector(self.gravity, 3, "gravity"))
        put("hand_speed", number(self.hand_speed, "hand_speed"))
        put("effects", tuple(self.effects))
        if self.duration is not None:
            put("duration", number(self.duration, "duration", minimum=0.0, strict=True))
        if (self.servo is not None) != (self.joints == "servo"):
            if self.servo is not None:
                raise InputError("a servo needs servo joints", given=f"joints {self.joints}", where="servo")
            raise InputError("servo joints need a servo", valid="servo stiffness and damping", where="servo")
        loaded = self._loaded()
        put("base", self.base or ("free" if loaded.floating else "fixed"))
        if self.pose is not None:
            put("pose", vector(self.pose, len(loaded.chain), "pose", f"one for each of {', '.join(loaded.chain)}"))
        else:
            put("pose", _default_pose(loaded))
        if self.servo is not None:
            self.servo.per_joint(loaded.chain)
        if self.base == "free" and not loaded.floating:
            raise InputError(
                f"{loaded.name} has a fixed base, and a free one needs a spacecraft's mass and inertia",
                given="base free",
                valid="base fixed, a robot that floats (a chaser), or a spacecraft to put it on",
                where="base",
            )
        if self.hand_speed and self.base != "free":
            raise InputError("only a free chaser has a speed of its own", given=self.hand_speed, where="hand_speed")
        if self.approach is None or (isinstance(self.approach, tuple) and not self.approach):
            put("approach", self._along_the_hand(loaded))
        put("approach", tuple(unit_directions(vector(self.approach, 3, "approach"), where="approach").tolist()))
        self._require_movable(loaded)
        for text in pose_limit_warnings(loaded, self._start(loaded)):
            warnings.warn(text, PoseLimitWarning, stacklevel=3)
        object.__setattr__(self, "_aimed", self._prepared(loaded))
        self._require_carried()
        self._require_arrival()

    def __repr__(self) -> str:
        kept = ("robot", "base", "joints", "approach", "backend", "title")
        changed = [f.name for f in fields(self) if f.name not in kept and not _is_default(self, f)]
        shown = ", ".join(f"{name}={brief(getattr(self, name))}" for name in (*kept[1:5], *changed))
        return f"Scene({brief(self.robot)}, {shown})"

    def _repr_html_(self) -> str:
        title = f"{self.title or self.prepared.name}: base {self.base}, joints {self.joints}, {self.backend}"
        return html_table(title, rows(self), ("", "value", "unit"), self.notes)

    def _along_the_hand(self, robot: Robot) -> tuple[float, ...]:
        """Against the way in which the robot's own wrist points at the pose; unit vector, world axes."""
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, self._start(robot))
        against = -data.oMf[robot.frame_id(robot.tip)].rotation[:, 2]
        return tuple((np.round(against, 9) + 0.0).tolist())

    @property
    def along_the_hand(self) -> tuple[float, ...]:
        """The approach of a scene that states none; unit vector, world axes."""
        return self._along_the_hand(self._loaded())

    def _start(self, robot: Robot) -> np.ndarray:
        """The robot's whole configuration at the start, shape (nq,)."""
        for name in self.others:
            if name in robot.chain or name == robot.slider:
                raise InputError("this joint is set by the pose or the wrist", given=name, where="others")
        others = {name: number(value, f"others.{name}") for name, value in self.others.items()}
        return robot.configuration(np.array(self.pose), others=others)

    @property
    def start(self) -> np.ndarray:
        """Configuration of `prepared` at the start, shape (nq,)."""
        return self._start(self.prepared)

    def _loaded(self) -> Robot:
        robot = self.robot if isinstance(self.robot, Robot) else load(self.robot)
        if robot.slider is None:
            robot = attach_wrist(robot, self.tip, WristSpec(mass=self.wrist.mass))
        elif self.tip is not None:
            raise InputError("the robot has a wrist already, where it is", given=self.tip, where="tip")
        if self.spacecraft is not None:
            if self.base == "fixed":
                raise InputError("a spacecraft floats", given="base fixed", valid="base free", where="spacecraft")
            robot = float_base(robot, self.spacecraft)
        return robot

    def _prepared(self, robot: Robot) -> Robot:
        """Wrist against the approach, its slider as heavy as the scene says."""
        aimed = aim(robot, np.array(self.pose), np.array(self.approach))
        model = aimed.model.copy()
        slider = aimed.joint_id(str(aimed.slider))
        body = model.inertias[slider]
        object.__setattr__(self, "_slider_mass", float(body.mass))
        kept = aimed.model.jointPlacements[slider].isApprox(robot.model.jointPlacements[slider], 1e-6)
        object.__setattr__(self, "_turned", not kept)
        ratio = self.wrist.mass / body.mass
        model.inertias[slider] = type(body)(self.wrist.mass, body.lever, ratio * body.inertia)
        return replace(aimed, model=model)

    @property
    def prepared(self) -> Robot:
        """The robot with its wrist turned against `approach` and the slider's mass set."""
        return self._aimed  # type: ignore[attr-defined, no-any-return]

    @cached_property
    def axes(self) -> np.ndarray:
        """Columns approach, lateral (z x approach) and up, shape (3, 3); lateral is y for an upright approach."""
        ahead = np.array(self.approach)
        side = np.cross((0.0, 0.0, 1.0), ahead)
        length = np.linalg.norm(side)
        lateral = side / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])
        lateral = lateral - ahead * (ahead @ lateral)
        lateral = lateral / np.linalg.norm(lateral)
        return np.column_stack([ahead, lateral, np.cross(ahead, lateral)])

    @cached_property
    def hand(self) -> Hand:
        """What the wrist feels of the arm: its effective mass, and a spring where servos hold it."""
        return hand_of(
            self.prepared,
            np.array(self.pose),
            self.approach,
            str(self.base),
            self.joints,
            others=self.others,
            servo=self.servo,
            wrist_stiffness=self.wrist.stiffness,
            target_mass=self.target.mass,
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader should know of how the robot is used, a sentence each."""
        said = []
        turned: bool = self._turned  # type: ignore[attr-defined]
        if turned and (self.base == "free" or self.joints != "locked"):
            said.append("the wrist is turned to point against the approach (`mass --aim` turns it alike)")
        own: float = self._slider_mass  # type: ignore[attr-defined]
        if own != self.wrist.mass:
            said.append(f"the wrist's slider weighs {self.wrist.mass:g} kg, not {own:g} as in the robot")
        if self.joints != "locked" and (words := held_words(self.prepared)):
            said.append(words)
        return tuple(said)

    @cached_property
    def _baselines(self) -> dict[str, Mechanism]:
        return {}

    @cached_property
    def _mechanisms(self) -> dict[str, Mechanism]:
        return {}

    def baseline(self, backend: str | None = None) -> Mechanism:
        """The mechanism without the scene's effects."""
        backend = backend or self.backend
        if backend not in self._baselines:
            self._baselines[backend] = baseline(self, backend)
        return self._baselines[backend]

    def mechanism(self, backend: str | None = None) -> Mechanism:
        """The mechanism with the scene's effects in it.

        Args:
            backend: for which backend; joints and base have ports only in "multibody". The scene's own if None.

        Raises:
            NotFoundError, InputError: an effect that cannot sit where the scene puts it.
        """
        backend = backend or self.backend
        if backend not in self._mechanisms:
            self._mechanisms[backend] = edited(self, backend)
        return self._mechanisms[backend]

    @property
    def closing_speed(self) -> float:
        """Speed at which contact point and tip near each other at the start [m/s]."""
        point = np.cross(np.array(self.target.spin), self.lever)
        along = float(point @ np.array(self.approach))
        tip = float(self.tip_velocity @ np.array(self.approach))
        return self.target.speed + along + self.hand_speed - tip - self.wrist.deflection_rate

    @cached_property
    def tip_velocity(self) -> np.ndarray:
        """What motion of the base and rates of the joints give the tip at the start, world axes, shape (3,) [m/s]."""
        robot, v = self.prepared, np.zeros(self.prepared.model.nv)
        if self.base == "free":
            v[:6] = *self.motion.base_velocity, *self.motion.base_spin  # the base stands unturned
        for name, rate in self.motion.joint_rates.items():
            v[robot.velocity_index(name)] = rate
        data = robot.model.createData()
        pin.forwardKinematics(robot.model, data, self.start, v)
        frame = robot.frame_id(str(robot.contact))
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return np.array(pin.getFrameVelocity(robot.model, data, frame, world).linear)

    @cached_property
    def level(self) -> np.ndarray:
        """Rotation of the target's body axes to world at yaw zero, shape (3, 3); roll and pitch as at the start."""
        roll, pitch, _ = self.target.attitude
        return self.axes @ _turn(1, pitch) @ _turn(0, roll)

    @cached_property
    def attitude(self) -> np.ndarray:
        """Rotation of the target's body axes to world at the start, shape (3, 3)."""
        return self.axes @ _turn(2, self.target.attitude[2]) @ self.axes.T @ self.level

    @cached_property
    def lever_at_zero_yaw(self) -> np.ndarray:
        """From the target's centre of mass to its contact point at yaw zero, shape (3,), world axes [m].

        The effects that move the contact point have moved it.
        """
        contact = self.mechanism().contact
        assert contact is not None
        own = self.axes.T @ self.level @ np.array(self.target.contact_point)
        return self.axes @ np.array([contact.ahead, contact.lateral, own[2]])

    @cached_property
    def lever(self) -> np.ndarray:
        """The same at the start."""
        return self.axes @ _turn(2, self.target.attitude[2]) @ self.axes.T @ self.lever_at_zero_yaw

    @cached_property
    def pull(self) -> float:
        """Acceleration with which gravity and tilt bring the target to the hand, along the approach [m/s^2]."""
        mechanism = self.mechanism()
        falls = {"target": 1.0} if self.hand.stiffness > 0.0 else {"target": 1.0, "hand": -1.0}
        further = np.array(mechanism.gravity or self.gravity) - np.array(self.gravity)  # what effects add to it
        alone = float(further @ np.array(self.approach)) if self.base != "free" else 0.0
        return alone + sum(falls.get(f.body, 0.0) * f.acceleration for f in mechanism.fields)

    @cached_property
    def arrival(self) -> float:
        """Time of the first touch if nothing else acts on the way and the target's spin is slow [s]."""
        return arrival_time(self.target.gap + self.wrist.deflection, self.closing_speed, self.pull)

    @property
    def touching_speed(self) -> float:
        """Closing speed that gap and pull make of that at the start [m/s]; never less, however it is turned back."""
        return math.sqrt(self.closing_speed**2 + 2.0 * max(self.pull, 0.0) * (self.target.gap + self.wrist.deflection))

    @property
    def _pushed(self) -> bool:
        """Whether an effect, the base's spin or the joints may bring target and hand together."""
        mechanism = self.mechanism()
        return (
            self.motion.moves_robot
            or bool(mechanism.impulses)
            or any(f.port.startswith("target") for f in mechanism.forces)
        )

    def _require_movable(self, robot: Robot) -> None:
        """Refuse motion of what the scene holds."""
        motion = self.motion
        for name, what in (("base_velocity", "moves"), ("base_spin", "spins")):
            given = getattr(motion, name)
            if any(given) and self.base != "free":
                raise InputError(f"only a free base {what}", given=given, valid="base free", where=f"motion.{name}")
        for name in motion.joint_rates:
            if name not in robot.chain:
                raise NotFoundError("joint", name, robot.chain, where="motion.joint_rates")
        if motion.joint_rates and self.joints == "locked":
            given, valid = ", ".join(motion.joint_rates), "joints free or servo"
            raise InputError("locked joints do not move", given=given, valid=valid, where="motion.joint_rates")

    def _require_carried(self) -> None:
        mechanism = self.mechanism()
        riders = [n for n in mechanism.coordinates if mechanism.carrier_of(n) is not None]
        for name in self.motion.carried:
            if name not in riders:
                raise NotFoundError("carried body", name, riders, where="motion.carried")

    def _require_arrival(self) -> None:
        if self.target.gap + self.wrist.deflection < 0.0:
            raise InputError(
                "the scene starts in penetration",
                given=f"gap {self.target.gap:g} m, the tip {-self.wrist.deflection:g} m out of its rest",
                valid="a gap that the tip leaves open",
                where="target.gap",
            )
        still = self.target.speed + self.hand_speed <= 0.0 and self.closing_speed <= 0.0
        if still and self.pull <= 0.0 and not self._pushed:
            raise InputError(
                "the target never arrives: it does not approach the wrist",
                given=f"target.speed {self.target.speed:g} m/s, hand_speed {self.hand_speed:g} m/s",
                valid="a positive closing speed, or gravity, a tilt or an impulse that brings it",
                where="target.speed",
            )
        way = self.target.gap + self.wrist.deflection
        soonest = arrival_time(way, self.closing_speed, max(self.pull, 0.0))  # a wrist that sags meets it earlier
        late = math.isfinite(soonest) and self.duration is not None and soonest > self.duration
        if late and not any(self.target.spin) and not self._pushed:
            raise InputError(
                "the target never arrives: the simulation ends before",
                given=f"gap {self.target.gap:g} m at {self.closing_speed:g} m/s takes {soonest:.4g} s",
                valid=f"a duration above that; it is {self.duration:g} s",
                where="duration",
            )

    def with_effects(self, *effects: EffectAt) -> Scene:
        """This scene with further effects."""
        return replace(self, effects=(*self.effects, *effects))

    @classmethod
    def from_toml(cls, path: str | Path) -> Scene:
        """Read a scene from a TOML file; see `spacerobot.simulation.scene_toml`."""
        return made_from_file(cls, path)

    def to_toml(self, path: str | Path | None = None) -> str:
        """The scene as TOML text, also written to `path`, whole or not at all.

        A Robot made in Python is written by its name; a path as an absolute one.
        """
        robot = self.robot.name if isinstance(self.robot, Robot) else self.robot
        if isinstance(robot, str) and robot.lstrip().startswith("<"):
            robot = self.prepared.name
        named = str(robot.resolve()) if isinstance(robot, Path) else robot
        text = text_of({**{f.name: getattr(self, f.name) for f in fields(self)}, "robot": named})
        if path is not None:
            write_text(Path(path), text)
        return text
