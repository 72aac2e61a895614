"""A free-flying root, written the way URDF has for it: an empty link and a joint of type `floating`."""

from __future__ import annotations

from lxml import etree

from spacerobot.model.tips import Tree
from spacerobot.support.errors import InputError

ROOT_JOINT = "root_joint"
WORLD = "world"


def float_root(root: etree._Element) -> None:
    """Put the root link of a URDF on a floating joint, in place.

    The joint is called `root_joint`, as Pinocchio's own free-flyer is. A link that is itself called `world`
    becomes `base_world`, for that name means what does not move (MuJoCo insists).

    Raises:
        InputError: the robot floats already, or uses the joint's name.
    """
    tree = Tree(root)
    if any(tree.kind(j) == "floating" for j in tree.joints):
        raise InputError("robot floats already", given=str(root.get("name")))
    if ROOT_JOINT in tree.joints:
        raise InputError("robot has a joint of the name that its floating base needs", given=ROOT_JOINT)
    base = tree.root
    if WORLD in tree.links:
        renamed = next(n for n in ("base_world", *(f"base_world_{i}" for i in range(99))) if n not in tree.links)
        rename_link(root, WORLD, renamed)
        base = renamed if base == WORLD else base
    joint = etree.Element("joint", name=ROOT_JOINT, type="floating")
    etree.SubElement(joint, "parent", link=WORLD)
    etree.SubElement(joint, "child", link=base)
    root.insert(0, joint)
    root.insert(0, etree.Element("link", name=WORLD))


def rename_link(root: etree._Element, old: str, new: str) -> None:
    """Rename a link and every joint's mention of it, in place."""
    for link in root.findall("link"):
        if link.get("name") == old:
            link.set("name", new)
    for joint in root.findall("joint"):
        for end in ("parent", "child"):
            element = joint.find(end)
            if element is not None and element.get("link") == old:
                element.set("link", new)
