"""Transmission coupling: a joint's drive is moved by its neighbour."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


def _joints(mechanism: Mechanism) -> list[str]:
    return [name for name in mechanism.ports if name.startswith("joint.")]


class TransmissionCoupling(Effect):
    """The elements of a joint's drive see its own angle and a share of the angle of the joint before it."""

    name = "transmission_coupling"
    title = "transmission coupling"
    formula = r"d_i = q_i + r\, q_{i-1}"
    source = "coupled wrist drives; Khalil and Dombre (2002), ch. 9"
    parameters = (Parameter("ratio", "1", 0.0, 0.02, -10.0, 10.0, (0.1, -0.1)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Every joint but the first."""
        return tuple(_joints(mechanism)[1:])

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The joint's port made to see its neighbour."""
        joints = _joints(mechanism)
        before = joints[joints.index(where) - 1]
        return mechanism.with_port_row(where, before, values["ratio"])
