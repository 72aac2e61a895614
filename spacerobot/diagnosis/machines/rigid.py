"""Torque that a rigid arm asks for along a motion of its joints, its base held or afloat.

A base that floats moves as the joints make it: what a joint feels is then

    tau = M_jj a_j + M_jb a_b + h_j,   M_bb a_b = -(M_bj a_j + h_b),   M_bb v_b = -M_bj v_j

(Umetani and Yoshida 1989). Under gravity a table carries the base, which keeps its motions along the table, and its
turn.
That it began at rest need not be true of the turn, which a tracker shows; how fast it drifts no joint can feel.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.model.robot import Robot

STEP = 1e-4
"""By which a joint is moved to either side for the torque's change with its place [rad or m]: error 1e-8 of it."""

LEVEL = 1e-3
"""Angle by which a slide may be off the level [rad]: files round their angles."""

TINY = 1e-12


class Rigid:
    """Pinocchio's inverse dynamics of the logged joints, the others at rest."""

    def __init__(self, robot: Robot, gravity: Sequence[float], joints: Sequence[str]) -> None:
        """Of a robot in a field of gravity, world axes [m/s^2], along the motion of these joints."""
        self.model = pin.Model(robot.model)
        self.model.gravity.linear = np.array(gravity, dtype=float)
        self.data = self.model.createData()
        self._upper = np.triu(np.ones((self.model.nv, self.model.nv), dtype=bool))
        self.index = [robot.velocity_index(j) for j in joints]
        self._joints = [robot.joint_id(j) for j in joints]
        self.written = robot.writer(joints)
        self._afloat = _free_motions(np.array(gravity, dtype=float)) if robot.floating else np.zeros((6, 0))

    def torque(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, turn: np.ndarray | None = None
    ) -> np.ndarray:
        """Along a motion of the joints, shape (T, J) [N m or N].

        Args:
            position, velocity, acceleration: of the joints, shape (T, J).
            turn: rate of an afloat base about its free axis, shape (T,) [rad/s]; that of a base which began at rest if
                None.
        """
        out = np.empty_like(position)
        for t, (q, v, a) in enumerate(self.moving(position, velocity, acceleration, turn)):
            out[t] = pin.rnea(self.model, self.data, q, v, a)[self.index]
        return out

    def moving(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, turn: np.ndarray | None = None
    ) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """The whole robot along such a motion, its base with it: one after the other, written over by the next."""
        v, a = np.zeros(self.model.nv), np.zeros(self.model.nv)
        for t, q in enumerate(self.written(position)):
            v[self.index], a[self.index] = velocity[t], acceleration[t]
            if self.afloat:
                v[:6], a[:6] = self._base(q, v, a, None if turn is None else float(turn[t]))
            yield q, v, a

    def level(self, position: np.ndarray) -> list[bool]:
        """By joint, whether it slides level in poses, shape (T, J), wherever the weights are; not where afloat.

        About an upright axis none does work either, but a base that leans makes them.
        """
        if self.afloat:
            return [False] * len(self.index)
        down = self.model.gravity.linear / max(float(np.linalg.norm(self.model.gravity.linear)), TINY)
        axes = [joint_axis(self.model, j) for j in self._joints]
        off = np.array([np.inf if turns else 0.0 for turns, _ in axes])
        for q in self.written(_some(position)):
            pin.forwardKinematics(self.model, self.data, q)
            placed = [self.data.oMi[j].rotation @ axis for j, (_, axis) in zip(self._joints, axes, strict=True)]
            off = np.maximum(off, np.abs(np.array(placed) @ down))
        return [bool(x < LEVEL) for x in off]

    def by_zero(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, turn: np.ndarray | None = None
    ) -> np.ndarray:
        """By how much that torque rises with the zero of each joint's encoder, shape (T, J, J): of joint, encoder.

        A later zero is an earlier place.
        """
        motion, joints = (velocity, acceleration, turn), position.shape[1]
        if self.afloat:
            steps = STEP * np.eye(joints)
            less = [self.torque(position - s, *motion) - self.torque(position + s, *motion) for s in steps]
            return np.stack(less, axis=-1) / (2.0 * STEP)
        own, out = np.ix_(self.index, self.index), np.empty((position.shape[0], joints, joints))
        for t, (q, v, a) in enumerate(self.moving(position, velocity, acceleration)):
            pin.computeRNEADerivatives(self.model, self.data, q, v, a)
            out[t] = -self.data.dtau_dq[own]
        return out

    def by_gravity(self, position: np.ndarray, *_: np.ndarray | None) -> np.ndarray:
        """By how much that torque rises with a pull along each of the world's axes, shape (T, J, 3) [per m/s^2].

        Of an arm on a held base.
        """
        out = np.empty((*position.shape, 3))
        for t, q in enumerate(self.written(position)):
            for k, model in enumerate(self._pulled):
                out[t, :, k] = pin.computeGeneralizedGravity(model, self.data, q)[self.index]
        return out

    @cached_property
    def _pulled(self) -> list[pin.Model]:
        """The same arm under a unit of gravity along each of the world's axes."""
        out = []
        for axis in np.eye(3):
            model = pin.Model(self.model)
            model.gravity.linear = axis
            out.append(model)
        return out

    def with_bodies(self, bodies: Mapping[int, np.ndarray], pull: np.ndarray) -> Rigid:
        """The same arm with further bodies, and under a further pull.

        Args:
            bodies: joint -> the ten numbers (m, m c, I) of what is added to what it moves, in its frame, shape (10,).
            pull: world axes [m/s^2], shape (3,).
        """
        other = copy(self)
        other.model = pin.Model(self.model)
        other.model.gravity.linear = self.model.gravity.linear + pull
        for joint, more in bodies.items():
            own = np.asarray(self.model.inertias[joint].toDynamicParameters())
            other.model.inertias[joint] = pin.Inertia.FromDynamicParameters(own + more)
        other.data = other.model.createData()
        vars(other).pop("_pulled", None)  # made of the model
        return other

    def turning(self, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Rate at which an afloat base that began at rest turns about its free axis, shape (T,) [rad/s]."""
        v, a, out = np.zeros(self.model.nv), np.zeros(self.model.nv), np.zeros(position.shape[0])
        for t, q in enumerate(self.written(position) if self._afloat.shape[1] == 3 else ()):
            v[self.index] = velocity[t]
            out[t] = self._base(q, v, a)[0][3:] @ self._afloat[3:, 2]
        return out

    def _base(
        self, q: np.ndarray, v: np.ndarray, a: np.ndarray, turn: float | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and acceleration of the base, shape (6,) each, from those of the joints and perhaps its turn."""
        free, (own, joints) = self._afloat, self._coupled(self._inertia(q))
        moving, push = v.copy(), joints @ v[6:]
        if turn is None or free.shape[1] != 3:
            moving[:6] = -free @ np.linalg.solve(own, push)
        else:
            slide = -np.linalg.solve(own[:2, :2], push[:2] + own[:2, 2] * turn)
            moving[:6] = free @ np.append(slide, turn)
        bias = free.T @ pin.nonLinearEffects(self.model, self.data, q, moving)[:6]
        return moving[:6], -free @ np.linalg.solve(own, joints @ a[6:] + bias)

    @property
    def afloat(self) -> bool:
        """Whether the base floats."""
        return bool(self._afloat.size)

    def yielding(self, q: np.ndarray, joints: Sequence[int]) -> np.ndarray:
        """What joints, by their place among velocities, feel less of a wrench that a floating base gives way to.

        M_jb (F^T M_bb F)^-1 F^T with its free motions F, shape (joints, 6).
        """
        own, coupled = self._coupled(self._inertia(q))
        return np.asarray(coupled[:, np.array(joints) - 6].T @ np.linalg.solve(own, self._afloat.T))

    def _coupled(self, whole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of a robot's inertia that of its base's free motions, shape (F, F), and what couples these to all joints."""
        free = self._afloat
        return free.T @ whole[:6, :6] @ free, free.T @ whole[:6, 6:]

    def _inertia(self, q: np.ndarray) -> np.ndarray:
        full = pin.crba(self.model, self.data, q)  # of which the upper triangle is filled
        return np.asarray(np.where(self._upper, full, full.T))

    def inertia(self, positions: np.ndarray) -> np.ndarray:
        """Mean joint-space inertia over some of many poses, see `inertias`, shape (J, J)."""
        return np.asarray(np.mean(self.inertias(_some(positions)), axis=0))

    def inertias(self, positions: np.ndarray) -> np.ndarray:
        """Joint-space inertia in poses, shape (T, J), that of an afloat base taken off, shape (T, J, J)."""
        found = []
        for q in self.written(positions):
            whole = self._inertia(q)
            own = whole[np.ix_(self.index, self.index)]
            if self.afloat:
                base, coupled = self._coupled(whole)
                coupled = coupled[:, np.array(self.index) - 6]
                own = own - coupled.T @ np.linalg.solve(base, coupled)
            found.append(own)
        return np.array(found)


def _some(positions: np.ndarray) -> np.ndarray:
    """Of many poses, shape (T, J), enough to know them by."""
    return positions[:: max(1, positions.shape[0] // 50)]


def _free_motions(gravity: np.ndarray) -> np.ndarray:
    """Motions of a base, linear and angular, that nothing carries, shape (6, F)."""
    strength = float(np.linalg.norm(gravity))
    if strength == 0.0:
        return np.eye(6)
    up = -gravity / strength
    along = np.linalg.svd(up[None])[2][1:]
    out = np.zeros((6, 3))
    out[:3, :2], out[3:, 2] = along.T, up
    return out
