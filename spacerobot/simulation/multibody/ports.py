"""How a mechanism's ports read the assembly: features, and each port as a combination of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force
from spacerobot.simulation.multibody.assembly import Assembly
from spacerobot.simulation.multibody.kernel import (
    BASE,
    CIRCLE,
    HAND,
    HEADING,
    PAIR,
    PLAIN,
    POINT,
    QUATERNION,
    STRAIGHT,
    TARGET,
    TIP,
)
from spacerobot.simulation.multibody.layout import Layout
from spacerobot.simulation.reduced.arrays import FOLLOWS, NONE

_POINTS = {"hand": (HAND, 0), "tip": (TIP, 0), "target": (TARGET, 0), "target.y": (TARGET, 1), "base": (BASE, 0)}
_POINTS |= {"base.y": (BASE, 1), "base.z": (BASE, 2)}
_HEADINGS = {"target.yaw": (TARGET, 2), "base.roll": (BASE, 0), "base.pitch": (BASE, 1), "base.yaw": (BASE, 2)}
GRAVITY = "gravity"
"""Fields of this name are the scene's own gravity, which Pinocchio applies as a vector to every body."""


def pull(d: float, v: float, aux: float, p: Any) -> float:
    """A constant force; p = (force,)."""
    return p[0]


def pull_energy(d: float, v: float, aux: float, p: Any) -> float:
    """-F d."""
    return -p[0] * d


PULL = Kernel(pull, energy=pull_energy)


RISE = "contact.rise"
"""Port of the sliding out of the plane of approach and lateral, which a planar model does not have."""

SLIDE = "contact.slide"


def for_bodies(mechanism: Mechanism) -> Mechanism:
    """The mechanism with what a planar one can do without.

    Every field of an effect becomes a constant force on its body. Every friction across the contact acts upwards as
    it does sideways, the two of them within one limit: a disc in the tangent plane, see `mates`.
    """
    ports, forces, frictions = dict(mechanism.ports), list(mechanism.forces), list(mechanism.frictions)
    for item in mechanism.fields:
        if item.name == GRAVITY:
            continue
        port = f"body {item.body}"
        ports[port] = {item.body: 1.0}
        weight = mechanism.coordinates[item.body].mass * item.acceleration
        forces.append(Force(f"{item.name} on {item.body}", port, PULL, (weight,)))
    if mechanism.contact is not None:
        ports[RISE] = {}
        frictions += [replace(f, port=RISE) for f in frictions if f.port == SLIDE]
    return replace(mechanism, ports=ports, forces=tuple(forces), frictions=tuple(frictions), fields=())


def mates(mechanism: Mechanism) -> np.ndarray:
    """For each friction of a mechanism `for_bodies`: the one that shares its limit, NONE or FOLLOWS, shape (R,)."""
    ports = [f.port for f in mechanism.frictions]
    found = np.full(len(ports), NONE, dtype=np.int64)
    lead, follow = ([i for i, p in enumerate(ports) if p == port] for port in (SLIDE, RISE))
    found[lead], found[follow] = follow, FOLLOWS
    return found


