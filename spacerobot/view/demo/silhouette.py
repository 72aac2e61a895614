"""A robot seen from the side: the outlines of its URDF's primitive shapes, painted from far to near."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from spacerobot.model.robot import Robot

ROUND = 48
"""Points of a circle."""


def draw(
    axes: Axes,
    robot: Robot,
    configuration: np.ndarray,
    *,
    shift: tuple[float, float] = (0.0, 0.0),
    right: int = 0,
    alpha: float = 1.0,
) -> None:
    """Paint a robot's visual shapes from the side, looking along +y: world x to the right, z up.

    Meshes are left out; ours have none.

    Args:
        axes: where to.
        robot: its URDF's shapes.
        configuration: shape (nq,).
        shift: added to x and z [m].
        right: 1 for y to the right, seen along -x.
        alpha: opacity.
    """
    model = robot.model
    shapes = pin.buildGeomFromUrdfString(model, robot.urdf, pin.GeometryType.VISUAL)
    data, places = model.createData(), shapes.createData()
    pin.updateGeometryPlacements(model, data, shapes, places, configuration)
    found = []
    for shape, place in zip(shapes.geometryObjects, places.oMg, strict=True):
        points = np.array(list(_surface(shape.geometry)))
        if points.size:
            world = points @ place.rotation.T + place.translation
            depth = float(world[:, 1].min()) if right == 0 else -float(world[:, 0].max())
            found.append((depth, world[:, (right, 2)] + shift, shape.meshColor[:3]))
    for rank, (_, flat, colour) in enumerate(sorted(found, key=lambda item: -item[0])):
        outline = flat[_hull(flat)]
        axes.add_patch(
            Polygon(
                outline,
                facecolor=_shade(colour, 1.0),
                edgecolor=_shade(colour, 0.55),
                linewidth=0.7,
                alpha=alpha,
                zorder=3 + 0.01 * rank,
            )
        )


def _surface(geometry: object) -> Iterator[tuple[float, float, float]]:
    """Points whose convex hull is the shape, in its own axes [m]."""
    kind = type(geometry).__name__
    angles = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
    if kind == "Box":
        half = geometry.halfSide  # type: ignore[attr-defined]
        yield from ((x * half[0], y * half[1], z * half[2]) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))
    elif kind == "Cylinder":
        radius, half_length = geometry.radius, geometry.halfLength  # type: ignore[attr-defined]
        for z in (-half_length, half_length):
            yield from ((radius * np.cos(a), radius * np.sin(a), z) for a in angles)
    elif kind == "Sphere":
        radius = geometry.radius  # type: ignore[attr-defined]
        for tilt in np.linspace(-0.5 * np.pi, 0.5 * np.pi, ROUND // 2):
            for a in angles:
                yield radius * np.cos(tilt) * np.cos(a), radius * np.cos(tilt) * np.sin(a), radius * np.sin(tilt)


def _hull(points: np.ndarray) -> np.ndarray:
    """Indices of the convex hull of points, shape (P, 2), counter-clockwise (Andrew's monotone chain)."""
    order = np.lexsort((points[:, 1], points[:, 0]))

    def half(indices: np.ndarray) -> list[int]:
        chain: list[int] = []
        for i in indices:
            while len(chain) > 1:
                (ax, ay), (bx, by) = points[chain[-1]] - points[chain[-2]], points[i] - points[chain[-2]]
                if ax * by - ay * bx > 1e-15:
                    break
                chain.pop()
            chain.append(int(i))
        return chain[:-1]

    return np.array(half(order) + half(order[::-1]))


def _shade(colour: np.ndarray, light: float) -> tuple[float, float, float]:
    r, g, b = light * np.clip(np.asarray(colour, dtype=float), 0.0, 1.0)
    return float(r), float(g), float(b)
