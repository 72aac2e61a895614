"""From a scene and its mechanism to one Pinocchio model of robot, target and appendages."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.tree_arrays import TreeArrays, tree_arrays
from spacerobot.effects.effect import BASE_PORTS
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate
from spacerobot.simulation.multibody.tree import WORLD, Link, links_of, put_together
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError

TARGET, CARRIAGE = "spacerobot_target", "spacerobot_hand"
"""Names of the joints that this backend adds: the target's free-flyer, and the slide of a hand that an effect
puts between a held arm and its wrist."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """One model, and where everything sits in it. World axes.

    Attributes:
        model: robot (held joints removed), target on a free-flyer, appendages on slides. Not to be changed.
        tree: the model's arrays.
        joints: coordinate or "slider" -> joint index, of those that are one joint's own displacement.
        hand, tip, base: joint that carries the frame (0: the world) and the frame's origin in it, shape (3,).
        target: joint of the target; its origin is the centre of mass.
        point: contact point in the target's body axes, shape (3,) [m].
        axes: columns approach, lateral, up, shape (3, 3).
        split: first velocity index of the target; what is before moves with the robot, the rest with the target.
        lever: from the target's centre of mass to its contact point at yaw zero, world axes, shape (3,) [m].
        ahead: what is the approach at yaw zero, in the target's body axes, shape (3,).
        configuration: shape (nq,), at the start, but slider and what rides on others at rest.
        start: shape (nq,), at the start.
        velocity: shape (nv,), at the start.
    """

    model: pin.Model
    tree: TreeArrays
    joints: dict[str, int]
    hand: tuple[int, np.ndarray]
    tip: tuple[int, np.ndarray]
    base: tuple[int, np.ndarray]
    target: int
    point: np.ndarray
    axes: np.ndarray
    split: int
    lever: np.ndarray
    ahead: np.ndarray
    configuration: np.ndarray
    start: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True, eq=False)
class Bodies:
    """What of an assembly no initial state changes: kept between runs, and never to be changed.

    Attributes:
        model, joints, hand, tip, base, target: as in Assembly.
        tree: the model's arrays.
        configuration: shape (nq,), at the start, but slider and riders at rest and the target at the origin.
        touch: where the tip is then, world axes, shape (3,) [m].
    """

    model: pin.Model
    joints: dict[str, int]
    hand: tuple[int, np.ndarray]
    tip: tuple[int, np.ndarray]
    base: tuple[int, np.ndarray]
    target: int
    tree: TreeArrays
    configuration: np.ndarray
    touch: np.ndarray


KEPT = 32
"""Machines whose bodies are kept."""

_kept_bodies: OrderedDict[Any, Bodies] = OrderedDict()
_lock = threading.Lock()


def assemble_bodies(scene: Scene, mechanism: Mechanism) -> Assembly:
    """The model of a scene whose effects have edited `mechanism`, and its start.

    Raises:
        InputError: a coordinate of the mechanism that no body of the scene can be.
    """
    key = _key(scene, mechanism)
    with _lock:
        bodies = _kept_bodies.get(key)
    if bodies is None:
        bodies = _bodies(scene, mechanism)
        with _lock:
            _kept_bodies[key] = bodies
            while len(_kept_bodies) > KEPT:
                _kept_bodies.popitem(last=False)
    model, joints, approach = bodies.model, bodies.joints, np.array(scene.approach)
    target = model.joints[bodies.target]
    q, v = bodies.configuration.copy(), np.zeros(model.nv)
    q[target.idx_q : target.idx_q + 3] = bodies.touch - scene.lever - scene.target.gap * approach
    if scene.base == "free":
        v[:3] = np.array(scene.motion.base_velocity) - scene.hand_speed * approach
        v[3:6] = scene.motion.base_spin  # the base stands unturned at the start
    for name, rate in scene.motion.joint_rates.items():
        v[model.joints[joints[f"joint.{name}"]].idx_v] = rate
    start = q.copy()
    slider = model.joints[joints["slider"]]
    start[slider.idx_q], v[slider.idx_v] = scene.wrist.deflection, scene.wrist.deflection_rate
    for name, (displacement, rate) in scene.motion.carried.items():
        joint = model.joints[joints[name]]
        start[joint.idx_q], v[joint.idx_v] = displacement, rate
    at = target.idx_v
    v[at : at + 3] = scene.attitude.T @ (scene.target.speed * approach + scene.target.drift * scene.axes[:, 1])
    v[at + 3 : at + 6] = scene.attitude.T @ np.array(scene.target.spin)
    return Assembly(
        model=model,
        tree=bodies.tree,
        joints=joints,
        hand=bodies.hand,
        tip=bodies.tip,
        base=bodies.base,
        target=bodies.target,
        point=scene.attitude.T @ scene.lever,
        axes=scene.axes,
        split=at,
        lever=scene.lever_at_zero_yaw,
        ahead=scene.level.T @ approach,
        configuration=q,
        start=start,
        velocity=v,
    )


def _key(scene: Scene, mechanism: Mechanism) -> Any:
    """Everything that `_bodies` reads. A robot by its name can change with its file, so its text counts."""
    robot, target = scene.robot, scene.target
    before = scene.baseline("multibody").coordinates
    return (
        (robot, scene.prepared.urdf) if isinstance(robot, str) else robot,
        (scene.base, scene.joints, scene.pose, scene.tip, tuple(sorted(scene.others.items()))),
        (scene.approach, scene.wrist.mass, repr(scene.spacecraft)),
        (target.attitude, target.inertia_matrix().tobytes()),
        tuple((c, before[n].mass if n in before else None) for n, c in mechanism.coordinates.items()),
        mechanism.loads,
        mechanism.gravity,
    )


def _bodies(scene: Scene, mechanism: Mechanism) -> Bodies:
    robot = scene.prepared
    full = robot.model
    start = scene.start
    moving = {str(robot.slider)}
    if scene.joints != "locked":
        moving.update(robot.chain)
    if scene.base == "free":
        moving.add(full.names[1])
    held = [i for i in range(1, full.njoints) if full.names[i] not in moving]
    model = pin.buildReducedModel(full, held, start)
    q = np.array(start[_kept(full, model)])
    armature = np.zeros(model.nv)
    for i in range(1, model.njoints):
        old = full.joints[full.getJointId(model.names[i])]
        armature[model.joints[i].idx_v : model.joints[i].idx_v + old.nv] = full.armature[old.idx_v : old.idx_v + old.nv]

    moved_by = {"slider": str(robot.slider)}
    if "hand" in mechanism.coordinates and model.njoints == 2:
        model = _with_carriage(model, mechanism.coordinates["hand"], np.array(scene.approach))
        moved_by["hand"] = CARRIAGE
        q, armature = np.concatenate([[0.0], q]), np.concatenate([[0.0], armature])
    for name in mechanism.coordinates:
        if name.startswith("joint."):
            moved_by[name] = name.removeprefix("joint.")
    _edit_masses(scene, mechanism, model, moved_by, armature)

    hand, tip = (_frame(model, name) for name in (robot.tip, str(robot.contact)))
    base = (model.names[1] if scene.base == "free" else WORLD, np.zeros(3))
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    turned = {model.names[i]: np.array(data.oMi[i].rotation) for i in range(model.njoints)}
    touch = data.oMi[model.getJointId(tip[0])].act(tip[1])
    links = links_of(model, q, armature)
    attitude = pin.Quaternion(scene.attitude)
    attitude.normalize()
    links.append(
        Link(
            TARGET,
            WORLD,
            pin.JointModelFreeFlyer(),
            pin.SE3.Identity(),
            pin.Inertia(mechanism.coordinates["target"].mass, np.zeros(3), scene.target.inertia_matrix()),
            np.concatenate([np.zeros(3), attitude.coeffs()]),
        )
    )
    turned[TARGET] = scene.attitude
    carriers = {"target": (TARGET, np.zeros(3)), "wrist": tip, "hand": hand, "base": base}
    for coordinate in mechanism.coordinates.values():
        if coordinate.name not in moved_by and coordinate.name not in _OWN:
            links.append(_rider(coordinate, carriers, turned, scene.axes))
            moved_by[coordinate.name] = coordinate.name
            carriers[coordinate.name] = coordinate.name, np.zeros(3)
            turned[coordinate.name] = turned[links[-1].parent]
    model, q = put_together(sorted(links, key=lambda link: link.name == TARGET))
    model.gravity.linear = np.array(mechanism.gravity)
    _require_inertia(scene, mechanism, model, q)
    return Bodies(
        model=model,
        joints={name: model.getJointId(joint) for name, joint in moved_by.items()},
        hand=(model.getJointId(hand[0]), hand[1]),
        tip=(model.getJointId(tip[0]), tip[1]),
        base=(model.getJointId(base[0]), base[1]),
        target=int(model.getJointId(TARGET)),
        tree=tree_arrays(model),
        configuration=q,
        touch=touch,
    )


_OWN = ("hand", "wrist", "target", "target.y", "target.yaw", *BASE_PORTS)


def _kept(full: pin.Model, reduced: pin.Model) -> list[int]:
    """Where the reduced model's configuration sits in the full one's."""
    places: list[int] = []
    for i in range(1, reduced.njoints):
        joint = full.joints[full.getJointId(reduced.names[i])]
        places += range(joint.idx_q, joint.idx_q + joint.nq)
    return places


def _frame(model: pin.Model, name: str) -> tuple[str, np.ndarray]:
    """The joint that carries a frame, and the frame's origin in it, shape (3,)."""
    frame = model.frames[model.getFrameId(name)]
    return str(model.names[frame.parentJoint]), np.array(frame.placement.translation)


