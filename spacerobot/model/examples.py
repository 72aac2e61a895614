"""The robots of example-robot-data, found through the table of its loaders but read like any other URDF."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from spacerobot.support.errors import InputError

NOTES = {"ur3": "the loaders' table gives the UR5 under this name"}


@dataclass(frozen=True)
class Example:
    """Where one example robot lies.

    Attributes:
        name: its name in the loaders' table.
        urdf: its URDF file.
        mesh_dir: folder that its `package://` paths start from.
        floating: whether its loader puts it on a free-flyer.
        rotors: SRDF file with rotor inertias, or None.
    """

    name: str
    urdf: Path
    mesh_dir: Path
    floating: bool
    rotors: Path | None


@cache
def _table() -> dict[str, Any]:
    from example_robot_data.robots_loader import ROBOTS

    return dict(ROBOTS)


def names() -> list[str]:
    """Names in the loaders' table."""
    return sorted(_table())


def find(name: str) -> Example:
    """Where an example robot lies.

    Raises:
        InputError: the loaders build it from something other than one URDF.
    """
    from example_robot_data.robots_loader import getModelPath

    loader = _table()[name]
    if not loader.urdf_filename:
        raise InputError(f"example robot {name!r} is an SDF with closed loops", valid="a URDF, which is a tree")
    if name == "talos_legs":
        raise InputError(f"example robot {name!r} has no URDF: its loader cuts it from another", valid="talos")
    base = Path(getModelPath(loader.path))
    folder = base / loader.path
    rotors = folder / loader.srdf_subpath / loader.srdf_filename if loader.has_rotor_parameters else None
    return Example(
        name=name,
        urdf=folder / loader.urdf_subpath / loader.urdf_filename,
        mesh_dir=(base / ".." / "..").resolve(),
        floating=bool(loader.free_flyer),
        rotors=rotors,
    )


def rotors(example: Example, urdf: str) -> dict[str, tuple[float, float]]:
    """Rotor inertia [kg m^2] and gear ratio by joint from the example's SRDF; empty if it has none."""
    if example.rotors is None:
        return {}
    model = pin.buildModelFromXML(urdf)
    pin.loadRotorParameters(model, str(example.rotors), False)
    found = {}
    for index in range(1, model.njoints):
        joint = model.joints[index]
        if joint.nv == 1:
            inertia, ratio = (float(np.ravel(v)[joint.idx_v]) for v in (model.rotorInertia, model.rotorGearRatio))
            if inertia > 0:
                found[model.names[index]] = (inertia, ratio)
    return found
