"""The air-bed rig (and any wrist that meets a floating body) as a mechanism: hand, wrist, target.

With a finite hand mass M these are Eqs. 2 to 4 of Uyama et al. (2012); with the hand held, their limit
M -> infinity.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.laws import CONTACT, DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Contact, Coordinate, Field, Force, Readout
from spacerobot.support.errors import InputError, NotFoundError

DEFAULTS: dict[str, float] = {
    "hand.mass": math.inf,
    "wrist.mass": 0.7,
    "wrist.stiffness": 1020.0,
    "wrist.damping": 0.0,
    "wrist.equivalent_damping": 0.0,
    "contact.stiffness": 68000.0,
    "contact.damping": 0.0,
    "target.mass": 9.0,
    "target.yaw_inertia": math.nan,
    "target.contact_point.ahead": 0.0,
    "target.contact_point.lateral": 0.0,
    "gravity.along": 0.0,
}
"""What a rig's values are called; a target without a yaw inertia does not turn."""

NON_NEGATIVE = (
    "wrist.stiffness",
    "wrist.damping",
    "wrist.equivalent_damping",
    "contact.stiffness",
    "contact.damping",
)


def rig(values: Mapping[str, float], *, bilateral: bool = False, lateral: bool = False) -> Mechanism:
    """The mechanism of a wrist and a target.

    Args:
        values: by dotted name, SI; the names of DEFAULTS, which fill what is absent. A finite "hand.mass" frees
            the hand; a "target.yaw_inertia" lets the target turn.
        bilateral: contact that ends when the penetration returns to zero (the paper's reading).
        lateral: give the target its sideways coordinate too.

    Raises:
        NotFoundError: an unknown value name.
        InputError: a value that cannot be.
    """
    v = dict(DEFAULTS)
    for name, value in values.items():
        if name not in v:
            raise NotFoundError("value of a rig", name, v)
        v[name] = float(value)
    for name in NON_NEGATIVE:
        if not v[name] >= 0.0:
            raise InputError("must not be negative", given=v[name], where=name)
    coordinates = {}
    hand = math.isfinite(v["hand.mass"])
    if hand:
        coordinates["hand"] = Coordinate("hand", v["hand.mass"])
    coordinates["wrist"] = Coordinate("wrist", v["wrist.mass"])
    coordinates["target"] = Coordinate("target", v["target.mass"])
    turning = math.isfinite(v["target.yaw_inertia"])
    if lateral:
        coordinates["target.y"] = Coordinate("target.y", v["target.mass"])
    if turning:
        coordinates["target.yaw"] = Coordinate("target.yaw", v["target.yaw_inertia"], angular=True)
    ports = {
        "wrist": {"wrist": 1.0, "hand": -1.0} if hand else {"wrist": 1.0},
        "wrist.position": {"wrist": 1.0},
        "target": {"target": 1.0},
    }
    readouts = {
        "wrist.x": Readout("wrist.x", "position", "wrist.position"),
        "target.x": Readout("target.x", "position", "target"),
        "contact.force": Readout("contact.force", "force", "contact"),
    }
    ports["hand"] = {"hand": 1.0} if hand else {}
    readouts["hand.x"] = Readout("hand.x", "position", "hand")
    for name in ("target.y", "target.yaw"):
        if name in coordinates:
            ports[name] = {name: 1.0}
            readouts[name] = Readout(name, "position", name)
    law = (v["contact.stiffness"], v["contact.damping"], 1.0, 0.0)
    fields: tuple[Field, ...] = ()
    if v["gravity.along"]:
        bodies = [name for name in ("wrist", "target") if name in coordinates]
        fields = tuple(Field(body, v["gravity.along"]) for body in bodies)
    return Mechanism(
        coordinates=coordinates,
        ports=ports,
        contact=Contact(
            CONTACT,
            law,
            bilateral=bilateral,
            ahead=v["target.contact_point.ahead"],
            lateral=v["target.contact_point.lateral"],
        ),
        forces=(
            Force("wrist.spring", "wrist", SPRING, (v["wrist.stiffness"],), role="spring"),
            Force("wrist.damper", "wrist", DAMPER, (v["wrist.damping"],), role="damper"),
            Force("wrist.equivalent_damper", "wrist", DAMPER, (v["wrist.equivalent_damping"],), role="damper"),
        ),
        fields=fields,
        readouts=readouts,
        sensors={
            "force_sensor": ("contact.force",),
            "mocap": tuple(c for c in readouts if c != "contact.force"),
        },
    )
