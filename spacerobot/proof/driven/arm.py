"""The arm in MuJoCo: driven along smooth paths by a computed torque; friction, load and inertia as built."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from spacerobot.diagnosis.machines.links import mass_of, with_masses
from spacerobot.model.library import load
from spacerobot.proof.engine.arm import POSE, mass_matrix, set_joint, shapeless
from spacerobot.proof.engine.rig import STANDARD_GRAVITY, Joint, Level
from spacerobot.support.errors import SimulationError

ROBOT = "pa10"
STEP = 5e-4
CONTROL = 2
"""Steps [s] of the integration, and how many of them a torque is held."""

STIFF, DAMPED = 400.0, 40.0
"""Gains of the computed-torque controller [1/s^2, 1/s]: it keeps the arm within a degree of its path."""

FRICTION_TIME = 1.2e-3
"""Time constant [s] of MuJoCo's friction constraint; it must exceed two steps."""

FASTEST = np.array([0.6, 0.6, 0.9, 0.9, 1.5, 1.5, 1.5])
"""Speeds [rad/s] of a fast path, by joint."""

Law = Callable[[np.ndarray, np.ndarray, float], float]
"""(position, velocity of all joints, time) -> torque at one joint [N m]."""


@dataclass
class Built:
    """The arm as it is built, in one trial; what is hidden edits it.

    Attributes:
        masses: link -> mass [kg], its inertia in proportion.
        rotors: joint -> reflected inertia [kg m^2].
        friction: joint -> dry friction [N m].
        damping: joint -> viscous friction [N m s/rad].
        levels: joint -> dry friction that changes with the motion.
        laws: (joint, explicit torque).
    """

    masses: dict[str, float]
    rotors: dict[str, float]
    friction: dict[str, float] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    levels: dict[str, Level] = field(default_factory=dict)
    laws: list[tuple[str, Law]] = field(default_factory=list)

    def compile(self) -> Any:
        """The MuJoCo model."""
        import mujoco

        spec = shapeless(str(with_masses(load(ROBOT), self.masses).urdf))
        spec.option.gravity = [0.0, 0.0, -STANDARD_GRAVITY]
        spec.option.timestep = STEP
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        for name in joints():
            joint = spec.joint(name)
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            joint.armature = self.rotors[name]
            # a level that changes needs the constraint from the start
            friction = max(self.friction.get(name, 0.0), 1e-9 if name in self.levels else 0.0)
            own = Joint("", "hinge", damping=self.damping.get(name, 0.0), friction=friction)
            set_joint(joint, own, FRICTION_TIME)
        return spec.compile()


