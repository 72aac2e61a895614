"""A mesh that a URDF names: drawn, or left out where it is damaged."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from spacerobot.view.scene3d.meshfiles import read_mesh

_KINDS = ("stl", "obj", "dae")


def _prepare(folder: Path) -> Callable[[bytes], None]:
    def read(data: bytes) -> None:
        file = folder / f"part.{_KINDS[(data[0] if data else 0) % 3]}"
        file.write_bytes(data[1:])
        read_mesh.cache_clear()
        read_mesh(file, 100)

    return read


_CORNERS = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
_BINARY = b"\0" * 80 + struct.pack("<I", 2) + 2 * (struct.pack("<12f", *_CORNERS) + b"\0\0")
_TEXT = b"""solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid a
"""
_OBJ = b"mtllib ../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2/1/1 3/1/1\nf 1 2 3\n"
_DAE = b"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries>
<geometry id="g">
<mesh>
<source id="p">
<float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common>
<accessor source="#a" count="3" stride="3">
<param name="X" type="float"/>
<param name="Y" type="float"/>
<param name="Z" type="float"/>
</accessor>
</technique_common>
</source>
<vertices id="v">
<input semantic="POSITION" source="#p"/>
</vertices>
<triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2</p>
</triangles>
</mesh>
</geometry>
</library_geometries>
<library_visual_scenes>
<visual_scene id="s">
<node>
<instance_geometry url="#g"/>
</node>
</visual_scene>
</library_visual_scenes>
<scene>
<instance_visual_scene url="#s"/>
</scene></COLLADA>"""

TARGET = Target(
    "mesh",
    _prepare,
    (b"\0" + _BINARY, b"\0" + _TEXT, b"\1" + _OBJ, b"\2" + _DAE),
    ("vertex", "facet", "solid", "f ", "v ", "mtllib", "usemtl", "1e999", "nan", "-1", "\xff\xff\xff\xff",
    "<!DOCTYPE", "<!ENTITY",
     "SYSTEM", "file:///etc/passwd", "&x;", "count=", "stride=", "offset=", "<polylist", "<vcount>",
     "init_from", "image"),
    cases=20_000,
)  # fmt: skip
