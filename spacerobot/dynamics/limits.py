"""Limits in which the hand becomes a wall: what the reduced mass of the contact tends to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spacerobot.dynamics.contact_frequency import reduced_mass
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.mobility import by_inverse
from spacerobot.dynamics.operational import along
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief


def scaled_base(robot: Robot, factor: float, *, inertia_too: bool = True) -> Robot:
    """A floating robot whose base body is `factor` times as heavy; its URDF text stays what it was.

    Args:
        robot: a floating robot.
        factor: positive.
        inertia_too: scale the inertia about the centre of mass as well. With mass alone the base still turns
            under the contact force, and the effective mass stays finite in the limit.

    Raises:
        InputError: a base that does not float, or a factor that is not positive.
    """
    if not robot.floating:
        raise InputError("only a floating base can be scaled", given=robot.name)
    if not (np.isfinite(factor) and factor > 0.0):
        raise InputError("the factor must be positive", given=factor)
    model = robot.model.copy()
    body = model.inertias[1]
    turning = factor * body.inertia if inertia_too else body.inertia
    model.inertias[1] = pin.Inertia(factor * body.mass, body.lever, turning)
    return replace(robot, model=model)


@dataclass(frozen=True, eq=False, repr=False)
class WallLimit(Brief):
    """Effective and reduced mass as the base grows.

    Attributes:
        factors: shape (F,), how many times the base is as heavy.
        mobility: shape (F,), 1/M at the frame [1/kg].
        reduced_mass_kg: shape (F,), m~ = M m/(M + m) with m = m_w + m_t.
        tip_mass_kg: m_w + m_t, the limit.
    """

    factors: np.ndarray
    mobility: np.ndarray
    reduced_mass_kg: np.ndarray
    tip_mass_kg: float


def wall_limit(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike,
    tip_mass: float,
    factors: Iterable[float],
    *,
    joints: str = "locked",
    inertia_too: bool = True,
    frame: str | None = None,
) -> WallLimit:
    """How m~ tends to m_w + m_t as the base of a floating robot grows (joints locked: M -> infinity).

    Args:
        robot: a floating robot.
        pose: shape (len(chain),) [rad or m], or the whole configuration, shape (nq,).
        direction: shape (3,), unit vector in world axes.
        tip_mass: m_w + m_t [kg].
        factors: base scales.
        joints: "locked", or "free" for a limit that stays finite.
        inertia_too: scale the base's inertia with its mass.
        frame: frame name; the wrist mount if None.

    Raises:
        InputError: a base that does not float, or values out of range.
    """
    if not (np.isfinite(tip_mass) and tip_mass > 0.0):
        raise InputError("the wrist and target mass must be positive", given=tip_mass)
    n = unit_directions(direction)
    scales = np.array(list(factors), dtype=float)
    mobility = []
    for factor in scales:
        heavy = scaled_base(robot, float(factor), inertia_too=inertia_too)
        terms = terms_of(heavy, pose, regime_of(heavy, "free", joints), frame)
        mobility.append(along(by_inverse(terms)[:3, :3], n))
    masses = [reduced_mass(g, tip_mass) for g in mobility]
    return WallLimit(scales, np.array(mobility), np.array(masses), tip_mass)