@dataclass(frozen=True, eq=False)
class Path:
    """Where the joints are to go: a sum of sines for each, from the arm's ordinary pose, shapes (7, 3)."""

    sine: np.ndarray
    cosine: np.ndarray
    rate: np.ndarray  # (3,) rad/s

    @classmethod
    def drawn(cls, rng: np.random.Generator, speed: float, duration: float) -> Path:
        """A random path whose fastest joints reach this share of `FASTEST`."""
        sine, cosine = rng.uniform(-1.0, 1.0, (2, len(FASTEST), 3))
        rate = 2.0 * math.pi / duration * np.arange(1, 4)
        plain = cls(sine, cosine, rate)
        top = np.abs([plain.at(t)[1] for t in np.linspace(0.0, duration, 300)]).max(axis=0)
        scale = (speed * FASTEST / top)[:, None]
        return cls(scale * sine, scale * cosine, rate)

    def at(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity, acceleration, shape (7,) each."""
        s, c, w = np.sin(self.rate * t), np.cos(self.rate * t), self.rate
        position = np.array(POSE) + self.sine @ s + self.cosine @ (c - 1.0)
        return position, self.sine @ (w * c) - self.cosine @ (w * s), -self.sine @ (w**2 * s) - self.cosine @ (w**2 * c)


@dataclass(frozen=True, eq=False)
class Log:
    """What the arm did, without noise: time, shape (T,); position, velocity and torque of the drives, (T, 7)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray


@cache
def joints() -> tuple[str, ...]:
    """Names of the arm's joints, from the base."""
    return tuple(load(ROBOT).chain)


@cache
def links() -> dict[str, float]:
    """Link that moves -> mass [kg] as published."""
    robot = load(ROBOT)
    return {f"link{n}": mass_of(robot, f"link{n}") for n in range(1, len(joints()) + 1)}


def believed() -> Built:
    """The arm as published."""
    robot = load(ROBOT)
    rotors = {j: float(robot.model.armature[robot.velocity_index(j)]) for j in joints()}
    return Built(dict(links()), rotors)


@cache
def _planned() -> Any:
    """The model that the controller plans with."""
    return believed().compile()


def run(built: Built, path: Path, duration: float, rate: float) -> Log:
    """Drive the arm along a path and log it.

    Args:
        built: as it is.
        path: where it is to go.
        duration: in s.
        rate: of the log [Hz].

    Raises:
        SimulationError: the state stopped being finite.
    """
    import mujoco

    model, plain = built.compile(), _planned()
    data, plan = mujoco.MjData(model), mujoco.MjData(plain)
    index = {name: i for i, name in enumerate(joints())}
    data.qpos[:], data.qvel[:], _ = path.at(0.0)
    mujoco.mj_forward(model, data)
    torque = np.zeros(len(index))
    rows: list[np.ndarray] = []
    every = round(1.0 / rate / STEP)
    for i in range(round(duration / STEP)):
        if i % CONTROL == 0:
            position, velocity, acceleration = path.at(data.time)
            plan.qpos[:], plan.qvel[:] = position, velocity
            plan.qacc[:] = acceleration + STIFF * (position - data.qpos) + DAMPED * (velocity - data.qvel)
            mujoco.mj_inverse(plain, plan)
            torque = plan.qfrc_inverse.copy()
        if i % every == 0:
            rows.append(np.concatenate([[data.time], data.qpos, data.qvel, torque]))
        data.qfrc_applied[:] = torque
        for name, law in built.laws:
            data.qfrc_applied[index[name]] += law(data.qpos, data.qvel, data.time)
        for name, level in built.levels.items():
            k = index[name]
            push = float(data.qfrc_smooth[k])
            model.dof_frictionloss[k] = level(float(data.qvel[k]), push, float(data.qpos[k]), 0.0)
        mujoco.mj_step(model, data)
    table = np.array(rows)
    if not np.isfinite(table).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
        raise SimulationError("the arm in MuJoCo stopped being finite")
    time, parts = table[:, 0], np.split(table[:, 1:], 3, axis=1)
    return Log(time, *parts)


def torque_of(masses: Mapping[str, float], rotors: Mapping[str, float], logs: Sequence[Log]) -> list[np.ndarray]:
    """What a rigid arm asks of its drives along logged motions, shape (T, 7) each [N m]; MuJoCo's inverse dynamics."""
    import mujoco

    model = Built(dict(masses), dict(rotors)).compile()
    data = mujoco.MjData(model)
    found = []
    for log in logs:
        acceleration = np.gradient(log.velocity, log.time, axis=0)
        out = np.empty_like(log.torque)
        for k in range(log.time.size):
            data.qpos[:], data.qvel[:], data.qacc[:] = log.position[k], log.velocity[k], acceleration[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse
        found.append(out)
    return found


def inertias() -> dict[str, float]:
    """Joint -> inertia about it in the arm's ordinary pose, its rotor's with it [kg m^2]."""
    import mujoco

    model = _planned()
    data = mujoco.MjData(model)
    data.qpos[:] = POSE
    return dict(zip(joints(), np.diag(mass_matrix(model, data)).tolist(), strict=True))
