"""Scenes of effective mass: its ellipsoid along a path, and the workspace filled with it."""

from __future__ import annotations

from dataclasses import replace

import matplotlib
import numpy as np

from spacerobot.dynamics.workspace import WorkspaceMap, workspace_map
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.view.mass.path_figure import straight
from spacerobot.view.mass.side import reach_of
from spacerobot.view.scene3d.extent import view_of, views_of
from spacerobot.view.scene3d.film import Body, Film, Look, Mark, Piece, Readout, View
from spacerobot.view.scene3d.masses import mass_along
from spacerobot.view.scene3d.robot_film import motion_film
from spacerobot.view.scene3d.solids import Solid, box, merged

SECONDS = 4.0
"""A path takes this long in its film."""

CLASSES = 9
"""Colours of a map."""

FINE = 14
"""Points across the reach of the arm in a map that fills space."""


def path_film(robot: Robot, start: np.ndarray, end: np.ndarray, direction: np.ndarray) -> Film:
    """The arm moves from one pose to another and back, the ellipsoid with it.

    Args:
        robot: any that loads.
        start: shape (len(chain),) [rad or m].
        end: alike.
        direction: shape (3,), unit vector in world axes, along which the mass is read out.
    """
    if np.allclose(start, end):
        raise InputError("a path needs two poses that differ", given=np.asarray(end).tolist())
    there = straight(start, end)
    film = _moving(robot, np.concatenate([there, there[-2::-1]]), 2.0 * SECONDS, direction)
    text = f"{robot.name}: effective mass along a path"
    return replace(film, title=text, description=text, marks=(Mark(0.0, "start"), Mark(SECONDS, "end")))


def map_film(
    robot: Robot, pose: np.ndarray, direction: np.ndarray, *, joints: str = "free", base: str | None = None
) -> Film:
    """Every place that the hand gets to without turning, coloured by its effective mass; the arm visits two of them.

    Args:
        robot: any that loads.
        pose: shape (len(chain),), the reference pose [rad or m].
        direction: shape (3,), unit vector in world axes.
        joints: "free" or "locked".
        base: "fixed" or "free".
    """
    middle, reach = reach_of(robot)
    axes = tuple(np.linspace(c - reach, c + reach, FINE + 1) for c in middle)
    found = workspace_map(robot, pose, direction, axes=(axes[0], axes[1], axes[2]), joints=joints, base=base)
    if not np.isfinite(found.effective_mass_kg).any():
        raise InputError("the hand cannot give way anywhere", given=f"{found.base} base, {joints} joints")
    light, heavy = (found.way_to(found.extreme(heaviest=h)) for h in (False, True))
    poses = np.concatenate([light, light[::-1], heavy, heavy[::-1]])
    film = _moving(robot, _evenly(poses, 241), 3.0 * SECONDS, direction, joints=joints, base=base)
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(poses, axis=0)).max(axis=1))])
    at = 3.0 * SECONDS * length / length[-1] if length[-1] > 0.0 else length
    marks = (Mark(float(at[len(light) - 1]), "softest"), Mark(float(at[2 * len(light) + len(heavy) - 1]), "hardest"))
    cloud, legend = _cloud(found, 2.0 * reach / FINE)
    focus, radius, floor = view_of((*film.bodies, *cloud))
    seen = View("Workspace", middle, 0.95 * reach, (1.0, -1.5, 0.6))
    masses = found.effective_mass_kg[np.isfinite(found.effective_mass_kg)]
    text = (
        f"{robot.name}, {found.base} base, {joints} joints: the hand gets to {int(found.reached.sum())} places "
        f"without turning, its effective mass {masses.min():.3g} to {masses.max():.3g} kg"
    )
    return replace(
        film,
        title=f"{robot.name}: effective mass over the workspace",
        subtitle=f"along ({', '.join(f'{x:.3g}' for x in found.direction)}); {found.base} base, {joints} joints",
        description=text,
        bodies=(*film.bodies, *cloud),
        focus=focus,
        reach=radius,
        floor=floor,
        views=(seen, *views_of(focus, radius)),
        marks=marks,
        notes=legend,
        trails=(),
    )


def _moving(
    robot: Robot,
    poses: np.ndarray,
    seconds: float,
    direction: np.ndarray,
    *,
    joints: str = "free",
    base: str | None = None,
) -> Film:
    configurations = np.array([robot.configuration(p) for p in poses])
    film = motion_film(robot, np.linspace(0.0, seconds, len(poses)), configurations, joints=joints, base=base)
    if film.ellipsoid is None:
        return film
    along = Readout("effective mass along the direction", "kg", mass_along(film.ellipsoid.mobility, direction))
    return replace(film, readouts=(along, *film.readouts), chart=along.name)


def _evenly(poses: np.ndarray, count: int) -> np.ndarray:
    """The same way through poses, (count, n), at one pace of the fastest joint."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(poses, axis=0)).max(axis=1))])
    kept = np.concatenate([[True], np.diff(length) > 0.0])
    if kept.sum() < 2:
        return np.repeat(poses[:1], count, axis=0)
    at = np.linspace(0.0, length[-1], count)
    return np.column_stack([np.interp(at, length[kept], column[kept]) for column in poses.T])


def _cloud(found: WorkspaceMap, step: float) -> tuple[tuple[Body, ...], tuple[str, ...]]:
    """Small cubes on the grid, in classes of equal ratio, and what the colours mean."""
    masses = found.effective_mass_kg
    finite = masses[np.isfinite(masses)]
    low, high = float(finite.min()), float(np.quantile(finite, 0.97))
    edges = np.geomspace(low, max(high, 1.01 * low), CLASSES + 1)
    of = np.clip(np.searchsorted(edges, masses, side="right") - 1, 0, CLASSES - 1)
    points = found.points()
    behind = points[..., 1] > found.place[1] - 0.6 * step
    still = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]])
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 1.0, CLASSES))
    cube = box((0.2 * step,) * 3, 0.0)
    pieces = []
    for k in range(CLASSES):
        chosen = points[found.reached & behind & (of == k)]
        if len(chosen):
            solid = merged([Solid(cube.points + p, cube.normals, cube.faces) for p in chosen])
            red, green, blue = (float(c) for c in colours[k][:3])
            pieces.append(Piece(solid, Look((red, green, blue), metal=0.0, rough=0.8, glow=0.35)))
    legend = (
        f"Each cube is a place that the hand gets to without turning; dark is light, {low:.3g} kg, and yellow is "
        f"heavy, {high:.3g} kg and more. Cut open: the half before the hand is left away. "
        "A redundant arm could stand otherwise at most of them.",
    )
    return (Body("workspace", tuple(pieces), still, kind="stage"),), legend
