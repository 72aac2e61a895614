"""A sweep as its file describes it: a scene, its poses, a grid, scatter and repeats; checked when it is made."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError
from spacerobot.sweep.keys import value_of, with_values
from spacerobot.sweep.scatter import Scatter, uniforms

MOST = 10**12
"""Collisions in a sweep."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A sweep.

    Collisions are numbered with the pose slowest, then the grid in the order of the file, the repeat fastest.

    Attributes:
        scene: what every collision has in common.
        poses: joint positions [rad or m], one after the other.
        grid: key -> its values.
        scatter: key -> how it varies about its value.
        repeats: collisions of each combination.
        seed: of the scatter.
        rows: collisions in a part.
        title: one line.
    """

    scene: Scene
    poses: tuple[tuple[float, ...], ...]
    grid: Mapping[str, tuple[float, ...]]
    scatter: Mapping[str, Scatter]
    repeats: int = 1
    seed: int = 0
    rows: int = 100_000
    title: str = ""

    def __post_init__(self) -> None:
        if self.total > MOST:
            raise InputError("too many collisions for one sweep", given=self.total, valid=f"at most {MOST:.0e}")
        for key in self.scatter:
            if key not in self.grid and value_of(self.scene, key) is None:
                raise InputError("scatter about a number that is not set", given=key, where=f"scatter.{key}")
        self._require_extremes()

    @property
    def shape(self) -> tuple[int, ...]:
        """Poses, values of each key of the grid, repeats."""
        return (len(self.poses), *(len(v) for v in self.grid.values()), self.repeats)

    @property
    def total(self) -> int:
        """Collisions."""
        return math.prod(self.shape)

    @property
    def parts(self) -> int:
        """Files."""
        return -(-self.total // self.rows)

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies, besides the pose: the grid, then what has scatter alone."""
        return (*self.grid, *(k for k in self.scatter if k not in self.grid))

    @cached_property
    def centre(self) -> dict[str, float]:
        """A value of every key in the middle of its range."""
        found = {}
        for key in self.keys:
            own = value_of(self.scene, key)
            found[key] = self.grid[key][len(self.grid[key]) // 2] if key in self.grid else float(own or 0.0)
        return found

    def range_of(self, part: int) -> tuple[int, int]:
        """First collision of a part, and the first after it."""
        return part * self.rows, min((part + 1) * self.rows, self.total)

    def columns(self, first: int, last: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Number of the pose and value of every key, shape (last - first,) each."""
        index = np.unravel_index(np.arange(first, last), self.shape)
        drawn = uniforms(self.seed, first, last, len(self.scatter))
        values: dict[str, np.ndarray] = {}
        for key in self.keys:
            if key in self.grid:
                place = 1 + list(self.grid).index(key)
                values[key] = np.array(self.grid[key], dtype=float)[index[place]]
            else:
                values[key] = np.full(last - first, self.centre[key])
            if key in self.scatter:
                values[key] = self.scatter[key].spread(values[key], drawn[:, list(self.scatter).index(key)])
        return index[0].astype(np.int32), values

    def _require_extremes(self) -> None:
        """Whatever the grid and the draws can reach must make a scene; tried at their ends, one key at a time."""
        for key in self.keys:
            values = self.grid.get(key, (self.centre[key],))
            spread = self.scatter.get(key)
            ends = {min(values), max(values)}
            if spread is not None:
                for value, way in itertools.product(tuple(ends), (-1.0, 1.0)):
                    reach = way * spread.reach * spread.amount
                    ends.add(value + reach if spread.absolute else value * (1.0 + reach))
            for value in sorted(ends):
                try:
                    with_values(self.scene, {**self.centre, key: value})
                except InputError as error:
                    raise InputError(
                        f"the sweep reaches {key} = {value:.6g}, which makes no scene ({error.what})",
                        given=error.given,
                        valid=error.valid,
                        where=f"{'scatter' if key in self.scatter else 'grid'}.{key}",
                    ) from None
