"""Where a camera must look, and how large a drawn quantity should be."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from spacerobot.view.scene3d.film import Array, Body, View


def bounds(bodies: Iterable[Body], *, at_most: int = 12) -> tuple[Array, Array]:
    """Lowest and highest corner of all bodies over the film, (3,) each; a metre about the origin for none."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for body in bodies:
        solids = [p.solid.points for p in body.pieces if p.solid is not None and len(p.solid.points)]
        if not solids:
            continue
        points = np.concatenate(solids)
        box = np.array([points.min(axis=0), points.max(axis=0)])
        corners = np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]])
        if body.stretch is not None:
            corners[:, 2] *= float(body.stretch.max())
        chosen = np.unique(np.linspace(0, len(body.poses) - 1, at_most).astype(int))
        for pose in body.poses[chosen]:
            world = corners @ rotation(pose[3:]).T + pose[:3]
            low, high = np.minimum(low, world.min(axis=0)), np.maximum(high, world.max(axis=0))
    if not np.all(np.isfinite(low)):
        return np.full(3, -0.5), np.full(3, 0.5)
    return low, high


def view_of(bodies: Iterable[Body]) -> tuple[Array, float, float]:
    """Focus (3,), reach and floor height of a camera that sees all bodies."""
    low, high = bounds(bodies)
    return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)), float(low[2])


def views_of(focus: Array, reach: float) -> tuple[View, ...]:
    """The usual views of everything."""
    directions = {"Whole": (1.1, -1.7, 0.75), "Side": (0.02, -1.0, 0.12), "Top": (0.001, -0.02, 1.0)}
    return tuple(View(name, focus, reach, direction) for name, direction in directions.items())


def rotation(quaternion: Array) -> Array:
    """Rotation matrix of (x, y, z, w), shape (3, 3)."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


SEEN = 0.05
"""A difference is drawn about this large [m] where it would be hard to see otherwise."""


LEVER = 0.2
"""A turn is seen at about this distance from the centre of mass [m]."""


def gains_for(bodies: Iterable[Body]) -> tuple[float, ...]:
    """Factors for drawing ghosts apart from the simulation: one that makes the largest difference well seen, then 1."""
    apart = 0.0
    for body in bodies:
        if body.beside is not None:
            moved = np.linalg.norm(body.poses[:, :3] - body.beside[:, :3], axis=1)
            cosine = np.abs(np.einsum("ti,ti->t", body.poses[:, 3:], body.beside[:, 3:]))
            turned = 2.0 * np.arccos(np.clip(cosine, 0.0, 1.0))
            apart = max(apart, float((moved + LEVER * turned).max()))
    if apart <= 0.0 or apart > 0.5 * SEEN:
        return (1.0,)
    gain = max(g for g in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0) if g == 1.0 or g * apart <= 1.2 * SEEN)
    return (gain, 1.0) if gain > 1.0 else (1.0,)


def round_scale(largest: float, length: float) -> float:
    """Length for one unit, such that `largest` is about `length` [m] and ten centimetres a round number of units."""
    if not (largest > 0.0 and math.isfinite(largest)):
        return 1.0
    units = 0.1 * largest / length  # for ten centimetres
    power = 10.0 ** math.floor(math.log10(units))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= 0.999 * units)
    return 0.1 / step
