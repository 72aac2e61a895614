"""Transmission coupling: a joint's drive is turned by another joint too, and rubs at both."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.catalogue.coulomb_friction import level
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.form import FormOf
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force, Friction
from spacerobot.effects.sizes import Sizes

LEAST = 0.1
"""Of a ratio that makes a coupling."""


def _joints(mechanism: Mechanism) -> list[str]:
    return [name for name in mechanism.ports if name.startswith("joint.")]


def _alone(mechanism: Mechanism) -> str | None:
    """The joint whose torque alone is compared."""
    shown = {c.removesuffix(".torque") for names in mechanism.sensors.values() for c in names if c.endswith(".torque")}
    return shown.pop() if len(shown) == 1 else None


def partner(mechanism: Mechanism, where: str) -> str | None:
    """The joint nearer to the base that turns a drive too: the one whose torque alone is compared, else the one before.

    None where there is none. A drive is the farther joint's: which of two is turned by both no torque tells.
    """
    joints, alone = _joints(mechanism), _alone(mechanism)
    place = joints.index(where)
    if alone in joints and alone != where:
        return alone if joints.index(alone) < place else None
    return joints[place - 1] if place else None


class TransmissionCoupling(Effect):
    """The elements of a joint's drive see its own angle and a share of another joint's; its own friction is one."""

    name = "transmission_coupling"
    title = "transmission coupling"
    formula = r"d_i = q_i + r\, q_j, \quad f = -F_c \operatorname{sign}(\dot d_i) - c\, \dot d_i"
    source = "coupled wrist drives; Khalil and Dombre (2002), ch. 9"
    parameters = (
        Parameter("coulomb_force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.2, 1.0)),
        Parameter("coefficient_Ns_m", "N s/m", 0.0, 0.1, 0.0, 1e5, (0.2, 1.0)),
        Parameter("ratio", "1", 0.0, 0.5, -10.0, 10.0, (1.0, -1.0, 0.3), shape=True),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Every joint that has another before it; where one alone is compared, those beyond it and itself."""
        return tuple(j for j in _joints(mechanism) if partner(mechanism, j) is not None)

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Gears of two joints turn together; with a ratio near nothing the friction is the joint's own."""
        ratio = values["ratio"]
        return "" if abs(ratio) > LEAST else f"with a ratio of {ratio:.2g} the friction is the joint's own"

    def apply(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """As everywhere; a drive of which no friction is stated has none."""
        return super().apply(mechanism, where, {"coulomb_force_N": 0.0, "coefficient_Ns_m": 0.0, **values})

    def in_form(self, form: str) -> Effect:
        """With the joint that stands at this number of the chain, from 0, for the other one."""
        return TurnedBy(self, form) if form.isdecimal() else super().in_form(form)

    def elsewhere(self, mechanism: Mechanism, where: str) -> tuple[str, Effect] | None:
        """The drive's friction loads both joints: from one of them, the other."""
        other, alone = partner(mechanism, where), _alone(mechanism)
        if other is None or alone is None:
            return None
        return (other, self) if alone == where else (where, self.in_form(str(_joints(mechanism).index(other))))

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The joint's port made to see the other joint, with the drive's friction at it."""
        other = partner(mechanism, where)
        return mechanism if other is None else turned(mechanism, where, other, values)


class TurnedBy(FormOf):
    """The coupling with a joint that need not be the one before."""

    def __init__(self, plain: Effect, form: str) -> None:
        self.other = int(form)
        super().__init__(plain, form)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """As the plain one, with that joint."""
        return turned(mechanism, where, _joints(mechanism)[self.other], values)


def turned(mechanism: Mechanism, where: str, other: str, values: Mapping[str, float]) -> Mechanism:
    """A mechanism with the drive of one joint turned by another one too, and rubbing at both."""
    name = TransmissionCoupling.name
    made = mechanism.with_port_row(where, other, values["ratio"])
    if dry := values.get("coulomb_force_N", 0.0):
        made = made.with_friction(Friction(f"{name} at {where}", where, level, (dry,), steady=True))
    if slope := values.get("coefficient_Ns_m", 0.0):
        made = made.with_force(Force(f"{name} at {where}, viscous", where, DAMPER, (slope,)))
    return made
