"""From a scene to the mechanism that both backends simulate."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.effects.effect import BASE_PORTS
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Field, Force, Readout
from spacerobot.simulation.outline import Outline
from spacerobot.simulation.parts import EffectAt
from spacerobot.simulation.planar import require_planar
from spacerobot.simulation.rig import rig
from spacerobot.simulation.servo_arm import ServoArm
from spacerobot.support.errors import InputError, NotFoundError

ARM_MOMENTUM = "arm.momentum"
"""Port whose rate is the momentum of an arm on servos along the approach [N s]."""

SERVO = "servo."
"""Ports of the reduced model at which the servos act, by joint."""

UNREACHABLE = 1e9
"""Mass [kg] that stands for a hand which moves, but not along the approach (a singular pose)."""


def baseline(scene: Outline, backend: str) -> Mechanism:
    """Hand, wrist and target of a scene, with its contact law, guide friction and servos.

    For "multibody" the moving joints and a free base have coordinates and ports too; the reduced model has them
    in the hand's mass alone.
    """
    wrist, contact, target = scene.wrist, scene.contact, scene.target
    turned = scene.axes.T @ scene.level
    point = turned @ np.array(target.contact_point)
    moves = scene.base == "free" or scene.joints != "locked"
    arm = scene.hand.arm
    mass = scene.hand.mass if arm is None else arm.mass
    if moves and math.isinf(mass):
        mass = UNREACHABLE
    along = float(np.array(scene.gravity) @ np.array(scene.approach))
    mechanism = rig(
        {
            "hand.mass": mass,
            "wrist.mass": wrist.mass,
            "wrist.stiffness": wrist.stiffness,
            "wrist.damping": wrist.damping,
            "wrist.equivalent_damping": wrist.equivalent_damping,
            "contact.stiffness": contact.stiffness,
            "contact.damping": contact.damping,
            "target.mass": target.mass,
            "target.yaw_inertia": float((turned @ target.inertia_matrix() @ turned.T)[2, 2]),
            "target.contact_point.ahead": float(point[0]),
            "target.contact_point.lateral": float(point[1]),
            "gravity.along": along,
        },
        bilateral=contact.bilateral,
        lateral=True,
    )
    mechanism = mechanism.with_contact(lambda c: replace(c, p=contact.parameters, hold=contact.adhesion))
    if along and scene.base == "free":
        mechanism = mechanism.with_field(Field("hand", along))
    sideways = float(np.array(scene.gravity) @ scene.axes[:, 1])
    if sideways and scene.base != "free":
        mechanism = mechanism.with_field(Field("target.y", sideways))
    if backend == "multibody":
        mechanism = _with_robot(scene, mechanism)
    elif arm is not None:
        mechanism = _with_arm(scene, mechanism, arm, along if scene.base == "free" else 0.0)
    if wrist.guide_friction > 0.0:
        mechanism = EffectAt("coulomb_friction", "wrist", {"force_N": wrist.guide_friction}).apply(mechanism)
    if contact.mu > 0.0:
        mechanism = EffectAt("contact_friction", "contact", {"mu": contact.mu}).apply(mechanism)
    return mechanism


def edited(scene: Outline, backend: str) -> Mechanism:
    """The baseline with the scene's effects applied in order.

    Raises:
        NotFoundError, InputError: an effect that cannot sit there; with its number in the scene.
    """
    mechanism = baseline(scene, backend)
    for i, item in enumerate(scene.effects):
        if not isinstance(item, EffectAt):
            raise InputError("must be an EffectAt", given=item, where=f"effects[{i}]")
        try:
            mechanism = item.apply(mechanism)
        except NotFoundError as error:
            hint = "" if backend == "multibody" else " (joints and base are places in backend multibody alone)"
            kind = f"{error.kind}{hint}" if error.kind.startswith("place") else error.kind
            raise NotFoundError(kind, error.name, error.known, where=f"effects[{i}]") from None
        except InputError as error:
            where = f"effects[{i}]" + (f" ({error.where})" if error.where else "")
            raise InputError(error.what, given=error.given, valid=error.valid, where=where) from None
    if backend == "reduced":
        require_planar(scene, mechanism)
        mechanism = _loaded(scene, mechanism)
    return mechanism


def _with_arm(scene: Outline, mechanism: Mechanism, arm: ServoArm, pull: float) -> Mechanism:
    """The arm's further coordinates and its servos; `pull` is the gravity along the approach that all of it feels."""
    coordinates, ports = dict(mechanism.coordinates), dict(mechanism.ports)
    forces, fields = list(mechanism.forces), list(mechanism.fields)
    assert scene.servo is not None
    for name, rate in zip(arm.names[1:], arm.rigid[1:].tolist(), strict=True):
        coordinates[name] = Coordinate(name, 1.0)
        if pull:
            fields.append(Field(name, pull * rate))
    ports[ARM_MOMENTUM] = arm.row(arm.rigid * np.array([arm.mass, *np.ones(arm.rigid.size - 1)]))
    chain = scene.prepared.chain
    for joint, rates, held in zip(chain, arm.joints, scene.servo.per_joint(chain), strict=True):
        port = f"{SERVO}{joint}"
        ports[port] = arm.row(rates)
        forces += _servo(f"joint.{joint}", port, *held)
    return replace(mechanism, coordinates=coordinates, ports=ports, forces=tuple(forces), fields=tuple(fields))


