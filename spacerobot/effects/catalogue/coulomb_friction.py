"""Coulomb friction: a constant force against the sliding, and sticking below it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from spacerobot.effects.creeping import KIND, Creeping, along
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across, along_all, bodies, in_space
from spacerobot.effects.primitives import Friction


def level(v: float, normal: float, aux: float, p: Any) -> float:
    """p = (force,)."""
    return p[0]


def dry(name: str, port: str, force: float) -> Friction:
    """Dry friction of one level [N or N m] at a port."""
    return Friction(name, port, level, (force,), steady=True)


CREEP = 1e-4
"""Speed [m/s] below which a body that slides in the plane may as well rest: there its friction is smoothed, since
only friction along one direction can be set-valued."""


def in_plane(d: float, v: float, aux: float, p: Any) -> float:
    """One component of -F v/|v|; aux is the rate across, p = (force,)."""
    return -p[0] * v / math.sqrt(v * v + aux * aux + CREEP * CREEP)


IN_PLANE = Kernel(in_plane)


def smooth(d: float, v: float, aux: float, p: Any) -> float:
    """p = (force, speed below which it creeps)."""
    return -level(v, 0.0, aux, p) * along(v, aux, p[1])


SMOOTH = Kernel(smooth)


class CoulombFriction(Effect):
    """Dry friction of one level."""

    name = "coulomb_friction"
    title = "Coulomb friction"
    curve = "a level of friction"
    formula = r"f = -F_c \operatorname{sign}(v), \quad |f| \le F_c \text{ at rest}"
    source = "Coulomb (1785)"
    parameters = (Parameter("force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.02, 0.2, 1.0)),)
    replaces = ("{where}.equivalent_damping",)
    same_as = ("friction",)
    carried = True
    forms = (KIND,)

    def in_form(self, form: str) -> Effect:
        """Smooth about rest: "creeping"."""
        return Creeping(self, SMOOTH, "F_c") if form == KIND else super().in_form(form)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides, joints, and a body that slides on a table."""
        afloat = in_space(mechanism)
        bearing = ("target.yaw", "base.yaw") if mechanism.contact is None and not afloat else ()
        sliding = () if afloat else ("target", "target.y")
        return bodies(mechanism, "wrist", *sliding, *bearing, "base", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction of constant level at the port; of a body in the plane against its velocity."""
        p, others = (values["force_N"],), across(mechanism, where)
        if others:
            return mechanism.with_force(*along_all(self.name, (where, *others), IN_PLANE, p))
        return mechanism.with_friction(dry(f"{self.name} at {where}", where, values["force_N"]))
