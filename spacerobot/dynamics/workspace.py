"""Effective mass over the workspace: what a target would feel wherever the hand could wait for it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.batch import checked_poses
from spacerobot.dynamics.hand_pose import hand_aim
from spacerobot.dynamics.mobility import by_inverse
from spacerobot.dynamics.operational import along, reciprocal
from spacerobot.dynamics.regime import Regime, regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief, html_table
from spacerobot.support.tables import data_frame, data_set

if TYPE_CHECKING:
    import pandas
    import xarray

MOST = 60_000
"""Points of a grid; more would take minutes."""


@dataclass(frozen=True, eq=False, repr=False)
class WorkspaceMap(Brief):
    """Effective mass on a grid of hand places.

    The poses are those that continuous motion leads to from the reference pose, each found from a neighbour's and drawn
    towards the reference: a redundant arm could stand otherwise at most of these places.

    Attributes:
        axes: coordinates along x, y and z [m], one array each; an axis of one value is not varied.
        poses: shape (nx, ny, nz, len(chain)) [rad or m]; NaN where the hand does not get.
        effective_mass_kg: shape (nx, ny, nz); NaN alike, infinite where the hand cannot give way.
        direction: shape (3,), along which the mass is felt and the hand keeps pointing.
        came_from: shape (nx, ny, nz), flat index of the neighbour a pose was found from; -1 for none.
        place: shape (3,), of the hand at the reference pose [m].
        base, joints: what may move.
    """

    axes: tuple[np.ndarray, np.ndarray, np.ndarray]
    poses: np.ndarray
    effective_mass_kg: np.ndarray
    direction: np.ndarray
    came_from: np.ndarray
    place: np.ndarray
    base: str
    joints: str

    @property
    def reached(self) -> np.ndarray:
        """Whether the hand gets there, shape (nx, ny, nz)."""
        return ~np.isnan(self.effective_mass_kg)

    def points(self) -> np.ndarray:
        """Places of the grid, shape (nx, ny, nz, 3) [m]."""
        return np.stack(np.meshgrid(*self.axes, indexing="ij"), axis=-1)

    def extreme(self, *, heaviest: bool) -> int:
        """Flat index of the lightest or heaviest place with a finite mass."""
        masses = self.effective_mass_kg.ravel()
        masses = np.where(np.isfinite(masses), masses, -np.inf if heaviest else np.inf)
        return int(masses.argmax() if heaviest else masses.argmin())

    def way_to(self, index: int) -> np.ndarray:
        """Poses from where the search began to a place, by its flat index; shape (steps, len(chain))."""
        poses = self.poses.reshape(-1, self.poses.shape[-1])
        way = []
        while index >= 0:
            way.append(poses[index])
            index = int(self.came_from.flat[index])
        return np.array(way[::-1])

    def _repr_html_(self) -> str:
        there = np.isfinite(self.effective_mass_kg)
        places = self.points().reshape(-1, 3)
        rows = []
        for word, heaviest in (("lightest", False), ("heaviest", True)):
            if there.any():
                k = self.extreme(heaviest=heaviest)
                at = ", ".join(f"{x:.3g}" for x in places[k])
                rows.append((f"{word}, with the hand at ({at}) m", float(self.effective_mass_kg.flat[k]), "kg"))
        along = ", ".join(f"{x:.4g}" for x in self.direction)
        title = f"Effective mass along ({along}), base {self.base}, joints {self.joints}"
        notes = (f"The hand gets to {int(self.reached.sum())} of {self.reached.size} places without turning.",)
        return html_table(title, rows, ("", "value", "unit"), notes)

    def to_frame(self) -> pandas.DataFrame:
        """A row for each place that the hand gets to: x, y, z and the mass there, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        there = self.reached.ravel()
        columns = dict(zip("xyz", self.points().reshape(-1, 3)[there].T, strict=True))
        columns["effective_mass"] = self.effective_mass_kg.ravel()[there]
        return data_frame(columns, units={"x": "m", "y": "m", "z": "m", "effective_mass": "kg"})

    def to_xarray(self) -> xarray.Dataset:
        """Mass and poses over x, y and z, as a data set of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        grid = ("x", "y", "z")
        return data_set(
            {
                "effective_mass": (grid, self.effective_mass_kg, "kg"),
                "pose": ((*grid, "joint"), self.poses, "rad or m"),
            },
            {axis: (axis, values, "m") for axis, values in zip(grid, self.axes, strict=True)},
            base=self.base,
            joints=self.joints,
            direction=self.direction,
        )


def workspace_map(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike = (1.0, 0.0, 0.0),
    *,
    axes: tuple[ArrayLike, ArrayLike, ArrayLike],
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
) -> WorkspaceMap:
    """Effective mass along one direction at every place of a grid that the hand gets to without turning.

    Args:
        robot: the robot; a floating base stands at the world's origin.
        pose: shape (len(chain),), the reference pose [rad or m]; the search begins at its place.
        direction: shape (3,), unit vector in world axes.
        axes: x, y and z [m]; give one value to an axis for a slice.
        frame: the hand; the wrist mount if None.
        base: "fixed" or "free"; free where the robot floats if None.
        joints: "free" or "locked".

    Raises:
        InputError: an empty or too fine grid, or none of its places within reach.
    """
    grid = tuple(np.atleast_1d(np.asarray(a, dtype=float)) for a in axes)
    shape = tuple(len(a) for a in grid)
    count = int(np.prod(shape))
    if len(grid) != 3 or not 0 < count <= MOST or not all(np.isfinite(a).all() for a in grid):
        raise InputError("the grid does not fit", given=f"{' x '.join(map(str, shape))} points", valid=f"1 to {MOST}")
    if joints == "servo":
        raise InputError("servo joints have no mass without a frequency", valid="joints free or locked")
    reference = checked_poses(robot, pose)[0]
    aim = hand_aim(robot, reference, direction, frame=frame)
    places = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 3)
    poses = np.full((count, len(reference)), np.nan)
    came_from = np.full(count, -1)
    for begin in np.argsort(np.linalg.norm(places - aim.place, axis=1))[:8]:
        first = aim.solve(places[begin], reference)
        if first is not None:
            break
    else:
        raise InputError("the hand gets to no place of the grid near its own", given=aim.place.round(3).tolist())
    poses[begin] = first
    waiting = deque([int(begin)])
    while waiting:
        index = waiting.popleft()
        for near in _neighbours(index, shape):
            if np.isnan(poses[near, 0]):
                found = aim.solve(places[near], poses[index], reference)
                if found is not None:
                    poses[near], came_from[near] = found, index
                    waiting.append(near)
    masses = np.full(count, np.nan)
    there = ~np.isnan(poses[:, 0])
    regime = regime_of(robot, base, joints)
    # one by one: a place takes some 3 ms to reach and 0.2 ms to weigh, and the batch's kernels 14 s to compile once
    masses[there] = [_mass(robot, pose, regime, frame, aim.in_world) for pose in poses[there]]
    return WorkspaceMap(
        axes=(grid[0], grid[1], grid[2]),
        poses=poses.reshape(*shape, -1),
        effective_mass_kg=masses.reshape(shape),
        direction=aim.in_world,
        came_from=came_from.reshape(shape),
        place=aim.place,
        base=base or ("free" if robot.floating else "fixed"),
        joints=joints,
    )


def _mass(robot: Robot, pose: np.ndarray, regime: Regime, frame: str | None, direction: np.ndarray) -> float:
    return reciprocal(along(by_inverse(terms_of(robot, pose, regime, frame))[:3, :3], direction))


def _neighbours(index: int, shape: tuple[int, ...]) -> list[int]:
    at = np.unravel_index(index, shape)
    found = []
    for axis, size in enumerate(shape):
        for step in (-1, 1):
            if 0 <= at[axis] + step < size:
                moved = list(at)
                moved[axis] += step
                found.append(int(np.ravel_multi_index(moved, shape)))
    return found
