"""From what a person names to a scene of effective mass."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from spacerobot.model.library import load
from spacerobot.support.errors import InputError
from spacerobot.view.mass.films import map_film, path_film
from spacerobot.view.scene3d.film import Film
from spacerobot.view.scene3d.robot_film import resting_pose


def mass_film(
    what: str,
    pose: Sequence[float] | None,
    end: Sequence[float] | None,
    direction: Sequence[float],
    *,
    filled: bool,
    joints: str = "free",
) -> Film:
    """A robot's workspace filled with its effective mass, or its ellipsoid along a path.

    Args:
        what: a robot's name or URDF.
        pose: (len(chain),) [rad or m]; its resting pose if None.
        end: of the path; None with `filled`.
        direction: (3,), unit vector in world axes.
        filled: the workspace.
        joints: "free" or "locked", of the workspace.

    Raises:
        InputError: no such robot, or numbers that do not fit it.
    """
    path = Path(what)
    if path.is_dir() or path.suffix.lower() in (".toml", ".npz"):
        raise InputError("effective mass is shown of a robot", given=what, valid="a robot's name or URDF")
    if filled and end is not None:
        raise InputError("a map has no path", valid="--map or --to", where="--to")
    robot = load(path if path.is_file() else what)
    if not robot.chain:
        raise InputError("nothing moves the hand", given=robot.name, valid="a robot with joints")
    for option, values in (("--q", pose), ("--to", end)):
        if values is not None and len(values) != len(robot.chain):
            valid = f"{len(robot.chain)} numbers, one each for {', '.join(robot.chain)}"
            raise InputError("wrong length", given=f"{len(values)} numbers", valid=valid, where=option)
    start = resting_pose(robot) if pose is None else np.array(pose, dtype=float)
    n = np.array(direction, dtype=float)
    if end is None:
        return map_film(robot, start, n, joints=joints)
    return path_film(robot, start, np.array(end, dtype=float), n)
