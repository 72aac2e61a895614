"""A film as messages of the meshcat protocol: msgpack of {"type": "set_object", "path": ..., "object": three.js JSON}.

They are what a meshcat viewer understands; no meshcat server takes part, for that one listens on every interface.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import umsgpack

from spacerobot.view.scene3d.film import Body, Film, Look, Piece

_EXTENSIONS = {"int16": 0x13, "uint16": 0x14, "uint32": 0x16, "float32": 0x17}
_NAMES = {"int16": "Int16Array", "uint16": "Uint16Array", "uint32": "Uint32Array", "float32": "Float32Array"}


def messages(film: Film) -> list[bytes]:
    """What a fresh viewer is to be told, in order: the defaults go, the film's bodies come."""
    counter = itertools.count()
    found: list[dict[str, Any]] = [{"type": "delete", "path": path} for path in ("/Lights", "/Grid", "/Axes")]
    for body in film.bodies:
        found.append({"type": "set_object", "path": path_of(body), "object": _object(body, counter)})
    return [umsgpack.packb(message) for message in found]


def path_of(body: Body) -> str:
    """Where a body hangs in the viewer's tree."""
    return "/film/" + "/".join(
        "".join(c if c.isalnum() or c in "._-" else "_" for c in p) for p in body.name.split("/")
    )


def _object(body: Body, counter: Iterator[int]) -> dict[str, Any]:
    geometries, materials, children = [], [], []
    for piece in body.pieces:
        geometry, material, node = (f"{kind}{next(counter)}" for kind in ("g", "m", "o"))
        geometries.append({"uuid": geometry, **_geometry(piece)})
        materials.append({"uuid": material, **_material(piece, body.kind == "ghost")})
        solid = piece.solid is not None
        children.append(
            {
                "uuid": node,
                "type": "Mesh" if solid else "LineSegments",
                "geometry": geometry,
                "material": material,
                "castShadow": solid and piece.look.opacity == 1.0 and body.kind != "ghost",
                "receiveShadow": solid and body.kind != "ghost",
            }
        )
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": geometries,
        "materials": materials,
        "object": {"uuid": f"b{next(counter)}", "type": "Group", "children": children},
    }


def _geometry(piece: Piece) -> dict[str, Any]:
    if piece.solid is None:
        points = np.zeros((0, 3)) if piece.lines is None else piece.lines.reshape(-1, 3)
        return {"type": "BufferGeometry", "data": {"attributes": {"position": _attribute(points.astype(np.float32))}}}
    solid = piece.solid
    small = len(solid.points) < 65536
    faces = solid.faces.astype(np.uint16 if small else np.uint32)
    normals = np.round(solid.normals * 32767.0).astype(np.int16)
    return {
        "type": "BufferGeometry",
        "data": {
            "index": _typed(faces),
            "attributes": {
                "position": _attribute(solid.points.astype(np.float32)),
                "normal": {**_attribute(normals), "normalized": True},
            },
        },
    }


def _typed(array: np.ndarray) -> dict[str, Any]:
    name = str(array.dtype)
    data = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes()
    return {"type": _NAMES[name], "array": umsgpack.Ext(_EXTENSIONS[name], data)}


def _attribute(array: np.ndarray) -> dict[str, Any]:
    return {"itemSize": 3, **_typed(array)}


def _material(piece: Piece, ghost: bool) -> dict[str, Any]:
    look = piece.look
    common: dict[str, Any] = {"color": _linear(look)}
    if look.opacity < 1.0:
        common.update(transparent=True, opacity=look.opacity, depthWrite=False)
    if piece.solid is None:
        return {"type": "LineBasicMaterial", **common}
    return {
        "type": "MeshStandardMaterial",
        "metalness": look.metal,
        "roughness": look.rough,
        "emissive": _linear(look, look.glow),
        "polygonOffset": ghost,  # a ghost lies where the thing itself lies
        "polygonOffsetFactor": -2,
        "polygonOffsetUnits": -2,
        "side": 2 if look.opacity < 1.0 else 0,
        **common,
    }


def _linear(look: Look, share: float = 1.0) -> int:
    """The colour as three.js wants it for a renderer that encodes its output: linear light, 0xRRGGBB."""
    c = np.asarray(look.colour, dtype=float)
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) * share
    red, green, blue = (int(v) for v in np.round(255.0 * np.clip(light, 0.0, 1.0)))
    return red << 16 | green << 8 | blue
