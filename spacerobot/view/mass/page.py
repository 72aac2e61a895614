"""One page that shows what effective mass means at a pose: every figure inside, no other file needed."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from jinja2 import Environment, StrictUndefined
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from spacerobot import __version__
from spacerobot.dynamics.batch import checked_poses, effective_mass_batch
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.soft_capture import SoftCapture, soft_capture
from spacerobot.dynamics.workspace import WorkspaceMap
from spacerobot.model.robot import Robot
from spacerobot.model.spacecraft import float_base
from spacerobot.simulation.parts import Servo
from spacerobot.support.jsonio import plain
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.mass.frequency_figure import frequency_figure, responses, ringing
from spacerobot.view.mass.map_figure import map_figure, slice_map
from spacerobot.view.mass.path_figure import path_figure, straight
from spacerobot.view.mass.soft_figure import soft_figure
from spacerobot.view.plotting import png, svg_uri

WIRED = {"stiffness": 1e5, "damping": 50.0}
"""Servos where none are stated [N m/rad, N m s/rad]."""


@dataclass(frozen=True, eq=False)
class MassQuestion:
    """What is to be shown.

    Attributes:
        robot: the robot.
        pose: shape (len(chain),) [rad or m].
        direction: shape (3,), unit vector in world axes.
        end: shape (len(chain),), where a path ends; the softest place of the map if None.
        servo_stiffness, servo_damping: one, or one for each joint [N m/rad, N m s/rad].
        tip_mass: target and slider [kg].
        wrist_stiffness: [N/m].
        speed: of approach [m/s].
    """

    robot: Robot
    pose: np.ndarray
    direction: np.ndarray
    end: np.ndarray | None = None
    servo_stiffness: float | list[float] = WIRED["stiffness"]
    servo_damping: float | list[float] = WIRED["damping"]
    tip_mass: float = 9.7
    wrist_stiffness: float = 530.0
    speed: float = 0.1


def figures_of(asked: MassQuestion) -> tuple[dict[str, Figure], dict[str, float | str]]:
    """The figures by name, and the numbers that the page's sentences need."""
    robot, pose, n = asked.robot, asked.pose, asked.direction
    floating = robot if robot.floating else float_base(robot)
    fixed = slice_map(robot, pose, n, base="fixed")
    maps = {
        "fixed base, joints free": fixed,
        "floating base, joints locked": slice_map(floating, pose, n, base="free", joints="locked"),
    }
    softest = fixed.poses.reshape(-1, len(pose))[fixed.extreme(heaviest=False)]
    end = softest if asked.end is None else asked.end
    way = straight(pose, end) if asked.end is not None or not np.allclose(pose, end) else np.array([pose, pose])
    found = responses(robot, pose, n, servo=Servo(asked.servo_stiffness, asked.servo_damping))
    soft = soft_capture(
        robot,
        pose,
        n,
        tip_mass=asked.tip_mass,
        speed=asked.speed,
        wrist_stiffness=asked.wrist_stiffness,
    )
    figures = {
        "ellipsoid_along_path": path_figure(robot, way, n),
        "workspace_map": map_figure(robot, pose, maps),
        "apparent_mass": frequency_figure(found, wrist_stiffness=asked.wrist_stiffness, tip_mass=asked.tip_mass),
        "soft_capture": soft_figure(robot, soft),
    }
    numbers = _numbers(asked, floating, fixed, soft)
    numbers["ringing_Hz"] = ringing(found["fixed"], asked.wrist_stiffness, asked.tip_mass)
    return figures, numbers


def mass_pictures(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike,
    out: str | Path,
    *,
    end: ArrayLike | None = None,
    servo: Servo | None = None,
    tip_mass: float = 9.7,
    wrist_stiffness: float = 530.0,
    speed: float = 0.1,
    overwrite: bool = False,
) -> Path:
    """Write what `spacerobot mass --pictures` shows: mass.html and its pictures.

    Args:
        robot: the robot.
        pose: shape (len(chain),) [rad or m].
        direction: shape (3,), unit vector in world axes.
        out: the folder.
        end: shape (len(chain),), where a path ends; the softest place of the map if None.
        servo: what holds the joints; 1e5 N m/rad and 50 N m s/rad if None.
        tip_mass: target and slider [kg].
        wrist_stiffness: [N/m].
        speed: of approach [m/s].
        overwrite: replace another run that is there.

    Returns:
        the page.

    Raises:
        InputError: the folder holds something else, or a value that cannot be.
    """
    held = servo or Servo(**WIRED)
    asked = MassQuestion(
        robot,
        checked_poses(robot, pose)[0],
        unit_directions(direction),
        None if end is None else checked_poses(robot, end)[0],
        held.stiffness,
        held.damping,
        tip_mass,
        wrist_stiffness,
        speed,
    )
    key = combined_hash("mass pictures", robot.urdf, plain([v for k, v in vars(asked).items() if k != "robot"]))
    with RunFolder(out, "mass", key, overwrite=overwrite) as folder:
        if not folder.finished:
            for name, content in mass_files(asked).items():
                folder.write(name, content)
            folder.finish()
        return folder.folder / "mass.html"


def mass_files(asked: MassQuestion) -> dict[str, str | bytes]:
    """The page and its pictures, by file name."""
    figures, numbers = figures_of(asked)
    return {
        **{f"{name}.png": png(figure) for name, figure in figures.items()},
        "mass.html": mass_page(asked, figures, numbers),
    }


def mass_page(asked: MassQuestion, figures: dict[str, Figure], numbers: dict[str, float | str]) -> str:
    """The page as HTML text."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    text = files("spacerobot.view").joinpath("templates/mass.html").read_text(encoding="utf-8")
    return environment.from_string(text).render(
        asked=asked,
        n=numbers,
        images={name: svg_uri(figure) for name, figure in figures.items()},
        version=__version__,
    )


def _numbers(asked: MassQuestion, floating: Robot, found: WorkspaceMap, soft: SoftCapture) -> dict[str, float | str]:
    def mass(robot: Robot, base: str, joints: str) -> float:
        batch = effective_mass_batch(robot, asked.pose, asked.direction, base=base, joints=joints)
        return float(batch.effective_mass_kg[0, 0])

    masses = found.effective_mass_kg[np.isfinite(found.effective_mass_kg)]
    return {
        "fixed_free_kg": mass(asked.robot, "fixed", "free"),
        "floating_free_kg": mass(floating, "free", "free"),
        "floating_locked_kg": mass(floating, "free", "locked"),
        "spacecraft": "its own spacecraft" if asked.robot.floating else "a spacecraft of 500 kg",
        "softest_place_kg": float(masses.min()),
        "hardest_place_kg": float(masses.max()),
        "softest_pose_kg": float(soft.effective_mass_kg[0]),
        "hardest_pose_kg": float(soft.effective_mass_kg[-1]),
        "poses": float(len(soft.poses)),
        "gain": soft.gain,
        "peak_force_N": float(soft.peak_force_N[soft.given]),
    }
