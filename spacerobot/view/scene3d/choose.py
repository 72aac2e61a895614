"""From what a person names - a robot, a scene, a trajectory, a study - to the film of it."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.recordings.study import Study, bundled_studies, load_study
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import read_scene
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.film import Film
from spacerobot.view.scene3d.robot_film import robot_film


def film(
    what: str | Path | Robot | Scene | Trajectory | Study | tuple[Trajectory, Scene],
    *,
    trial: str | None = None,
    pose: ArrayLike | None = None,
) -> Film:
    """What `spacerobot view` shows, of a thing or of its name; `show` and `write_page` take it from there.

    Args:
        what: a robot, a scene (it is simulated), a trajectory (with its scene, or it is read from the trajectory's own
            text), a study; or whatever `spacerobot view` takes: a name or a path.
        trial: of a study; the first if None.
        pose: of a robot, shape (len(chain),) [rad or m].

    Raises:
        InputError: it is none of these, or an option does not go with it.
    """
    if isinstance(what, str | Path):
        given = None if pose is None else np.asarray(pose, dtype=float).tolist()
        return film_of(str(what), trial=trial, pose=given)
    for option, value, kind in (("trial", trial, Study), ("pose", pose, Robot)):
        if value is not None and not isinstance(what, kind):
            raise InputError(f"goes with a {kind.__name__}", given=type(what).__name__, where=option)
    if isinstance(what, Robot):
        return robot_film(what, None if pose is None else np.asarray(pose, dtype=float))
    if isinstance(what, Study):
        return _of_study(what, trial)
    if isinstance(what, Scene):
        return _simulated(what)
    if isinstance(what, Trajectory):
        return _of_trajectory(what)
    if isinstance(what, tuple) and len(what) == 2:
        return _of_trajectory(*what)
    valid = "a robot, scene, trajectory or study, or its name"
    raise InputError("no film can be made of this", given=type(what).__name__, valid=valid)


def film_of(what: str, *, trial: str | None = None, data: str | None = None, pose: list[float] | None = None) -> Film:
    """The film of a robot, a scene file, a trajectory, a study or a verdict.

    Settled in this order: a .npz file (or a folder with trajectory.npz) is a trajectory; verdict.json (or a folder
    with it) is what a diagnosis found; a .toml file with a
    [baseline] is a study, another one a scene; a folder with study.toml is a study; else it is a robot's name or
    URDF, or the name of a bundled study.

    Args:
        what: name or path.
        trial: of a study; the first if None.
        data: data root of a study.
        pose: of a robot [rad or m].

    Raises:
        InputError: it is none of these, or an option does not go with it.
    """
    kind, path = kind_of(what, trial=trial, data=data, q=pose)
    if kind == "trajectory":
        return _of_trajectory(Trajectory.load(path))
    if kind == "verdict":
        from spacerobot.view.scene3d.verdict_film import verdict_film

        return verdict_film(path)
    if kind == "study":
        return _of_study(load_study(path, data), trial)
    if kind == "scene":
        return _simulated(read_scene(path))
    robot = load(Path(what) if path.is_file() else what)
    if pose is not None and len(pose) != len(robot.chain):
        valid = f"{len(robot.chain)} numbers, one each for {', '.join(robot.chain)}"
        raise InputError("wrong length", given=f"{len(pose)} numbers", valid=valid, where="--q")
    return robot_film(robot, None if pose is None else np.array(pose))


# Simulation and diagnosis take seconds to load, and a robot's scene needs neither.


def _of_study(study: Study, trial: str | None) -> Film:
    from spacerobot.view.scene3d.study_film import study_film

    return study_film(study, trial)


def _of_trajectory(trajectory: Trajectory, scene: Scene | None = None) -> Film:
    from spacerobot.view.scene3d.trajectory_film import trajectory_film

    return trajectory_film(trajectory) if scene is None else trajectory_film(trajectory, scene)


def _simulated(scene: Scene) -> Film:
    from spacerobot.simulation.simulate import simulate

    return _of_trajectory(simulate(scene), scene)


_WANTED = {"trial": "study", "data": "study", "q": "robot", "joints": "robot"}
"""Option -> the only kind that it goes with."""


def kind_of(what: str, **options: object) -> tuple[str, Path]:
    """What a person names, "robot", "scene", "trajectory", "study" or "verdict", and the path that it would be.

    Args:
        what: name or path.
        options: of the command line, None where not given: `trial`, `data`, `q`, `joints`.

    Raises:
        InputError: an option does not go with it.
    """
    kind, path = _kind(what)
    for option, value in options.items():
        if value is not None and kind != _WANTED[option]:
            raise InputError(f"goes with a {_WANTED[option]}", given=f"{what} is a {kind}", where=f"--{option}")
    return kind, path


def _kind(what: str) -> tuple[str, Path]:
    path = Path(what)
    if path.is_dir():
        if (path / "trajectory.npz").is_file():
            return "trajectory", path / "trajectory.npz"
        if (path / "verdict.json").is_file():
            return "verdict", path / "verdict.json"
        return "study", path
    if path.suffix.lower() == ".json":
        return "verdict", path
    if path.suffix.lower() == ".npz":
        return "trajectory", path
    if path.suffix.lower() == ".toml":
        return ("study" if _is_study(path) else "scene"), path
    if what in bundled_studies():
        return "study", path
    return "robot", path


def _is_study(path: Path) -> bool:
    """Whether a TOML file has what only studies have; unreadable ones are left to those who complain well."""
    try:
        with path.open("rb") as stream:
            found = tomllib.loads(stream.read(4_000_000).decode("utf-8"))
    except (OSError, UnicodeError, tomllib.TOMLDecodeError, RecursionError, ValueError):
        return False
    return bool({"baseline", "streams", "trials"} & set(found))
