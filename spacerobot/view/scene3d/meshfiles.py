"""Mesh files of URDFs as light solids: read without following any reference, thinned to a budget of triangles."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.view.scene3d.film import Look
from spacerobot.view.scene3d.solids import Array, Solid, flat

MAX_BYTES = 60_000_000
"""Larger files are not read."""

CREASE = np.radians(35.0)
"""Faces that meet at a smaller angle share their normals."""

KINDS = ("stl", "obj", "dae")

_FORBIDDEN = re.compile(rb"<!\s*(doctype|entity)", re.IGNORECASE)


@lru_cache(maxsize=256)
def read_mesh(path: Path, triangles: int) -> tuple[tuple[Solid, Look | None], ...]:
    """Solids of a mesh file, one for each colour; empty if it cannot be read.

    A mesh is decoration: a damaged one must not keep anybody from seeing the robot.

    Args:
        path: STL, OBJ or Collada.
        triangles: that all of the file's solids may have together, roughly.
    """
    kind = path.suffix.lower().lstrip(".")
    if kind not in KINDS or path.stat().st_size > MAX_BYTES:
        return ()
    try:
        return tuple(_solids(_parts(path.read_bytes(), kind), triangles))
    except Exception:  # whatever a reader, or the thinning, makes of a damaged file
        return ()


def _solids(parts: list[tuple[Any, Look | None]], triangles: int) -> Iterator[tuple[Solid, Look | None]]:
    total = sum(len(mesh.faces) for mesh, _ in parts)
    for mesh, look in parts:
        share = triangles * len(mesh.faces) / max(total, 1)
        solid = _solid(mesh, int(max(share, 24)))
        if len(solid.faces) and np.all(np.isfinite(solid.points)):
            yield solid, look


def _parts(data: bytes, kind: str) -> list[tuple[Any, Look | None]]:
    """Meshes and their colours. The reader is given bytes and no folder: materials and textures are not looked for."""
    import trimesh

    if kind == "dae" and (_FORBIDDEN.search(data) or b"\0" in data):  # the reader's parser would follow entities
        return []
    loaded = trimesh.load(io.BytesIO(data), file_type=kind, process=True, skip_materials=kind == "obj")
    if isinstance(loaded, trimesh.Scene):
        parts = []
        for node in loaded.graph.nodes_geometry:
            placement, name = loaded.graph[node]
            mesh = loaded.geometry[name]
            if isinstance(mesh, trimesh.Trimesh):
                colour = _colour(mesh)
                mesh = mesh.copy()
                mesh.apply_transform(placement)
                parts.append((mesh, colour))
        return parts
    return [(loaded, _colour(loaded) if kind == "dae" else None)] if isinstance(loaded, trimesh.Trimesh) else []


def _colour(mesh: Any) -> Look | None:
    try:
        rgba = np.asarray(mesh.visual.material.main_color, dtype=float) / 255.0
    except (AttributeError, TypeError, ValueError):
        return None
    if rgba.shape != (4,) or not np.all(np.isfinite(rgba)):
        return None
    # Fully transparent parts are an exporter's slip, not glass.
    opacity = float(rgba[3]) if rgba[3] > 0.05 else 1.0
    return Look((float(rgba[0]), float(rgba[1]), float(rgba[2])), opacity, metal=0.15, rough=0.5)


def _solid(mesh: Any, triangles: int) -> Solid:
    """A mesh thinned, with creases kept sharp."""
    import trimesh

    # Points are shared whatever their normals and textures: where they are not, thinning tears the surface.
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    whole.merge_vertices(merge_tex=True, merge_norm=True)
    points, faces = np.asarray(whole.vertices, dtype=float), np.asarray(whole.faces, dtype=np.int64)
    if len(faces) > 1.2 * triangles:
        import fast_simplification

        points, faces = fast_simplification.simplify(points, faces, target_count=triangles)
    thin = trimesh.Trimesh(np.asarray(points, dtype=float), np.asarray(faces), process=True)
    thin.update_faces(thin.nondegenerate_faces())
    if not len(thin.faces):
        return flat(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    return _creased(np.asarray(thin.vertices, dtype=float), np.asarray(thin.faces, dtype=np.int64))


def _creased(points: Array, faces: np.ndarray) -> Solid:
    """Normals of each corner: the mean over those faces about its point that meet its own face at less than CREASE."""
    corners = points[faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(area, axis=1, keepdims=True)
    unit = area / np.where(length > 0, length, 1.0)
    # All pairs of corners at the same point, by sorting corners by point and shifting within each run.
    flat_points = faces.ravel()
    order = np.argsort(flat_points, kind="stable")
    sorted_points, owner = flat_points[order], order // 3
    total = area[owner].copy()
    for shift in range(1, min(int(np.bincount(sorted_points).max()), 24)):
        same = sorted_points[shift:] == sorted_points[:-shift]
        first, second = owner[:-shift][same], owner[shift:][same]
        near = np.einsum("ij,ij->i", unit[first], unit[second]) > np.cos(CREASE)
        index = np.flatnonzero(same)[near]
        np.add.at(total, index, area[second[near]])
        np.add.at(total, index + shift, area[first[near]])
    normals = np.empty_like(total)
    normals[order] = total
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(size > 0, size, 1.0)
    return _shared(corners.reshape(-1, 3), normals)


def _shared(points: Array, normals: Array) -> Solid:
    """Corners with the same point and normal stored once."""
    scale = max(float(np.abs(points).max()), 1e-9)
    key = np.round(np.hstack([points / scale * 1e6, normals * 200.0])).astype(np.int64)
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return Solid(points[first], normals[first], index.reshape(-1, 3))
