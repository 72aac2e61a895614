"""From URDF text to a Robot: the one place where Pinocchio models are made."""

from __future__ import annotations

import copy
from pathlib import Path

import pinocchio as pin
from lxml import etree

from spacerobot.model.armature import armature_vector, read_armature
from spacerobot.model.inertia import require_possible
from spacerobot.model.mending import mend
from spacerobot.model.meshes import check_meshes
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.model.tips import Tree, find_tip
from spacerobot.model.validate import validate
from spacerobot.support.errors import InputError, NotFoundError

SLIDER, MOUNT, CONTACT = "wrist_slider", "wrist_mount", "wrist_tip"
"""Names by which a wrist is known in a URDF: its joint, its mounting frame, the frame that touches."""


def build(
    urdf: str | bytes | etree._Element,
    *,
    name: str | None = None,
    tip: str | None = None,
    mesh_dirs: tuple[Path, ...] = (),
    armature: bool = True,
    where: str = "URDF text",
    mends: bool = False,
) -> Robot:
    """Check a URDF and build its model.

    Args:
        urdf: URDF text, or its parsed `<robot>` element.
        name: what to call the robot; the URDF's own name if None.
        tip: frame at the end of the arm; found by `tips.find_tip` if None. A wrist in the URDF (joint
            `wrist_slider`) sets it to `wrist_mount`.
        mesh_dirs: folders that mesh files must stay in.
        armature: whether rotor inertia counts.
        where: what to call the URDF in errors.
        mends: whether an impossible inertia is moved to the nearest possible.

    Raises:
        InputError: the URDF is malformed or describes a body that cannot exist.
        NotFoundError: `tip` is no frame of it.
    """
    root = urdf if isinstance(urdf, etree._Element) else parse(urdf, where)
    validate(root, where)
    check_meshes(root, mesh_dirs, where)
    reflected = read_armature(root, where)
    tree = Tree(root)
    model = _model(root, where)
    mended = mend(root, model) if mends else ()
    if mended:
        model = _model(root, where)
    text = etree.tostring(root, encoding="unicode")
    require_possible(model, where)
    if armature:
        model.armature = armature_vector(model, reflected)
    wrist = _has_wrist(tree, where)
    frame = tip or (MOUNT if wrist else find_tip(tree))
    link = tree.link_of(frame)
    if link is None:
        raise NotFoundError("frame", frame, [*tree.links, *tree.joints], where=where)
    return Robot(
        name=name or str(root.get("name") or "robot"),
        urdf=text,
        model=model,
        chain=tuple(j for j in tree.chain(link) if j != SLIDER),
        tip=frame,
        slider=SLIDER if wrist else None,
        contact=CONTACT if wrist else None,
        floating=model.njoints > 1 and model.joints[1].shortname() == "JointModelFreeFlyer",
        mesh_dirs=mesh_dirs,
        armature=armature,
        mended=mended,
    )


def _model(root: etree._Element, where: str) -> pin.Model:
    try:
        return pin.buildModelFromXML(_mechanism(root))
    except (ValueError, RuntimeError, IndexError) as error:
        reason = " ".join(str(error).split()) or "no reason given"
        raise InputError(f"Pinocchio cannot read the URDF ({reason})", where=where) from None


def rebuild(robot: Robot, root: etree._Element, *, name: str | None = None, tip: str | None = None) -> Robot:
    """A robot from the edited URDF of another; everything else is kept."""
    return build(
        root,
        name=name or robot.name,
        tip=tip,
        mesh_dirs=robot.mesh_dirs,
        armature=robot.armature,
        where=name or robot.name,
    )


def _mechanism(root: etree._Element) -> str:
    """The URDF without what a model does not need: shapes, transmissions and other programs' extensions."""
    bare = etree.Element("robot", name=str(root.get("name") or "robot"))
    for part in root.iterchildren("link", "joint"):
        kept = ("inertial",) if part.tag == "link" else ("parent", "child", "origin", "axis", "limit", "dynamics")
        element = etree.SubElement(bare, part.tag, dict(part.attrib))
        element.extend(copy.deepcopy(child) for child in part.iterchildren(*kept))
    return etree.tostring(bare, encoding="unicode")


def _has_wrist(tree: Tree, where: str) -> bool:
    if SLIDER not in tree.joints:
        return False
    for frame in (MOUNT, CONTACT):
        if frame not in tree.links:
            raise NotFoundError("link of the wrist", frame, tree.links, where=where)
    if tree.kind(SLIDER) != "prismatic":
        raise InputError(f"joint {SLIDER!r} is not prismatic", given=tree.kind(SLIDER), where=where)
    return True
