"""Inertia and Jacobian of what may move, cut out of the whole model's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.dynamics.jacobian import frame_jacobian
from spacerobot.dynamics.regime import Regime, partition_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


@dataclass(frozen=True, eq=False)
class Terms:
    """H and J over n moving coordinates at one pose.

    Attributes:
        inertia: shape (n, n), joint-space inertia with armature.
        jacobian: shape (6, n), frame velocity per generalised velocity; linear first, world axes.
        base, arm, slider: indices into the n coordinates; empty where locked or absent.
        columns: shape (n,), the coordinates' places in the model's velocity vector.
    """

    inertia: np.ndarray
    jacobian: np.ndarray
    base: np.ndarray
    arm: np.ndarray
    slider: np.ndarray
    columns: np.ndarray


def terms_of(robot: Robot, configuration: ArrayLike, regime: Regime, frame: str | None = None) -> Terms:
    """H and J of the coordinates that `regime` lets move; servo joints count as moving.

    Args:
        robot: the robot.
        configuration: shape (nq,), or a pose, shape (len(chain),).
        regime: what may move.
        frame: frame name; the wrist mount if None.

    Raises:
        InputError: a configuration that is not one (length, NaN, quaternion of another length than 1).
        NotFoundError: no such frame.
    """
    configuration = checked_configuration(robot, configuration)
    columns, base, arm, slider = moving_columns(robot, regime)
    return Terms(
        inertia=joint_space_inertia(robot, configuration)[np.ix_(columns, columns)],
        jacobian=frame_jacobian(robot, configuration, frame)[:, columns],
        base=base,
        arm=arm,
        slider=slider,
        columns=columns,
    )


def moving_columns(robot: Robot, regime: Regime) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Which coordinates move: places in the model's velocity, then base, arm and slider among them."""
    part = partition_of(robot)
    groups = (
        part.base if regime.base == "free" else part.base[:0],
        part.arm if regime.joints != "locked" else part.arm[:0],
        part.slider if regime.slider == "free" else part.slider[:0],
    )
    columns = np.concatenate(groups)
    ends = np.cumsum([len(group) for group in groups])
    base, arm, slider = (np.arange(end - len(group), end) for end, group in zip(ends, groups, strict=True))
    return columns, base, arm, slider


def checked_configuration(robot: Robot, configuration: ArrayLike) -> np.ndarray:
    """The configuration as floats, shape (nq,); a pose, shape (len(chain),), is filled up with neutral values.

    Raises:
        InputError: wrong length, not finite, or a base attitude that is not a unit quaternion.
    """
    try:
        configuration = np.asarray(configuration, dtype=float)
    except (TypeError, ValueError):
        raise InputError("pose is not a list of numbers", given=configuration) from None
    n = len(robot.chain)
    if configuration.shape == (n,) and n != robot.model.nq:
        configuration = robot.configuration(configuration)
    if configuration.shape != (robot.model.nq,):
        raise InputError(
            "pose has the wrong length",
            given=configuration.shape,
            valid=f"({n},): {', '.join(robot.chain)}; or a whole configuration, ({robot.model.nq},)",
        )
    if not np.isfinite(configuration).all():
        raise InputError("configuration is not finite", given=configuration.tolist())
    if robot.floating:
        start = robot.model.joints[1].idx_q + 3
        norm = float(np.linalg.norm(configuration[start : start + 4]))
        if abs(norm - 1.0) > 1e-6:
            raise InputError("the base attitude is not a unit quaternion", given=f"norm {norm:.9g}")
    return configuration
