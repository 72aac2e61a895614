"""An arm on servos as its wrist feels it: its small motions about the start pose, each servo as it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.robot import Robot

SAME = 1e-9
"""Share of a direction that must be new for it to be counted."""


@dataclass(frozen=True, eq=False)
class ServoArm:
    """Motions of an arm in coordinates that no inertia couples: the hand along the approach, then `count` others.

    Attributes:
        mass: of the hand, that of free joints [kg]; the others weigh 1 kg.
        joints: rates of the joints per rate of hand and others, shape (len(chain), 1 + count) [rad/m or 1].
        rigid: rates of hand and others where all that moves moves along the approach at 1 m/s, shape (1 + count,);
            the hand's alone where the base is held.
    """

    mass: float
    joints: np.ndarray
    rigid: np.ndarray

    @property
    def names(self) -> tuple[str, ...]:
        """Of the coordinates."""
        return ("hand", *(f"arm.{k}" for k in range(1, self.rigid.size)))

    def row(self, rates: np.ndarray) -> dict[str, float]:
        """Rates over the coordinates, by name."""
        return {name: float(r) for name, r in zip(self.names, rates, strict=True)}


def servo_arm(
    robot: Robot, pose: np.ndarray, approach: tuple[float, ...], base: str, others: Mapping[str, float]
) -> ServoArm | None:
    """The arm of a robot with servo joints, its wrist slider apart; None if the hand cannot move along the approach.

    With H = L L^T (the slider's own motion along its axis taken out, which leaves its Schur complement) and
    velocities u = L^T v, inertia is the unit matrix. In these the hand's row of the Jacobian is the first axis, and
    the rows of the joints span what a force on the hand and the servos can move. No reduction is made beyond that.

    Args:
        robot: with its wrist aimed.
        pose: shape (len(chain),) [rad or m].
        approach: unit vector, world axes.
        base: "fixed" or "free".
        others: positions of joints outside the chain.
    """
    terms = terms_of(robot, robot.configuration(pose, others=dict(others)), regime_of(robot, base, "servo"))
    moving = np.concatenate([terms.base, terms.arm]).astype(int)
    inertia = terms.inertia[np.ix_(moving, moving)]
    if len(terms.slider):
        across = terms.inertia[np.ix_(moving, terms.slider)]
        inertia = inertia - across @ across.T / terms.inertia[terms.slider[0], terms.slider[0]]
    factor = np.linalg.cholesky(inertia)
    towards = np.array(approach) @ terms.jacobian[:3][:, moving]
    hand = np.linalg.solve(factor, towards)
    chosen = np.zeros((moving.size, len(terms.arm)))
    chosen[np.searchsorted(moving, terms.arm), np.arange(len(terms.arm))] = 1.0
    joints = np.linalg.solve(factor, chosen)
    size = float(np.linalg.norm(hand))
    if size * size < 1e-9:  # lighter than UNREACHABLE
        return None
    axes = [hand / size]
    for column in joints.T:
        new = column.copy()
        for _ in range(2):  # Gram and Schmidt, twice, which is enough
            for axis in axes:
                new -= axis * (axis @ new)
        if np.linalg.norm(new) > SAME * np.linalg.norm(column):
            axes.append(new / np.linalg.norm(new))
    basis = np.array(axes).T
    metres = np.array([size, *np.ones(len(axes) - 1)])  # of the hand per unit of the first axis
    rigid = np.zeros(len(axes))
    rigid[0] = 1.0
    if base == "free":
        whole = np.zeros(moving.size)
        whole[:3] = _base_rotation(robot, pose, others).T @ np.array(approach)
        rigid = basis.T @ factor.T @ whole * metres
    return ServoArm(1.0 / size**2, joints.T @ basis / metres, rigid)


def _base_rotation(robot: Robot, pose: np.ndarray, others: Mapping[str, float]) -> np.ndarray:
    """Rotation of a floating base to world, shape (3, 3)."""
    import pinocchio as pin

    at = robot.model.joints[1].idx_q + 3
    turned = np.array(robot.configuration(pose, others=dict(others))[at : at + 4])
    return np.asarray(pin.Quaternion(turned).toRotationMatrix())
