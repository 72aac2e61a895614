"""URDFs through yourdfpy: a second reader for what comes from outside, and the writer for what leaves."""

from __future__ import annotations

import copy
import io
import logging
from pathlib import Path
from typing import Any

from lxml import etree

from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.files import write_text


def read_with_yourdfpy(root: etree._Element, where: str) -> Any:
    """A `yourdfpy.URDF` of an element that `reading.parse` let through; no mesh is looked for or loaded.

    Raises:
        InputError: yourdfpy cannot read it, or finds faults in it.
    """
    import yourdfpy  # takes a second to import: only those who need it pay

    element = copy.deepcopy(root)
    for limit in element.iter("limit"):  # absent means zero, which yourdfpy does not know
        for key in ("lower", "upper"):
            limit.set(key, limit.get(key, "0"))
    logging.getLogger("yourdfpy.urdf").setLevel(logging.ERROR)
    try:
        reader = yourdfpy.URDF.load(
            io.BytesIO(etree.tostring(element, encoding="utf-8")),
            build_scene_graph=False,
            build_collision_scene_graph=False,
            load_meshes=False,
            load_collision_meshes=False,
            filename_handler=yourdfpy.filename_handler_null,
        )
        valid = reader.validate()
    except Exception as error:  # it checks little itself, so that faults surface as errors of any kind
        raise InputError(f"yourdfpy cannot read the URDF ({error or type(error).__name__})", where=where) from None
    if not valid:
        raise InputError(f"yourdfpy finds the URDF invalid ({reader.errors[0]})", where=where)
    return reader


def urdf_text(robot: Robot) -> str:
    """The robot's URDF as yourdfpy writes it, with the transmissions (the rotors) that its writer drops."""
    root = parse(robot.urdf, robot.name)
    written = read_with_yourdfpy(root, robot.name).write_xml().getroot()
    for transmission in root.findall("transmission"):
        written.append(transmission)
    etree.indent(written)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + etree.tostring(written, encoding="unicode") + "\n"


def write_urdf(robot: Robot, path: str | Path) -> Path:
    """Write a robot's URDF, whole or not at all; its base joint, wrist and rotors are part of the file.

    Raises:
        InputError: the robot's URDF cannot be written.
    """
    target = Path(path)
    write_text(target, urdf_text(robot))
    return target
