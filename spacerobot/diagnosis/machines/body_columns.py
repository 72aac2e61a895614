"""What a body fixed to a link asks for at an arm's joints: ten numbers, and torques in proportion to each.

    tau = Y(q, v, a) phi,   phi = (m, m c, I)

(Atkeson, An and Hollerbach 1986, eq. 4). A base that floats gives way to what it carries (`Rigid.yielding`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy

import numpy as np
import pinocchio as pin

from spacerobot.diagnosis.machines.contract import TEN
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.model.robot import Robot


class BodyColumns:
    """Torques at the logged joints by each of the ten numbers of a body at some links."""

    def __init__(self, robot: Robot, arm: Rigid) -> None:
        """Of a robot, whose rigid part along the logged joints is `arm`."""
        self.robot, self.model, self.data, self.arm = robot, arm.model, arm.model.createData(), arm
        self._frames = {f.name: f for f in robot.model.frames if f.type == pin.FrameType.BODY}
        self._moments: dict[int, tuple[np.ndarray, np.ndarray]] = {}  # of a joint's own body, once it is asked for

    def of(self, arm: Rigid) -> BodyColumns:
        """The same, the arm otherwise loaded or in another gravity."""
        other = copy(self)
        other.model, other.data, other.arm, other._moments = arm.model, arm.model.createData(), arm, {}
        return other

    def numbers(self, link: str, place: Sequence[float] | np.ndarray | None) -> np.ndarray:
        """Those of a body of 1 kg at a place in a link's frame [m], shape (10,).

        Without a place, of as much of what the link's joint moves by itself; zero where that has no mass.
        """
        if place is None:
            own = self.model.inertias[self.joint_of(link)]
            return np.asarray(own.toDynamicParameters()) / own.mass if own.mass > 0.0 else np.zeros(TEN)
        at = self._frames[link].placement.act(np.asarray(place, dtype=float))
        return np.asarray(pin.Inertia(1.0, at, np.zeros((3, 3))).toDynamicParameters())

    def carried(self, link: str, place: Sequence[float] | np.ndarray | None) -> float:
        """The largest mass that what the link's joint moves by itself may have at a place in the link's frame [kg].

        All of it without a place. What is left without that mass is still a body: its pseudo-inertia, the second
        moments of its mass, has no negative eigenvalue (Wensing, Kim and Slotine 2018, IEEE RA-L 3(1), 60).
        """
        joint = self.joint_of(link)
        if place is None:
            return float(self.model.inertias[joint].mass)
        if joint not in self._moments:
            self._moments[joint] = np.linalg.eigh(self.model.inertias[joint].toPseudoInertia().toMatrix())
        size, axes = self._moments[joint]
        along = axes.T @ [*self._frames[link].placement.act(np.asarray(place, dtype=float)), 1.0]
        return float(1.0 / np.sum(along**2 / np.maximum(size, np.finfo(float).tiny)))

    def ends(self, joints: Iterable[str], felt_by: Iterable[str]) -> tuple[str, ...]:
        """ "link.NAME" of the last link that each of some joints moves by itself, in order; of those felt by others."""
        last = {self.joint_of(n): f"link.{n}" for n in self.robot.links_on(felt_by)}
        return tuple(last[i] for j in joints if (i := self.robot.joint_id(j)) in last)

    def joint_of(self, link: str) -> int:
        """Index of the joint that moves a link."""
        return int(self._frames[link].parentJoint)

    def inertia(self, link: str, row: int, position: np.ndarray) -> np.ndarray:
        """What each number adds to the inertia about a logged joint in poses, shape (T, J): shape (T, 10)."""
        still, pushed = np.zeros_like(position), np.zeros_like(position)
        pushed[:, row] = 1.0
        pulled, weight = (self.along([link], [row], position, still, a) for a in (pushed, still))
        return np.asarray(pulled - weight)

    def along(
        self,
        links: Sequence[str],
        rows: Sequence[int],
        position: np.ndarray,
        velocity: np.ndarray,
        acceleration: np.ndarray,
        turn: np.ndarray | None = None,
    ) -> np.ndarray:
        """Torques along a motion.

        Args:
            links: that carry the body, K of them.
            rows: which of the logged joints feel it, R of them.
            position, velocity, acceleration: of the logged joints, shape (T, J) each.
            turn: rate of a base that floats about its free axis, shape (T,) [rad/s]; None where it began at rest, or is
                held.

        Returns:
            shape (T, R K 10) [N m or N, per unit of each number].
        """
        columns = np.concatenate([TEN * (self.joint_of(n) - 1) + np.arange(TEN) for n in links])
        felt = [self.arm.index[r] for r in rows]
        out = np.empty((position.shape[0], len(rows), columns.size))
        for t, (q, v, a) in enumerate(self.arm.moving(position, velocity, acceleration, turn)):
            found = pin.computeJointTorqueRegressor(self.model, self.data, q, v, a)[:, columns]
            out[t] = found[felt] - self.arm.yielding(q, felt) @ found[:6] if self.arm.afloat else found[felt]
        return out.reshape(out.shape[0], -1)
