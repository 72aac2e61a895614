"""Apparent mass of servo-held joints at many poses in many directions, at one frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spacerobot.dynamics.apparent_mass import RESONANT
from spacerobot.dynamics.batch import checked_poses
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.mobility import SINGULAR
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.servo import HoldsJoints, servo_or_its_numbers
from spacerobot.dynamics.terms import moving_columns
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError

_CHUNK = 4096


@dataclass(frozen=True, eq=False)
class ApparentMassBatch:
    """Apparent masses of N poses in K directions.

    Attributes:
        mobility: shape (N, K), complex acceleration per force [1/kg]; zero where below SINGULAR of the largest.
        directions: shape (K, 3).
        omega: frequency [rad/s].
    """

    mobility: np.ndarray
    directions: np.ndarray
    omega: float

    @property
    def magnitude(self) -> np.ndarray:
        """|m_app| [kg], shape (N, K); infinite where the frame cannot move along the direction."""
        size = np.abs(self.mobility)
        return np.divide(1.0, size, out=np.full(size.shape, np.inf), where=size > 0.0)

    @property
    def phase(self) -> np.ndarray:
        """Angle of m_app [rad], shape (N, K)."""
        return -np.angle(self.mobility)


def apparent_mass_batch(
    robot: Robot,
    poses: ArrayLike,
    directions: ArrayLike,
    omega: float,
    *,
    servo: HoldsJoints | None = None,
    stiffness: ArrayLike | None = None,
    damping: ArrayLike | None = None,
    frame: str | None = None,
    base: str | None = None,
    slider: str = "free",
    others: dict[str, float] | None = None,
) -> ApparentMassBatch:
    """`apparent_mass` of N poses x K directions.

    Args:
        robot: the robot; a floating base stands at the world origin.
        poses: shape (N, len(chain)), joint positions [rad or m].
        directions: shape (K, 3) or (3,), unit vectors in world axes.
        omega: [rad/s], positive.
        servo: K_p and D_p, as `Servo` has them.
        stiffness, damping: deprecated, of the servo.
        frame: frame name; the wrist mount if None.
        base: "fixed" or "free".
        slider: "free" or "locked".
        others: positions of joints outside the chain by name.

    Raises:
        InputError: values out of range, or a pose of which the frequency is an undamped resonance.
        NotFoundError: no such frame or joint.
    """
    if not (np.isfinite(omega) and omega > 0.0):
        raise InputError("the frequency must be positive and finite", given=omega, valid="rad/s > 0")
    n = np.atleast_2d(unit_directions(directions))
    held = servo_or_its_numbers(robot, servo, stiffness, damping)
    columns, _, arm, _ = moving_columns(robot, regime_of(robot, base, "servo", slider))
    spring = np.zeros(len(columns), dtype=complex)
    spring[arm] = held.stiffness / omega**2 + 1j * held.damping / omega
    q = checked_poses(robot, poses)
    mobility = np.empty((len(q), len(n)), dtype=complex)
    for start in range(0, len(q), _CHUNK):
        part = slice(start, start + _CHUNK)
        inertia, rows = _collect(robot, q[part], robot.frame_id(frame or robot.tip), columns, others)
        size = np.sqrt(np.einsum("kii->ki", inertia) + np.abs(spring.real) + np.abs(spring.imag))
        scaled = (inertia - np.diag(spring)) / (size[:, :, None] * size[:, None, :])
        smallest = np.linalg.svd(scaled, compute_uv=False)[:, -1]
        if (smallest < RESONANT).any():
            raise InputError(
                "the frequency is an undamped resonance of the servo-held arm",
                given=f"{omega:g} rad/s, pose {start + int(np.argmin(smallest))}",
                valid="another frequency, or servos with damping",
            )
        forces = np.swapaxes(rows / size[:, None, :], 1, 2)
        blocks = np.swapaxes(forces, 1, 2) @ np.linalg.solve(scaled, forces.astype(complex))
        values = np.einsum("di,kij,dj->kd", n, blocks, n, optimize=True)
        largest = np.linalg.norm(blocks, 2, axis=(1, 2))
        mobility[part] = np.where(np.abs(values) > SINGULAR * largest[:, None], values, 0.0)
    return ApparentMassBatch(mobility, n, float(omega))


def _collect(
    robot: Robot, poses: np.ndarray, frame: int, columns: np.ndarray, others: dict[str, float] | None
) -> tuple[np.ndarray, np.ndarray]:
    """H, shape (N, n, n), and the linear rows of J, shape (N, 3, n), of the moving coordinates."""
    data = robot.model.createData()
    nv = robot.model.nv
    inertia, rows = np.empty((len(poses), nv, nv)), np.empty((len(poses), 3, nv))
    for k, pose in enumerate(poses):
        q = robot.configuration(pose, others=others)
        inertia[k] = pin.crba(robot.model, data, q)
        jacobian = pin.computeFrameJacobian(robot.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        rows[k] = jacobian.reshape(6, nv)[:3]
    return inertia[:, columns[:, None], columns], rows[:, :, columns]