def layout_of(assembly: Assembly, mechanism: Mechanism) -> tuple[Layout, list[str], np.ndarray]:
    """The kernel's constants, the features' names, and the mechanism's coordinates in features, shape (n, nf)."""
    model = assembly.model
    names = _features(assembly, mechanism)
    data = model.createData()
    pin.forwardKinematics(model, data, assembly.configuration)
    feature, reference = np.zeros((len(names), 3), dtype=np.int64), np.zeros(len(names))
    ahead = np.zeros((len(names), 3))
    touch_at = data.oMi[assembly.tip[0]].act(assembly.tip[1])
    lever = assembly.lever
    start = {
        "hand": data.oMi[assembly.hand[0]].act(assembly.hand[1]),
        "base": data.oMi[assembly.base[0]].act(assembly.base[1]),
        "tip": touch_at,
        "target": touch_at - lever,  # where the target is when it touches the resting wrist unturned
    }
    for f, name in enumerate(names):
        if name in _POINTS:
            body, direction = _POINTS[name]
            feature[f] = POINT, body, direction
            reference[f] = assembly.axes[:, direction] @ start[name.partition(".")[0]]
        elif name in _HEADINGS:
            body, axis = _HEADINGS[name]
            feature[f] = HEADING, body, axis
            # the base stands unturned at the start
            ahead[f] = assembly.ahead if body == TARGET else assembly.axes[:, (axis + 1) % 3]
        else:
            joint = model.joints[assembly.joints[name]]
            a, b = joint.idx_q, joint.idx_v
            q = assembly.configuration
            feature[f] = (STRAIGHT if joint.nq == 1 else CIRCLE), a, b
            if name.startswith("joint."):
                reference[f] = q[a] if joint.nq == 1 else np.arctan2(q[a + 1], q[a])
    rows = np.zeros((len(mechanism.ports), len(names)))
    for p, port in enumerate(mechanism.ports):
        rows[p] = _port(mechanism.ports[port], mechanism, names)
    at_ports = (mechanism.frictions, mechanism.states, mechanism.impulses, mechanism.inputs)
    read = {element.port for some in at_ports for element in some}
    read |= {p for f in mechanism.forces for p in (f.port, f.sense, *f.beside) if p is not None}
    used = np.array([p in read for p in mechanism.ports])
    coordinates = np.array([_coordinate(c, mechanism, names) for c in mechanism.coordinates])
    bodies = [0, assembly.hand[0], assembly.tip[0], assembly.base[0], assembly.target]
    tip = data.oMi[assembly.tip[0]].rotation
    return (
        Layout(
            joints=_joints(model),
            feature=feature,
            reference=reference,
            ports=rows,
            support=np.array([_support(model, body) for body in bodies]),
            carrier=np.array(bodies, dtype=np.int64) - 1,
            local=np.array([np.zeros(3), assembly.hand[1], assembly.tip[1], assembly.base[1], assembly.point]),
            axes=np.ascontiguousarray(assembly.axes.T),
            tip_axes=np.ascontiguousarray((tip.T @ assembly.axes).T),
            ahead=ahead,
            split=assembly.split,
            seen=(rows[used] != 0.0).any(axis=0).astype(np.int64),
            used=used.astype(np.int64),
            rise=list(mechanism.ports).index(RISE) if RISE in mechanism.ports else -1,
        ),
        names,
        coordinates,
    )


def _features(assembly: Assembly, mechanism: Mechanism) -> list[str]:
    names = ["hand", "slider", "tip", "target", "target.y", "target.yaw"]
    names += [n for n in mechanism.coordinates if n.partition(".")[0] == "base"]
    return names + [n for n in assembly.joints if n not in names]


def _port(row: Mapping[str, float], mechanism: Mechanism, names: list[str]) -> np.ndarray:
    """A port in features, shape (nf,). The wrist against the hand is the slider itself, however the hand turns."""
    total = np.zeros(len(names))
    held = "hand" not in mechanism.coordinates
    slides = "wrist" in row and (held or row.get("hand") == -row["wrist"])
    for coordinate, share in row.items():
        if not (slides and coordinate in ("wrist", "hand")):
            total += share * _coordinate(coordinate, mechanism, names)
    if slides:
        total[names.index("slider")] += row["wrist"]
    return total


def _coordinate(name: str, mechanism: Mechanism, names: list[str]) -> np.ndarray:
    """A coordinate in features, shape (nf,). What rides is its carrier plus its own displacement."""
    total = np.zeros(len(names))
    carrier = mechanism.carrier_of(name)
    total[names.index("tip" if name == "wrist" else name)] = 1.0
    return total if carrier is None else total + _coordinate(carrier, mechanism, names)


def _joints(model: pin.Model) -> np.ndarray:
    kinds = []
    for joint in list(model.joints)[1:]:
        kind = QUATERNION if joint.nq == 7 else PAIR if joint.nq == 2 else PLAIN
        kinds.append((kind, joint.idx_q, joint.idx_v))
    return np.array(kinds, dtype=np.int64)


def _support(model: pin.Model, body: int) -> np.ndarray:
    mask = np.zeros(model.nv, dtype=np.int64)
    while body:
        joint = model.joints[body]
        mask[joint.idx_v : joint.idx_v + joint.nv] = 1
        body = model.parents[body]
    return mask
