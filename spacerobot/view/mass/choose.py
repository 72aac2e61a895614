"""From what a person names to a scene of effective mass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.view.mass.films import map_film, path_film
from spacerobot.view.scene3d.film import Film
from spacerobot.view.scene3d.robot_film import resting_pose


def mass_film(
    what: str | Path | Robot,
    pose: ArrayLike | None = None,
    end: ArrayLike | None = None,
    direction: ArrayLike = (1.0, 0.0, 0.0),
    *,
    joints: str = "free",
) -> Film:
    """A robot's workspace filled with its effective mass, or its ellipsoid along a path: `view --map`, `view --to`.

    Args:
        what: a robot, its name or URDF.
        pose: shape (len(chain),) [rad or m]; its resting pose if None.
        end: shape (len(chain),), where a path ends [rad or m]; the workspace if None.
        direction: shape (3,), unit vector in world axes.
        joints: "free" or "locked", of the workspace.

    Raises:
        InputError: no such robot, or numbers that do not fit it.
    """
    robot = what if isinstance(what, Robot) else _loaded(what)
    if not robot.chain:
        raise InputError("nothing moves the hand", given=robot.name, valid="a robot with joints")
    start = resting_pose(robot) if pose is None else _fitting(robot, pose, "--q")
    n = unit_directions(direction)
    if end is None:
        return map_film(robot, start, n, joints=joints)
    return path_film(robot, start, _fitting(robot, end, "--to"), n)


def _loaded(what: str | Path) -> Robot:
    path = Path(what)
    if path.is_dir() or path.suffix.lower() in (".toml", ".npz"):
        raise InputError("effective mass is shown of a robot", given=str(what), valid="a robot's name or URDF")
    return load(path if path.is_file() else what)


def _fitting(robot: Robot, pose: ArrayLike, where: str) -> np.ndarray:
    values = np.atleast_1d(np.asarray(pose, dtype=float))
    if values.shape != (len(robot.chain),):
        valid = f"{len(robot.chain)} numbers, one each for {', '.join(robot.chain)}"
        raise InputError("wrong length", given=f"{values.size} numbers", valid=valid, where=where)
    return values