def _servo(joint: str, port: str, stiffness: float, damping: float) -> tuple[Force, Force]:
    return (
        Force(f"{joint}.servo_spring", port, SPRING, (stiffness,), role="spring"),
        Force(f"{joint}.servo_damper", port, DAMPER, (damping,), role="damper"),
    )


def _loaded(scene: Outline, mechanism: Mechanism) -> Mechanism:
    """Servos on a fixed base carry all weight from the start, that of a slider too which does not press on them yet."""
    along = float(np.array(scene.gravity) @ np.array(scene.approach))
    if scene.joints != "servo" or scene.base == "free" or not along or "hand" not in mechanism.coordinates:
        return mechanism
    weighs = mechanism.coordinates["wrist"].mass
    weighs += sum(c.mass for c in mechanism.coordinates.values() if mechanism.carrier_of(c.name) == "wrist")
    return mechanism.with_field(Field("hand", -along * weighs / mechanism.coordinates["hand"].mass, "servo load"))


def _with_robot(scene: Outline, mechanism: Mechanism) -> Mechanism:
    """Coordinates, ports, readouts and servos of the moving joints and the free base."""
    robot = scene.prepared
    coordinates, ports = dict(mechanism.coordinates), dict(mechanism.ports)
    readouts, sensors = dict(mechanism.readouts), dict(mechanism.sensors)
    forces = list(mechanism.forces)
    if scene.base == "free":
        body = robot.model.inertias[1]
        about = np.diag(scene.axes.T @ np.asarray(body.inertia) @ scene.axes)
        for i, name in enumerate(BASE_PORTS):
            mass = float(body.mass if i < 3 else about[i - 3])
            coordinates[name] = Coordinate(name, mass, angular=i >= 3)
            ports[name] = {name: 1.0}
            shown = "base.x" if name == "base" else name
            readouts[shown] = Readout(shown, "position", name)
        for i, axis in enumerate("xyz"):  # along and about the world's axes
            for port, names in ((f"base.position.{axis}", BASE_PORTS[:3]), (f"base.turn.{axis}", BASE_PORTS[3:])):
                ports[port] = {name: float(share) for name, share in zip(names, scene.axes[i], strict=True)}
            position, turn = f"base.position.{axis}", f"base.turn.{axis}"
            readouts[position] = Readout(position, "position", position)
            for channel, port in ((f"base.velocity.{axis}", position), (f"base.angular_velocity.{axis}", turn)):
                readouts[channel] = Readout(channel, "velocity", port)
    if scene.joints != "locked":
        inertia = joint_space_inertia(robot, scene.start)
        held = scene.servo.per_joint(robot.chain) if scene.servo is not None else ()
        for i, joint in enumerate(robot.chain):
            name = f"joint.{joint}"
            index = robot.velocity_index(joint)
            turns = joint_axis(robot.model, robot.joint_id(joint))[0]
            coordinates[name] = Coordinate(name, float(inertia[index, index]), angular=turns)
            ports[name] = {name: 1.0}
            readouts[f"{name}.position"] = Readout(f"{name}.position", "position", name)
            readouts[f"{name}.velocity"] = Readout(f"{name}.velocity", "velocity", name)
            if held:
                forces += _servo(name, name, *held[i])
        sensors["encoders"] = tuple(r for r in readouts if r.startswith("joint."))
    moved = robot.model.names[1:2] if scene.base == "free" else robot.chain[:1] if scene.joints != "locked" else ()
    return replace(
        mechanism,
        coordinates=coordinates,
        ports=ports,
        readouts=readouts,
        sensors=sensors,
        forces=tuple(forces),
        links=tuple(f"link.{name}" for name in robot.links_on(moved)),
        gravity=(scene.gravity[0], scene.gravity[1], scene.gravity[2]),
    )
