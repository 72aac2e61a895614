"""Solids as triangles with normals: bevelled boxes and cylinders, spheres, capsules, coils. Lengths in metres.

Edges are bevelled, because an edge that catches the light is what makes a drawn part look made.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solid:
    """Triangles.

    Attributes:
        points: (N, 3), one for each corner that has a normal of its own [m].
        normals: (N, 3), unit vectors, outwards.
        faces: (M, 3), indices into `points`, anticlockwise from outside.
    """

    points: Array
    normals: Array
    faces: NDArray[np.int64]

    def moved(self, placement: Array) -> Solid:
        """The solid under a rigid or mirroring placement, shape (4, 4)."""
        turn = placement[:3, :3]
        faces = self.faces if np.linalg.det(turn) > 0 else self.faces[:, ::-1]
        normals = self.normals @ np.linalg.inv(turn)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        return Solid(self.points @ turn.T + placement[:3, 3], normals / np.where(length > 0, length, 1.0), faces)


def merged(solids: list[Solid]) -> Solid:
    """Several solids as one."""
    offsets = np.cumsum([0, *(len(s.points) for s in solids[:-1])])
    return Solid(
        np.concatenate([s.points for s in solids]),
        np.concatenate([s.normals for s in solids]),
        np.concatenate([s.faces + o for s, o in zip(solids, offsets, strict=True)]),
    )


def flat(points: Array, faces: NDArray[np.int64]) -> Solid:
    """Faces with sharp edges between them."""
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(length > 0, length, 1.0)
    return Solid(corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), np.arange(3 * len(faces)).reshape(-1, 3))


def box(size: tuple[float, float, float], bevel: float = 0.03) -> Solid:
    """A box with edges `size`, centred; the bevel is a share of the shortest edge, 10 mm at most."""
    from scipy.spatial import ConvexHull

    half = np.array(size, dtype=float) / 2.0
    cut = min(bevel * float(min(size)), 0.01)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    points = np.concatenate([signs * (half - cut * (1.0 - np.eye(3)[axis])) for axis in range(3)])
    faces = ConvexHull(points).simplices.astype(np.int64)
    corners = points[faces]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", outward, corners.mean(axis=1)) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return flat(points, faces)


def revolved(profile: list[tuple[float, float]], segments: int = 40) -> Solid:
    """A profile of (radius, height) from bottom to top turned about z; round about z, sharp between its pieces."""
    angle = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    pieces = []
    for (r0, z0), (r1, z1) in itertools.pairwise(profile):
        length = math.hypot(r1 - r0, z1 - z0)
        if length == 0.0:
            continue
        out, up = (z1 - z0) / length, -(r1 - r0) / length
        rows = [np.column_stack([r * around, np.full(segments + 1, z)]) for r, z in ((r0, z0), (r1, z1))]
        normal = np.column_stack([out * around, np.full(segments + 1, up)])
        lower, upper = np.arange(segments), np.arange(segments) + segments + 1
        first = np.column_stack([lower, lower + 1, upper + 1])
        second = np.column_stack([lower, upper + 1, upper])
        kept = [f for f, r in ((first, r0), (second, r1)) if r > 0.0]
        pieces.append(Solid(np.concatenate(rows), np.concatenate([normal, normal]), np.concatenate(kept)))
    return merged(pieces)


def cylinder(radius: float, length: float, segments: int = 40) -> Solid:
    """A bevelled cylinder along z, centred."""
    cut = min(0.08 * min(radius, length), 0.004)
    half = length / 2.0
    return revolved(
        [
            (0.0, -half),
            (radius - cut, -half),
            (radius, cut - half),
            (radius, half - cut),
            (radius - cut, half),
            (0.0, half),
        ],
        segments,
    )


def sphere(radius: float, rings: int = 20, segments: int = 36) -> Solid:
    """A sphere, smooth."""
    return ellipsoidal(radius, 0.0, rings, segments)


def capsule(radius: float, length: float, rings: int = 16, segments: int = 28) -> Solid:
    """A cylinder of `length` along z between two half spheres, centred."""
    return ellipsoidal(radius, length, rings, segments)


def ellipsoidal(radius: float, stretch: float, rings: int, segments: int) -> Solid:
    """A sphere whose halves are `stretch` apart along z."""
    polar = np.linspace(0.0, np.pi, rings + 1)
    if stretch > 0.0:
        polar = np.sort(np.append(polar[np.abs(polar - np.pi / 2) > 1e-6], [np.pi / 2 - 1e-9, np.pi / 2 + 1e-9]))
    azimuth = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    p, a = np.meshgrid(polar, azimuth, indexing="ij")
    normals = np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=-1).reshape(-1, 3)
    points = radius * normals
    points[:, 2] += np.where(normals[:, 2] > 0.0, 0.5, -0.5) * stretch
    return Solid(points, normals, grid_faces(len(polar) - 1, segments))


def grid_faces(rings: int, segments: int) -> NDArray[np.int64]:
    """Triangles of a grid of (rings + 1) x (segments + 1) points, rows from the top."""
    row, column = np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij")
    a = (row * (segments + 1) + column).ravel()
    b, c, d = a + 1, a + segments + 1, a + segments + 2
    return np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])


def coil(radius: float, wire: float, turns: int, length: float, segments: int = 22, sides: int = 8) -> Solid:
    """A helical spring about z from 0 to 1, so that scaling z sets its length.

    Args:
        radius: of the helix [m].
        wire: radius of the wire [m].
        turns: whole turns.
        length: to which it will be scaled for its wire to be round [m].
        segments: along one turn.
        sides: around the wire.
    """
    count = turns * segments
    turn = np.linspace(0.0, 2.0 * np.pi * turns, count + 1)
    side = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    t, s = np.meshgrid(turn, side, indexing="ij")
    outward = np.stack([np.cos(t), np.sin(t), np.zeros_like(t)], axis=-1)
    normals = np.cos(s)[..., None] * outward + np.sin(s)[..., None] * np.array([0.0, 0.0, 1.0])
    centre = radius * outward
    centre[..., 2] = t / (2.0 * np.pi * turns)
    points = centre + wire * np.cos(s)[..., None] * outward
    points[..., 2] += wire / length * np.sin(s)
    return Solid(points.reshape(-1, 3), normals.reshape(-1, 3), grid_faces(count, sides))
