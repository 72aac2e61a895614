"""The belted ellipsoid along a path, and the effective mass beside it, base fixed and floating."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from spacerobot.dynamics.batch import effective_mass_batch, mobility_batch
from spacerobot.dynamics.direction import unit_directions
from spacerobot.model.robot import Robot
from spacerobot.model.spacecraft import float_base
from spacerobot.view.mass.side import chain_points, draw_ellipsoid, draw_robot, plain_log, right_axis
from spacerobot.view.plotting import BLUE, GREEN, ORANGE, PURPLE, VERMILION, canvas, style

SHOWN = 4
"""Poses along the path at which arm and ellipsoid are drawn."""

_COLOURS = (BLUE, GREEN, ORANGE, PURPLE)


def path_figure(robot: Robot, poses: ArrayLike, direction: ArrayLike) -> Figure:
    """Arm and ellipsoids at a few poses; the effective mass at all of them.

    Args:
        robot: with a fixed base, or floating.
        poses: shape (N, len(chain)), N > 1 [rad or m]; two are joined by a straight path.
        direction: shape (3,), unit vector in world axes.
    """
    n = unit_directions(direction)
    right = right_axis(n)
    poses = np.asarray(poses, dtype=float)
    if len(poses) == 2:
        poses = straight(*poses)
    with style():
        figure = canvas(11.0, 4.6)
        side, curve = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
        chosen = np.unique(np.linspace(0, len(poses) - 1, SHOWN).astype(int))
        mobility = mobility_batch(robot, poses[chosen])
        typical = float(np.median(1.0 / np.linalg.eigvalsh(mobility)[:, 1]))
        size = float(np.linalg.norm(np.diff(chain_points(robot, poses[0]), axis=0), axis=1).sum())
        cut = 5.0 * typical
        scale = 0.06 * size / typical
        for k, (index, g) in enumerate(zip(chosen, mobility, strict=True)):
            alpha = 0.25 + 0.65 * k / max(len(chosen) - 1, 1)
            draw_robot(side, robot, poses[index], right, alpha)
            tip = chain_points(robot, poses[index])[-1]
            draw_ellipsoid(side, g, tip, scale, cut * scale, _COLOURS[k], right)
        side.set_aspect("equal")
        side.set(xlabel=f"{'xy'[right]} [m]", ylabel="z [m]")
        side.set_title(f"M(n) n: 10 cm are {0.1 / scale:.2g} kg, cut at {cut:.2g} kg", loc="left")
        along = np.linspace(0.0, 100.0, len(poses))
        for name, mass, colour, dash in masses_along(robot, poses, n):
            curve.plot(along, mass, color=colour, linestyle=dash, label=name)
        for k, index in enumerate(chosen):
            curve.axvline(along[index], color=_COLOURS[k], linewidth=5, alpha=0.25)
        curve.set(xlabel="along the path [%]", ylabel="effective mass [kg]", yscale="log")
        plain_log(curve.yaxis)
        curve.set_title(f"along ({', '.join(f'{x:.2g}' for x in n)})", loc="left")
        curve.legend()
        return figure


def masses_along(robot: Robot, poses: np.ndarray, direction: np.ndarray) -> list[tuple[str, np.ndarray, str, Any]]:
    """What to draw over the path: name, masses (N,) [kg] with infinity as NaN, colour, dash."""
    floating = robot if robot.floating else float_base(robot)
    wanted: list[tuple[str, Robot, str, str, str, Any]] = [
        ("fixed base, joints free", robot, "fixed", "free", BLUE, "-"),
        ("floating base, joints free", floating, "free", "free", VERMILION, (0, (5, 2))),
        ("floating base, joints locked", floating, "free", "locked", GREEN, (0, (1, 1))),
    ]
    found = []
    for name, body, base, joints, colour, dash in wanted:
        mass = effective_mass_batch(body, poses, direction, base=base, joints=joints).effective_mass_kg[:, 0]
        found.append((name, np.where(np.isfinite(mass), mass, np.nan), colour, dash))
    return found


def straight(start: np.ndarray, end: np.ndarray, count: int = 121) -> np.ndarray:
    """Poses from `start` to `end`, joint by joint at one pace, beginning and ending softly; (count, len(chain))."""
    pace = np.linspace(0.0, 1.0, count)
    pace = pace**2 * (3.0 - 2.0 * pace)
    return np.asarray(start) + pace[:, None] * (np.asarray(end) - np.asarray(start))
