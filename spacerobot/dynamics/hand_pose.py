"""Poses that bring the hand to a place without turning its face away from the target: damped least squares.

Five conditions, three of place and two of pointing; the roll about the target's direction is left free, since a
point contact does not feel it. What joints are left over is the arm's self-motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spacerobot.dynamics.batch import checked_poses
from spacerobot.dynamics.direction import unit_directions
from spacerobot.model.robot import Robot

TOLERANCE = 1e-6
"""A place is reached when the hand is this near [m, and rad of pointing]."""

_ITERATIONS = 60
_STEP = 0.3
_DAMPING = 1e-3
_PULL = 0.2
_PATIENCE = 8
"""Steps without a tenth of progress after which a place counts as out of reach."""


@dataclass(frozen=True, eq=False)
class HandAim:
    """What the hand must keep: where a vector fixed in it points.

    Attributes:
        robot: the robot, its floating base at the world's origin.
        frame: index of the hand's frame.
        in_hand: shape (3,), unit vector in the hand's axes.
        in_world: shape (3,), where it must point.
        low, high: shape (len(chain),), limits of the joints [rad or m]; infinite where there are none.
        place: shape (3,), where the hand is at the pose that the aim was taken from [m].
    """

    robot: Robot
    frame: int
    in_hand: np.ndarray
    in_world: np.ndarray
    low: np.ndarray
    high: np.ndarray
    place: np.ndarray

    def solve(self, place: ArrayLike, start: np.ndarray, rest: np.ndarray | None = None) -> np.ndarray | None:
        """A pose near `start`, shape (len(chain),), whose hand is at `place` (3,) and points as it must; else None.

        With `rest`, joints that are left over are drawn towards that pose, (len(chain),), so that a long walk from
        place to place does not drift.
        """
        wanted = np.asarray(place, dtype=float)
        model, data = self.robot.model, self.robot.model.createData()
        columns = [self.robot.velocity_index(name) for name in self.robot.chain]
        write = self.robot.writer(self.robot.chain)
        across = np.linalg.svd(self.in_world[None, :])[2][1:]
        turning = across @ np.cross(np.eye(3), self.in_world).T  # u x n is linear in u
        pose = np.array(start, dtype=float)
        best, stalled = np.inf, 0
        for _ in range(_ITERATIONS):
            jacobian = pin.computeFrameJacobian(model, data, write(pose), self.frame, pin.LOCAL_WORLD_ALIGNED)
            hand = data.oMf[self.frame]
            facing = hand.rotation @ self.in_hand
            error = np.concatenate([wanted - hand.translation, facing @ turning.T])
            size = float(np.abs(error).max())
            if size < TOLERANCE and facing @ self.in_world > 0.0:
                return pose
            stalled = 0 if size < 0.9 * best else stalled + 1
            best = min(best, size)
            if stalled > _PATIENCE:
                return None
            rows = np.concatenate([jacobian[:3, columns], across @ jacobian[3:, columns]])
            square = rows @ rows.T
            square.flat[::6] += _DAMPING * min(size, 1.0)
            wish = np.zeros_like(pose) if rest is None else _PULL * (rest - pose)
            step = wish + rows.T @ np.linalg.solve(square, error - rows @ wish)
            pose += step * min(1.0, _STEP / max(float(np.abs(step).max()), 1e-12))
            np.minimum(np.maximum(pose, self.low, out=pose), self.high, out=pose)
        return None


def hand_aim(robot: Robot, pose: ArrayLike, direction: ArrayLike, *, frame: str | None = None) -> HandAim:
    """The aim that the hand has at `pose` along `direction`.

    Args:
        robot: the robot.
        pose: shape (len(chain),) [rad or m].
        direction: shape (3,), unit vector in world axes, which the hand goes on pointing at.
        frame: the hand; the wrist mount if None.
    """
    q = checked_poses(robot, pose)[0]
    n = unit_directions(direction)
    index = robot.frame_id(frame or robot.tip)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    hand = data.oMf[index]
    low, high = chain_limits(robot)
    return HandAim(robot, index, hand.rotation.T @ n, n, low, high, np.array(hand.translation))


def chain_limits(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper limits of the chain's joints, shape (len(chain),) each; infinite where a joint has none."""
    low, high = np.full(len(robot.chain), -np.inf), np.full(len(robot.chain), np.inf)
    for i, name in enumerate(robot.chain):
        joint = robot.model.joints[robot.joint_id(name)]
        if joint.nq == 1:
            bounds = robot.model.lowerPositionLimit[joint.idx_q], robot.model.upperPositionLimit[joint.idx_q]
            if bounds[0] < bounds[1]:
                low[i], high[i] = bounds
    return low, high
