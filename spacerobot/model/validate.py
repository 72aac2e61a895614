"""What a URDF must be before a model is built from it; each fault is one error with name and line."""

from __future__ import annotations

from collections.abc import Iterable

from lxml import etree

from spacerobot.model.reading import at, number, numbers
from spacerobot.support.errors import InputError, NotFoundError

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
MAX_LINKS = 1000

_SIZES = {"box": ("size", 3), "cylinder": ("radius length", 1), "sphere": ("radius", 1)}


def validate(root: etree._Element, where: str) -> None:
    """Check names, numbers and the tree.

    Raises:
        InputError: the first fault found.
    """
    links, joints = root.findall("link"), root.findall("joint")
    if not links:
        raise InputError("robot has no link", where=at(where, root))
    if len(links) > MAX_LINKS:
        raise InputError("robot has too many links", given=len(links), valid=f"at most {MAX_LINKS}", where=where)
    link_names = _unique(links, "link", where)
    joint_names = _unique(joints, "joint", where)
    for link in links:
        _link(link, where)
    for joint in joints:
        _joint(joint, link_names, joint_names, where)
    _tree(links, joints, where)


def _unique(elements: Iterable[etree._Element], kind: str, where: str) -> set[str]:
    names: set[str] = set()
    for element in elements:
        name = element.get("name")
        if not name or not name.strip():
            raise InputError(f"{kind} has no name", where=at(where, element))
        if not name.isprintable():
            raise InputError(f"name of a {kind} has unprintable characters", given=name, where=at(where, element))
        if name in names:
            raise InputError(f"two {kind}s have the same name", given=name, where=at(where, element))
        names.add(name)
    return names


def _origin(element: etree._Element, owner: str, where: str) -> None:
    for origin in element.findall("origin"):
        for key in ("xyz", "rpy"):
            if origin.get(key) is not None:
                numbers(origin.get(key, ""), 3, f"origin {key} of {owner}", at(where, origin))


def _link(link: etree._Element, where: str) -> None:
    owner = f"link {link.get('name')!r}"
    inertials = link.findall("inertial")
    if len(inertials) > 1:
        raise InputError(f"{owner} has two inertials", where=at(where, inertials[1]))
    for inertial in inertials:
        _origin(inertial, owner, where)
        mass = inertial.find("mass")
        if mass is None:
            raise InputError(f"mass of {owner} is missing", where=at(where, inertial))
        if number(mass.get("value"), f"mass of {owner}", at(where, mass)) < 0:
            raise InputError(f"mass of {owner} is negative", given=mass.get("value"), where=at(where, mass))
        inertia = inertial.find("inertia")
        if inertia is None:
            raise InputError(f"inertia of {owner} is missing", where=at(where, inertial))
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
            number(inertia.get(key), f"{key} of {owner}", at(where, inertia))
    for shape in [*link.findall("visual"), *link.findall("collision")]:
        _origin(shape, owner, where)
        geometry = shape.find("geometry")
        if geometry is None:
            raise InputError(f"{shape.tag} of {owner} has no geometry", where=at(where, shape))
        shapes = list(geometry.iterchildren("*"))
        if len(shapes) != 1:
            raise InputError(f"geometry of {owner} is not one shape", given=len(shapes), where=at(where, geometry))
        _shape(shapes[0], owner, where)


def _shape(element: etree._Element, owner: str, where: str) -> None:
    what, spot = f"{element.tag} of {owner}", at(where, element)
    if element.tag == "mesh":
        if not element.get("filename"):
            raise InputError(f"{what} has no file name", where=spot)
        if element.get("scale") is not None and len(element.get("scale", "").split()) != 1:
            numbers(element.get("scale", ""), 3, f"scale of {what}", spot)
        return
    if element.tag not in _SIZES:
        valid = ", ".join((*_SIZES, "mesh"))
        raise InputError(f"{owner} has an unknown shape", given=element.tag, valid=valid, where=spot)
    keys, count = _SIZES[element.tag]
    for key in keys.split():
        for value in numbers(element.get(key) or "", count, f"{key} of {what}", spot):
            if value < 0:
                raise InputError(f"{key} of {what} is negative", given=value, where=spot)


