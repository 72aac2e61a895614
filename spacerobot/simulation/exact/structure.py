"""A scene's reduced model as a piecewise linear system: which numbers it has, and what they multiply.

A rig is piecewise linear where its springs, dampers and contact are linear and its friction is a constant level.
Between events it is then z' = A z + b, and what differs from one collision to the next is one vector of numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.effects.catalogue.coulomb_friction import level as coulomb
from spacerobot.effects.laws import CONTACT, DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Contact
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import reduced_start
from spacerobot.support.errors import InputError

OUTLINE = ("lumped_mass", "wrist_stiffness", "travel", "closing_speed", "hand_mass", "hand_stiffness", "pull")
"""What the length of a run is reckoned from; follows the numbers of the system in the vector."""


class NotLinearError(InputError):
    """A scene that is not piecewise linear, and why."""


@dataclass(frozen=True)
class Structure:
    """What is shared by all collisions of a kind. n coordinates, F springs and dampers; R, 0 or 1, frictions.

    The vector of numbers holds masses (n), coefficients (F), contact stiffness and damping, holding force, friction
    level, accelerations of the fields (n), initial positions (n) and velocities (n), then OUTLINE.

    Attributes:
        coordinates: those that anything acts on; others only drift.
        rows: of the springs and dampers, n numbers each.
        kinds: of them; 0 a spring, 1 a damper.
        contact, friction, hand, target, wrist: rows of these ports; friction empty where there is none.
        bilateral: whether the contact pulls until the penetration is back at zero.
    """

    coordinates: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    kinds: tuple[int, ...]
    contact: tuple[float, ...]
    friction: tuple[float, ...]
    hand: tuple[float, ...]
    target: tuple[float, ...]
    wrist: tuple[float, ...]
    bilateral: bool

    @property
    def size(self) -> int:
        """Numbers in a vector."""
        return 4 * len(self.coordinates) + len(self.kinds) + 4 + len(OUTLINE)

    def packed(self) -> tuple[np.ndarray, np.ndarray]:
        """Header (n, F, R, bilateral, kinds...) and rows (F + 5, n): springs and dampers, contact, friction, hand,
        target, wrist."""
        n = len(self.coordinates)
        header = [n, len(self.kinds), int(bool(self.friction)), int(self.bilateral), *self.kinds]
        rows = [*self.rows, self.contact, self.friction or (0.0,) * n, self.hand, self.target, self.wrist]
        return np.array(header, dtype=np.int64), np.array(rows, dtype=float).reshape(len(rows), n)


def piecewise_linear(scene: Scene) -> tuple[Structure, np.ndarray]:
    """The structure of a scene's reduced model and its vector of numbers, shape (structure.size,).

    Raises:
        NotLinearError: something in the scene is not linear between events.
    """
    mechanism = scene.mechanism("reduced")
    contact = mechanism.contact
    assert contact is not None
    position, velocity = reduced_start(scene)
    _require_linear(mechanism, contact, position, velocity)
    row_of = {**mechanism.ports, "contact": {"target": 1.0, "wrist": -1.0}}
    acting = [row_of[f.port] for f in mechanism.forces] + [row_of["contact"]]
    acting += [row_of[f.port] for f in mechanism.frictions]
    used = {c for row in acting for c, share in row.items() if share} | {"wrist", "target"}
    names = tuple(c for c in mechanism.coordinates if c in used or c == "hand")

    def row(port: str) -> tuple[float, ...]:
        return tuple(float(row_of.get(port, {}).get(c, 0.0)) for c in names)

    accelerations = dict.fromkeys(names, 0.0)
    for item in mechanism.fields:
        if item.body in accelerations:
            accelerations[item.body] += item.acceleration
    structure = Structure(
        names,
        tuple(row(f.port) for f in mechanism.forces),
        tuple(0 if f.kernel == SPRING else 1 for f in mechanism.forces),
        row("contact"),
        row(mechanism.frictions[0].port) if mechanism.frictions else (),
        row("hand"),
        row("target"),
        row("wrist"),
        contact.bilateral,
    )
    values = [
        *(mechanism.coordinates[c].mass for c in names),
        *(f.p[0] for f in mechanism.forces),
        contact.p[0],
        contact.p[1],
        contact.hold,
        mechanism.frictions[0].p[0] if mechanism.frictions else 0.0,
        *accelerations.values(),
        *(position[c] for c in names),
        *(velocity[c] for c in names),
        scene.wrist.mass + scene.target.mass,
        scene.wrist.stiffness,
        scene.target.gap + scene.wrist.deflection,
        scene.closing_speed,
        scene.hand.mass,
        scene.hand.stiffness,
        scene.pull,
    ]
    return structure, np.array(values, dtype=float)


def _require_linear(
    mechanism: Mechanism, contact: Contact, position: dict[str, float], velocity: dict[str, float]
) -> None:
    def refuse(what: str, given: object) -> None:
        raise NotLinearError(f"not piecewise linear: {what}", given=given)

    if contact.kernel != CONTACT or contact.p[2:4] != (1.0, 0.0):
        refuse("the contact law", contact.p)
    if contact.lateral or position.get("target.yaw") or velocity.get("target.yaw"):
        refuse("a target that turns", contact.lateral)
    if not math.isfinite(contact.hold):
        refuse("a contact that never parts", contact.hold)
    for force in mechanism.forces:
        if force.kernel not in (SPRING, DAMPER) or force.aux or (force.sense or force.port) != force.port:
            refuse("a force", force.name)
        if force.port == "contact.slide":
            refuse("a force along the surface", force.name)
    for friction in mechanism.frictions:
        if friction.level is not coulomb or friction.normal is not None or len(mechanism.frictions) > 1:
            refuse("friction", friction.name)
    for state in mechanism.states:
        refuse("a law with a memory", state.name)
    if mechanism.impulses or mechanism.inputs:
        refuse(
            "an impulse or a recorded drive",
            [*(k.name for k in mechanism.impulses), *(i.name for i in mechanism.inputs)],
        )
