"""A robot that moves, as its wrist feels it: small motions about its pose, in coordinates that no inertia couples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.effects.effect import BASE_PORTS
from spacerobot.model.robot import Robot

SAME = 1e-9
"""Share of a direction that must be new for it to be counted."""


@dataclass(frozen=True, eq=False)
class ServoArm:
    """Motions of an arm in coordinates that no inertia couples: the hand along the approach, then `count` others.

    Attributes:
        mass: of the hand, that of free joints [kg]; the others weigh 1 kg.
        joints: rates of the joints per rate of hand and others, shape (len(chain), 1 + count) [rad/m or 1].
        base: rates of a floating base, along and about the world's axes, shape (6, 1 + count); zeros where it is held.
        rigid: rates of hand and others where all that moves moves along the approach at 1 m/s, shape (1 + count,);
            the hand's alone where the base is held.
        of_rates: rates of hand and others per rate of joints and base, shape (1 + count, len(chain) + 6).
        after: the joint, or the base's motion, that each of the others was made to show.
    """

    mass: float
    joints: np.ndarray
    base: np.ndarray
    rigid: np.ndarray
    of_rates: np.ndarray
    after: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the coordinates: each further one is the first that moves what it is called after."""
        return ("hand", *(f"arm.{name}" for name in self.after))

    def row(self, rates: np.ndarray) -> dict[str, float]:
        """Rates over the coordinates, by name."""
        return {name: float(r) for name, r in zip(self.names, rates, strict=True)}


def servo_arm(
    robot: Robot,
    pose: np.ndarray,
    approach: tuple[float, ...],
    base: str,
    others: Mapping[str, float],
    *,
    joints: str = "servo",
    whole: bool = False,
) -> ServoArm | None:
    """The motions of a robot, its wrist slider apart; None if the hand cannot move along the approach.

    With H = L L^T (the slider's own motion along its axis taken out, which leaves its Schur complement) and
    velocities u = L^T v, inertia is the unit matrix. In these the hand's row of the Jacobian is the first axis, and
    the rows of the joints span what a force on the hand and the servos can move. No reduction is made beyond that.

    Args:
        robot: with its wrist aimed.
        pose: shape (len(chain),) [rad or m].
        approach: unit vector, world axes.
        base: "fixed" or "free".
        others: positions of joints outside the chain.
        joints: "locked", "free" or "servo".
        whole: whether the motions of a free base that neither hand nor joints show are wanted too.
    """
    configuration = robot.configuration(pose, others=dict(others))
    terms = terms_of(robot, configuration, regime_of(robot, base, joints))
    moving = np.concatenate([terms.base, terms.arm]).astype(int)
    inertia = terms.inertia[np.ix_(moving, moving)]
    if len(terms.slider):
        across = terms.inertia[np.ix_(moving, terms.slider)]
        inertia = inertia - across @ across.T / terms.inertia[terms.slider[0], terms.slider[0]]
    factor = np.linalg.cholesky(inertia)
    towards = np.array(approach) @ terms.jacobian[:3][:, moving]
    hand = np.linalg.solve(factor, towards)
    turn = _base_rotation(robot, configuration) if base == "free" else np.eye(3)
    shown = _rows(len(robot.chain), moving, terms.base, terms.arm, turn)
    seen = np.linalg.solve(factor, shown.T)
    size = float(np.linalg.norm(hand))
    if size * size < 1e-9:  # lighter than UNREACHABLE
        return None
    axes, after = [hand / size], []
    every = (*robot.chain, *BASE_PORTS)
    for name, column in zip(every, seen.T if whole else seen.T[: len(robot.chain)], strict=False):
        new = column.copy()
        for _ in range(2):  # Gram and Schmidt, twice, which is enough
            for axis in axes:
                new -= axis * (axis @ new)
        if np.linalg.norm(new) > SAME * np.linalg.norm(column):
            axes.append(new / np.linalg.norm(new))
            after.append(name)
    basis = np.array(axes).T
    metres = np.array([size, *np.ones(len(axes) - 1)])  # of the hand per unit of the first axis
    of_rates = (basis.T @ factor.T @ shown.T) * metres[:, None]
    rigid = np.zeros(len(axes))
    rigid[0] = 1.0
    if base == "free":
        rigid = of_rates[:, len(robot.chain) :][:, :3] @ np.array(approach)
    rates = seen.T @ basis / metres
    split = len(robot.chain)
    return ServoArm(1.0 / size**2, rates[:split], rates[split:], rigid, of_rates, tuple(after))


def _rows(chain: int, moving: np.ndarray, base: np.ndarray, arm: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Rates of the joints, and of the base along and about the world's axes, per rate of what moves.

    Args:
        chain: number of joints.
        moving, base, arm: places among what moves.
        turn: from the base's axes to the world's, shape (3, 3).

    Returns:
        shape (chain + 6, moving); zero rows of what is held. Its transpose goes the other way, being orthogonal.
    """
    rows = np.zeros((chain + 6, moving.size))
    if len(arm):
        rows[np.arange(chain), np.searchsorted(moving, arm)] = 1.0
    for k in (0, 3) if len(base) else ():
        rows[np.ix_(chain + k + np.arange(3), np.searchsorted(moving, base[k : k + 3]))] = turn
    return rows


def _base_rotation(robot: Robot, configuration: np.ndarray) -> np.ndarray:
    """Rotation of a floating base to world, shape (3, 3)."""
    import pinocchio as pin

    at = robot.model.joints[1].idx_q + 3
    turned = np.array(configuration[at : at + 4])
    return np.asarray(pin.Quaternion(turned).toRotationMatrix())