def _joint(joint: etree._Element, links: set[str], joints: set[str], where: str) -> None:
    owner, spot = f"joint {joint.get('name')!r}", at(where, joint)
    kind = joint.get("type")
    if kind not in JOINT_TYPES:
        raise InputError(f"{owner} has an unknown type", given=str(kind), valid=", ".join(JOINT_TYPES), where=spot)
    for end in ("parent", "child"):
        element = joint.find(end)
        name = None if element is None else element.get("link")
        if not name:
            raise InputError(f"{owner} has no {end} link", where=spot)
        if name not in links:
            raise NotFoundError(f"{end} link of {owner}", name, sorted(links), where=at(where, element))
    _origin(joint, owner, where)
    axis = joint.find("axis")
    if axis is not None and kind not in ("fixed", "floating"):
        xyz = numbers(axis.get("xyz") or "", 3, f"axis of {owner}", at(where, axis))
        if not any(abs(a) > 1e-9 for a in xyz):
            raise InputError(f"axis of {owner} is zero", given=axis.get("xyz"), where=at(where, axis))
    _limit(joint, owner, kind, where)
    for element in joint.findall("dynamics"):
        if element.get("damping") is None and element.get("friction") is None:
            raise InputError(f"dynamics of {owner} has neither damping nor friction", where=at(where, element))
        for key in ("damping", "friction"):
            if element.get(key) is not None and number(element.get(key), f"{key} of {owner}", at(where, element)) < 0:
                raise InputError(f"{key} of {owner} is negative", given=element.get(key), where=at(where, element))


def _limit(joint: etree._Element, owner: str, kind: str, where: str) -> None:
    limit = joint.find("limit")
    if limit is None:
        if kind in ("revolute", "prismatic"):
            raise InputError(f"{owner} is {kind} and has no limit", where=at(where, joint))
        return
    spot = at(where, limit)
    for key in ("effort", "velocity"):
        if kind == "fixed" and limit.get(key) is None:
            continue
        if _bound(limit.get(key), f"{key} limit of {owner}", spot) < 0:
            raise InputError(f"{key} limit of {owner} is negative", given=limit.get(key), where=spot)
    if kind in ("revolute", "prismatic"):
        lower, upper = (_bound(limit.get(key, "0"), f"{key} limit of {owner}", spot) for key in ("lower", "upper"))
        if lower > upper:
            raise InputError(f"limits of {owner} are swapped", given=f"lower {lower}, upper {upper}", where=spot)


def _bound(text: str | None, what: str, where: str) -> float:
    """A limit: as `number`, but 1e16 and the like stand for "none" in published URDFs."""
    try:
        value = float(text) if text is not None and not text.strip().lower().startswith(("nan", "inf", "-inf")) else 0.0
    except ValueError:
        value = 0.0
    return value if 1e9 < abs(value) < 1e300 else number(text, what, where)


def _tree(links: list[etree._Element], joints: list[etree._Element], where: str) -> None:
    parent: dict[str, str] = {}
    for joint in joints:
        up, down = (joint.find(end).get("link") for end in ("parent", "child"))
        if down in parent:
            raise InputError(
                f"link {down!r} has two parents",
                given=f"{parent[down]}, {up}",
                valid="a tree",
                where=at(where, joint),
            )
        parent[down] = up
    names = [link.get("name") for link in links]
    for start in names:
        seen = {start}
        link = start
        while link in parent:
            link = parent[link]
            if link in seen:
                raise InputError(
                    f"links form a loop through {start!r}",
                    given=", ".join(sorted(seen)),
                    valid="a tree",
                    where=where,
                )
            seen.add(link)
    roots = [name for name in names if name not in parent]
    if len(roots) != 1:
        raise InputError("robot has more than one root link", given=", ".join(roots), valid="one tree", where=where)
