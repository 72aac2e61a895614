"""The URDFs that are put together from parts: `python -m spacerobot.model.assemblies` writes them into urdf/.

The arms pa10 and pa10c are written by hand. Everything else there comes from the functions of this layer, so
that other programs can read the assemblies too; a test holds files and functions together.
"""

from __future__ import annotations

import numpy as np
from lxml import etree

from spacerobot.model import shapes
from spacerobot.model.library import load
from spacerobot.model.spacecraft import SpacecraftSpec, float_base, spacecraft_body
from spacerobot.model.target import TargetSpec, target_element
from spacerobot.model.wrist import COLOURS, WristSpec, attach_wrist, wrist_elements
from spacerobot.support import resources
from spacerobot.support.files import write_text

_WRITTEN = "Written by `python -m spacerobot.model.assemblies`; edit the parts, not this file."
_WRIST = (
    "wrist_slider is positive PUSHED IN (toward the arm). Slider mass 0.7 kg and all measures: this "
    "project's WristSpec. No spring, no damper: a scene sets them."
)
_ARM = "The arm's numbers and their sources: see {}.urdf; its inertias are estimates."
_CRAFT = "Spacecraft: a uniform 500 kg box (this project's SpacecraftSpec, no real one); the panels carry no mass."
_TARGET = "Target: a uniform 9 kg box (this project's TargetSpec, no real one); the panels carry no mass."


def assemblies() -> dict[str, str]:
    """File stem -> URDF text of everything in urdf/ that is not written by hand."""
    pa10, pa10c = load("pa10"), load("pa10c")
    wrist = attach_wrist(pa10)
    return {
        "wrist": _text(wrist_alone(), _WRIST),
        "chaser": _text(spacecraft_body(SpacecraftSpec()), _CRAFT),
        "target": _text(target_element(TargetSpec()), _TARGET),
        "pa10_wrist": _text(etree.fromstring(wrist.urdf), _ARM.format("pa10"), _WRIST),
        "pa10c_wrist": _text(etree.fromstring(attach_wrist(pa10c).urdf), _ARM.format("pa10c"), _WRIST),
        "chaser_pa10_wrist": _text(etree.fromstring(float_base(wrist).urdf), _ARM.format("pa10"), _WRIST, _CRAFT),
    }


def wrist_alone() -> etree._Element:
    """The wrist on a stand, as a `<robot>` element."""
    root = etree.Element("robot", name="wrist")
    shapes.add_materials(root, COLOURS)
    root.append(shapes.link("wrist_stand"))
    for element in wrist_elements(WristSpec(), "wrist_stand", np.zeros(3)):
        root.append(element)
    return root


def _text(root: etree._Element, *notes: str) -> str:
    for comment in root.xpath("//comment()"):  # the parts' own comments speak of the parts
        comment.getparent().remove(comment)
    etree.indent(root)
    lines = "\n".join(f"  {note}" for note in (_WRITTEN, *notes))
    body = etree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n<!--\n{lines}\n-->\n{body}\n'


if __name__ == "__main__":
    for stem, urdf in assemblies().items():
        write_text(resources.folder("urdf") / f"{stem}.urdf", urdf)
