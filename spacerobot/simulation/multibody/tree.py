"""A Pinocchio model taken apart into links, added to, and put together again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

WORLD = "universe"
"""Pinocchio's name of what every tree hangs from."""


@dataclass(frozen=True, eq=False)
class Link:
    """A body and the joint that it moves by.

    Attributes:
        name: of the joint.
        parent: name of the joint that carries it, or WORLD.
        joint: its kind.
        placement: of the joint in its parent.
        inertia: of the body, in the joint.
        position: at the start, shape (nq,).
        armature: shape (nv,) [kg or kg m^2]; none if empty.
    """

    name: str
    parent: str
    joint: pin.JointModel
    placement: pin.SE3
    inertia: pin.Inertia
    position: np.ndarray
    armature: np.ndarray = field(default_factory=lambda: np.zeros(0))


def links_of(model: pin.Model, q: np.ndarray, armature: np.ndarray) -> list[Link]:
    """The links of a model at a configuration, parents first.

    Args:
        model: whatever order its joints have.
        q: shape (nq,).
        armature: shape (nv,).
    """
    found = []
    for i in range(1, model.njoints):
        joint = model.joints[i]
        found.append(
            Link(
                model.names[i],
                model.names[model.parents[i]],
                joint,
                model.jointPlacements[i],
                model.inertias[i],
                np.array(q[joint.idx_q : joint.idx_q + joint.nq]),
                np.array(armature[joint.idx_v : joint.idx_v + joint.nv]),
            )
        )
    return found


def put_together(links: Iterable[Link]) -> tuple[pin.Model, np.ndarray]:
    """One model, and its configuration at the start, shape (nq,).

    Pinocchio's composite-rigid-body algorithm takes a joint's subtree for the joints that follow it: the coupling of
    a body added behind another branch would be lost in silence. So every subtree is written in one piece.
    """
    children: dict[str, list[Link]] = {}
    for link in links:
        children.setdefault(link.parent, []).append(link)
    model, position, armature = pin.Model(), [np.zeros(0)], [np.zeros(0)]

    def write(parent: str) -> None:
        for link in children.get(parent, ()):
            joint = model.addJoint(model.getJointId(parent), link.joint, link.placement, link.name)
            model.appendBodyToJoint(joint, link.inertia, pin.SE3.Identity())
            position.append(link.position)
            armature.append(link.armature if link.armature.size else np.zeros(link.joint.nv))
            write(link.name)

    write(WORLD)
    model.armature = np.concatenate(armature)
    return model, np.concatenate(position)
