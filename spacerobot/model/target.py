"""Free-flying targets: a box with solar panels and a point that gets touched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from lxml import etree

from spacerobot.model import shapes
from spacerobot.model.build import build
from spacerobot.model.bus import COLOURS, draw_bus, inertia_matrix, require_number, require_triples
from spacerobot.model.floating import float_root
from spacerobot.model.inertia import inertia_fault
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


@dataclass(frozen=True)
class TargetSpec:
    """A free-flying target body; its body frame is at the centre of mass.

    Attributes:
        mass: [kg].
        size: edges of the body [m].
        inertia: as in `SpacecraftSpec`.
        contact: the point that gets touched, in the body frame [m]; the middle of the +x face if None.
        panels: whether solar panels are drawn.
    """

    mass: float = 9.0
    size: tuple[float, float, float] = (0.30, 0.30, 0.30)
    inertia: tuple[float, ...] | tuple[tuple[float, ...], ...] | None = None
    contact: tuple[float, float, float] | None = None
    panels: bool = True

    def __post_init__(self) -> None:
        require_number(self, "mass")
        require_triples(self, "size", "contact")
        if min(self.size) <= 0:
            raise InputError("target size is not positive", given=self.size, valid="three positive lengths")
        fault = inertia_fault(self.mass, self.inertia_matrix())
        if fault:
            raise InputError(f"target cannot exist: {fault}")

    def inertia_matrix(self) -> np.ndarray:
        """Shape (3, 3), about the centre of mass, body axes [kg m^2]."""
        return inertia_matrix(self.inertia, self.mass, self.size, "target")


def target_element(spec: TargetSpec) -> etree._Element:
    """A target as a floating `<robot>` element with the links `target` and `target_contact`."""
    root = etree.Element("robot", name="target")
    shapes.add_materials(root, COLOURS)
    body = shapes.link("target", mass=spec.mass, inertia=spec.inertia_matrix())
    draw_bus(body, spec.size, panels=spec.panels)
    contact = spec.contact if spec.contact is not None else (spec.size[0] / 2, 0.0, 0.0)
    root.append(body)
    root.append(shapes.link("target_contact"))
    root.append(shapes.joint("target_contact_joint", "fixed", "target", "target_contact", xyz=contact))
    float_root(root)
    return root


def target_body(spec: TargetSpec | None = None) -> Robot:
    """A free-flying target as a floating robot without joints; its tip is the frame `target_contact`."""
    return build(target_element(spec or TargetSpec()), name="target", tip="target_contact", where="target")
