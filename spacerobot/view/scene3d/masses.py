"""Effective-mass ellipsoids along a motion."""

from __future__ import annotations

import numpy as np

from spacerobot.dynamics.mobility import by_inverse
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.extent import round_scale
from spacerobot.view.scene3d.film import Array, MassEllipsoid
from spacerobot.view.scene3d.robot_body import frame_poses

AT_MOST = 240
"""Poses at which the mobility is computed; between them it is interpolated."""


def mass_ellipsoid(
    robot: Robot, configurations: Array, reach: float, *, joints: str = "free", base: str | None = None
) -> MassEllipsoid | None:
    """The belted ellipsoid at the robot's tip (the mount, with a wrist) along a motion, (T, nq).

    None where nothing can move, or where the inertia of the robot's links does not allow for a mass.
    """
    count = len(configurations)
    chosen = np.unique(np.linspace(0, count - 1, min(count, AT_MOST)).astype(int))
    try:
        regime = regime_of(robot, base, joints)
        found = np.array([by_inverse(terms_of(robot, configurations[i], regime))[:3, :3] for i in chosen])
    except (InputError, np.linalg.LinAlgError):
        return None
    if not np.all(np.isfinite(found)) or not np.any(found):
        return None
    flat = found.reshape(len(chosen), 9)
    mobility = np.column_stack([np.interp(np.arange(count), chosen, column) for column in flat.T])
    # By the middle one of the principal masses: the greatest runs away near singular poses.
    typical = float(np.median(1.0 / np.maximum(np.linalg.eigvalsh(found)[:, 1], 1e-6 * np.abs(found).max())))
    limit = 0.36 * reach
    centre = frame_poses(robot, configurations, robot.tip)[:, :3]
    return MassEllipsoid(centre, mobility.reshape(count, 3, 3), round_scale(typical, 0.45 * limit), limit)


def mass_along(mobility: Array, direction: Array) -> Array:
    """Effective mass along a unit vector at each of T mobilities, shape (T,) [kg]; infinite where nothing gives."""
    along = np.einsum("i,tij,j->t", direction, mobility, direction)
    largest = np.abs(mobility).max()
    with np.errstate(divide="ignore"):
        masses: Array = np.where(along > 1e-10 * largest, 1.0 / np.maximum(along, 1e-300), np.inf)
    return masses
