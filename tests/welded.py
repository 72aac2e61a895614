"""A robot's text with a load on one of its links."""

from __future__ import annotations

from lxml import etree

_SIX = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def heavier(urdf: str, link: str, mass: float, place: tuple[float, float, float]) -> str:
    """A robot's text with a small sphere welded to a link."""
    root = etree.fromstring(urdf.encode())
    body = etree.SubElement(root, "link", name="load")
    joint = etree.SubElement(root, "joint", name="weld", type="fixed")
    inertial = etree.SubElement(body, "inertial")
    etree.SubElement(inertial, "mass", value=repr(mass))
    etree.SubElement(inertial, "inertia", {k: ("1e-12" if k[1] == k[2] else "0") for k in _SIX})
    etree.SubElement(joint, "parent", link=link)
    etree.SubElement(joint, "child", link="load")
    etree.SubElement(joint, "origin", xyz=" ".join(map(repr, place)))
    return etree.tostring(root).decode()
