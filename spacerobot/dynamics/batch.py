"""Effective mass of many poses in many directions at once."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.kinematic_tree import kinematic_tree
from spacerobot.dynamics.mobility import SINGULAR
from spacerobot.dynamics.mobility_kernel import mass_kernel, mobility_kernel
from spacerobot.dynamics.regime import regime_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief, html_table
from spacerobot.support.tables import data_frame, data_set

if TYPE_CHECKING:
    import pandas
    import xarray


@dataclass(frozen=True, eq=False, repr=False)
class EffectiveMassBatch(Brief):
    """Effective masses of N poses in K directions.

    Attributes:
        effective_mass_kg: shape (N, K); infinite where the frame cannot move along the direction.
        mobility: shape (N, 3, 3), linear mobility G_v [1/kg], world axes.
        directions: shape (K, 3).
    """

    effective_mass_kg: np.ndarray
    mobility: np.ndarray
    directions: np.ndarray

    def to_frame(self) -> pandas.DataFrame:
        """A row for each pose, a column for each direction [kg], as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        names = [f"({', '.join(f'{x:.4g}' for x in n)})" for n in self.directions]
        return data_frame(dict(zip(names, self.effective_mass_kg.T, strict=True)), units=dict.fromkeys(names, "kg"))

    def to_xarray(self) -> xarray.Dataset:
        """Masses over pose and direction, the mobility of each pose, as a data set of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        return data_set(
            {
                "effective_mass": (("pose", "direction"), self.effective_mass_kg, "kg"),
                "mobility": (("pose", "row", "column"), self.mobility, "1/kg"),
            },
            {"along": (("direction", "axis"), self.directions, "1"), "axis": ("axis", list("xyz"), "1")},
        )

    def _repr_html_(self) -> str:
        return html_table(
            f"Effective mass of {len(self.effective_mass_kg)} poses",
            [
                (f"({', '.join(f'{x:.4g}' for x in n)})", float(own.min()), float(np.median(own)), float(own.max()))
                for n, own in zip(self.directions, self.effective_mass_kg.T, strict=True)
            ],
            ("along", "lightest, kg", "median, kg", "heaviest, kg"),
        )


def effective_mass_batch(
    robot: Robot,
    poses: ArrayLike,
    directions: ArrayLike = (1.0, 0.0, 0.0),
    *,
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
    slider: str = "free",
    others: dict[str, float] | None = None,
    threads: int = 1,
) -> EffectiveMassBatch:
    """Effective mass 1/(n^T G_v n) of N poses x K directions, as `effective_mass` has it for one.

    Args:
        robot: the robot; a floating base stands at the world origin.
        poses: shape (N, len(chain)) or (len(chain),), joint positions [rad or m].
        directions: shape (K, 3) or (3,), unit vectors in world axes.
        frame: frame name; the wrist mount if None.
        base: "fixed" or "free"; free where the robot floats if None.
        joints: "free" or "locked".
        slider: "free" or "locked".
        others: positions of joints outside the chain by name, the slider among them.
        threads: how many threads share the poses; results do not depend on it.

    Raises:
        InputError: values out of range, or servo joints (see `apparent_mass_batch`).
        NotFoundError: no such frame or joint.
    """
    n = np.atleast_2d(unit_directions(directions))
    mobility = mobility_batch(
        robot,
        poses,
        frame=frame,
        base=base,
        joints=joints,
        slider=slider,
        others=others,
        threads=threads,
    )
    return EffectiveMassBatch(_masses(mobility, n), mobility, n)


def mobility_batch(
    robot: Robot,
    poses: ArrayLike,
    *,
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
    slider: str = "free",
    others: dict[str, float] | None = None,
    spatial: bool = False,
    threads: int = 1,
) -> np.ndarray:
    """G = J H^-1 J^T of N poses: shape (N, 3, 3), the linear block, or (N, 6, 6) if `spatial`.

    Arguments and errors as for `effective_mass_batch`.
    """
    if joints == "servo":
        raise InputError("servo joints have no mobility without a frequency", valid="joints free or locked")
    if threads < 1:
        raise InputError("threads must be at least 1", given=threads)
    regime = regime_of(robot, base, joints, slider)
    q = checked_poses(robot, poses)
    tree = kinematic_tree(robot, regime, frame, others)
    position = float((others or {}).get(robot.slider, 0.0)) if robot.slider else 0.0
    rows = 6 if spatial else 3
    out = np.empty((len(q), rows, rows))

    def run(part: slice) -> int:
        bad = int(mobility_kernel(tree, q[part], position, rows, out[part]))
        return bad if bad < 0 else bad + part.start

    parts = _parts(len(q), threads)
    if threads == 1:
        failed = [run(part) for part in parts]
    else:
        with ThreadPoolExecutor(threads) as pool:
            failed = list(pool.map(run, parts))
    bad = [index for index in failed if index >= 0]
    if bad:
        raise InputError(
            "the joint-space inertia is not positive definite",
            given=f"pose {bad[0]}: {q[bad[0]].tolist()}",
            valid="a mass and an inertia, or an armature, on every moving link",
        )
    return out


def checked_poses(robot: Robot, poses: ArrayLike) -> np.ndarray:
    """Poses as a contiguous array of shape (N, len(chain)).

    Raises:
        InputError: not numeric, of another shape, or not finite.
    """
    try:
        q = np.atleast_2d(np.asarray(poses, dtype=float))
    except (TypeError, ValueError):
        raise InputError("poses are not numeric", given=type(poses).__name__) from None
    if q.ndim != 2 or q.shape[1] != len(robot.chain):
        raise InputError(
            "poses have the wrong shape",
            given=q.shape,
            valid=f"(N, {len(robot.chain)}): {', '.join(robot.chain)}",
        )
    finite = np.isfinite(q).all(axis=1)
    if not finite.all():
        raise InputError("a pose is not finite", given=f"pose {int(np.argmin(finite))}")
    return np.ascontiguousarray(q)


def _masses(mobility: np.ndarray, directions: np.ndarray) -> np.ndarray:
    masses = np.empty((len(mobility), len(directions)))
    if mass_kernel(mobility, directions, SINGULAR, masses):
        rows, columns = np.nonzero(masses < 0.0)
        g, n = mobility[rows], directions[columns]
        along = np.einsum("si,sij,sj->s", n, g, n)
        moving = along > SINGULAR * np.linalg.eigvalsh(g)[:, -1]
        masses[rows, columns] = np.divide(1.0, along, out=np.full(len(along), np.inf), where=moving)
    return masses


def _parts(count: int, threads: int) -> Iterable[slice]:
    edges = np.linspace(0, count, threads + 1).astype(int)
    return [slice(int(a), int(b)) for a, b in pairwise(edges)]