def _with_carriage(model: pin.Model, hand: Coordinate, approach: np.ndarray) -> pin.Model:
    """A held arm's slider put on a slide along the approach that weighs what the mechanism's hand does."""
    new = pin.Model()
    carriage = new.addJoint(0, pin.JointModelPrismaticUnaligned(approach), pin.SE3.Identity(), CARRIAGE)
    new.appendBodyToJoint(carriage, pin.Inertia(hand.mass, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    slider = new.addJoint(carriage, model.joints[1], model.jointPlacements[1], model.names[1])
    new.appendBodyToJoint(slider, model.inertias[1], pin.SE3.Identity())
    for frame in model.frames:
        if frame.type == pin.FrameType.BODY:
            parent = slider if frame.parentJoint == 1 else carriage
            new.addFrame(pin.Frame(frame.name, parent, 0, frame.placement, pin.FrameType.BODY))
    return new


def _edit_masses(
    scene: Scene,
    mechanism: Mechanism,
    model: pin.Model,
    moved_by: Mapping[str, str],
    armature: np.ndarray,
) -> None:
    """Give the bodies what effects added to the baseline's masses."""
    before = scene.baseline("multibody").coordinates
    for name, coordinate in mechanism.coordinates.items():
        if name not in before or name.startswith("target"):
            continue
        added = coordinate.mass - before[name].mass
        if added == 0.0:
            continue
        if name.startswith("joint."):
            armature[model.joints[model.getJointId(moved_by[name])].idx_v] += added
            continue
        if name == "hand":
            carrier, point = _frame(model, scene.prepared.tip)
            joint = model.getJointId(carrier)
        else:
            joint = model.getJointId(moved_by["slider"]) if name == "wrist" else 1
            point = np.array(model.inertias[joint].lever)
        old, whole = model.inertias[joint], _mass_with(model, joint, added, name)
        if added > 0.0 or name == "hand":
            model.inertias[joint] = old + pin.Inertia(added, point, np.zeros((3, 3)))
        else:
            model.inertias[joint] = _as_it_is(old, whole)
    for load in mechanism.loads:
        frame = model.frames[model.getFrameId(load.link.removeprefix("link."))]
        whole, old = _mass_with(model, frame.parentJoint, load.mass, load.link), model.inertias[frame.parentJoint]
        if load.place is not None:
            place = frame.placement.act(np.array(load.place))
            model.inertias[frame.parentJoint] = old + pin.Inertia(load.mass, place, np.zeros((3, 3)))
        elif old.mass > 0.0:
            model.inertias[frame.parentJoint] = _as_it_is(old, whole)
        else:
            raise InputError("the link has no mass of its own to be more of", given=load.link)


def _as_it_is(old: pin.Inertia, mass: float) -> pin.Inertia:
    """A body of another mass [kg], distributed as before."""
    return pin.Inertia(mass, old.lever, mass / old.mass * old.inertia)


def _mass_with(model: pin.Model, joint: int, added: float, name: str) -> float:
    """Mass of what a joint moves with this added [kg].

    Raises:
        InputError: nothing would be left.
    """
    whole = float(model.inertias[joint].mass + added)
    if whole <= 0.0:
        raise InputError("a body would have no mass left", given=f"{name}: {whole:g} kg")
    return whole


def _require_inertia(scene: Scene, mechanism: Mechanism, model: pin.Model, q: np.ndarray) -> None:
    """What effects took away must leave an inertia in every direction: a joint's own can be all but its coupling.

    Raises:
        InputError: it does not.
    """
    before = scene.baseline("multibody").coordinates
    less = {n: c.mass - before[n].mass for n, c in mechanism.coordinates.items() if n in before}
    less |= {load.link: load.mass for load in mechanism.loads}
    if min(less.values()) >= 0.0:
        return
    try:
        np.linalg.cholesky(pin.crba(model, model.createData(), q))
    except np.linalg.LinAlgError:
        taken = ", ".join(f"{m:g} at {n}" for n, m in less.items() if m < 0.0)
        raise InputError(
            "effects take away more inertia than can be spared: some motion would have none left",
            given=f"{taken} (kg, kg m^2)",
            valid="less",
            where="effects",
        ) from None


def _rider(
    coordinate: Coordinate,
    carriers: Mapping[str, tuple[str, np.ndarray]],
    turned: Mapping[str, np.ndarray],
    axes: np.ndarray,
) -> Link:
    """A body that slides along the approach (or turns about up) in its carrier.

    Args:
        coordinate: what it is to the mechanism.
        carriers: by name: the joint that moves it, and where in that, shape (3,) [m].
        turned: rotation of every joint to world at the start, shape (3, 3).
        axes: columns approach, lateral, up, shape (3, 3).
    """
    if coordinate.carrier is None or coordinate.carrier not in carriers:
        raise InputError(
            f"coordinate {coordinate.name!r} is no body of the scene",
            given=f"carrier {coordinate.carrier!r}",
            valid=", ".join(carriers),
        )
    parent, point = carriers[coordinate.carrier]
    axis = turned[parent].T @ axes[:, 2 if coordinate.angular else 0]
    kind = pin.JointModelRevoluteUnaligned if coordinate.angular else pin.JointModelPrismaticUnaligned
    if coordinate.angular:
        inertia = pin.Inertia(1e-9, np.zeros(3), coordinate.mass * np.eye(3))
    else:
        inertia = pin.Inertia(coordinate.mass, np.zeros(3), np.zeros((3, 3)))
    return Link(coordinate.name, parent, kind(axis), pin.SE3(np.eye(3), point), inertia, np.zeros(1))
