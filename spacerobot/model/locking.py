"""Joints held fast: the URDF with those joints fixed where they stand, and the smaller model it gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import pinocchio as pin
from lxml import etree

from spacerobot.model import shapes
from spacerobot.model.build import rebuild
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.model.tips import Tree
from spacerobot.support.errors import InputError, NotFoundError


def with_locked(
    robot: Robot,
    pose: np.ndarray | None = None,
    joints: Iterable[str] | None = None,
    *,
    others: Mapping[str, float] | None = None,
) -> Robot:
    """A robot with some joints locked at a pose, what moves with them lumped.

    The armature of a locked joint goes with its motion; that of every other joint stays.

    Args:
        robot: any robot.
        pose: shape (len(chain),), joint positions [rad or m]; neutral if None.
        joints: which to lock; if None, all outside of the chain and the wrist (fingers, wheels, other arms).
        others: positions of joints outside of the chain by name.

    Raises:
        NotFoundError: no such joint.
        InputError: the free-flyer or the wrist slider, or a pose of the wrong length.
    """
    q = robot.configuration(pose, others=dict(others or {}))
    own = {*robot.chain, *([robot.slider] if robot.slider else [])}
    names = list(robot.model.names)[2 if robot.floating else 1 :]
    chosen = [n for n in names if n not in own] if joints is None else list(joints)
    for name in chosen:
        if robot.floating and name == robot.model.names[1]:
            raise InputError("the free-flyer cannot be locked", given=name, valid="a robot with a fixed base")
        if name not in names:
            raise NotFoundError("joint", name, names)
    if robot.slider in chosen:
        raise InputError("the wrist slider cannot be locked", given=str(robot.slider))
    if not chosen:
        return robot
    root = parse(robot.urdf, robot.name)
    tree = Tree(root)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    for name in dict.fromkeys(chosen):
        parent, child = (data.oMf[robot.frame_id(link)] for link in (tree.parent(name), tree.child(name)))
        _fix(tree.joints[name], parent.actInv(child))
    for transmission in root.findall("transmission"):
        driven = transmission.find("joint")
        if driven is not None and driven.get("name") in chosen:
            root.remove(transmission)
    return rebuild(robot, root, tip=None if robot.slider else robot.tip)


def _fix(joint: etree._Element, placement: pin.SE3) -> None:
    joint.set("type", "fixed")
    for tag in ("origin", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"):
        for element in joint.findall(tag):
            joint.remove(element)
    shapes.origin(joint, placement.translation, pin.rpy.matrixToRpy(placement.rotation))
