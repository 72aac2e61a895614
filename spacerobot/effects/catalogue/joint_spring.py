"""Spring at a joint: a cable, a hose or a counterbalance that pulls it back."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.laws import SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class JointSpring(Effect):
    """A torque in proportion to the joint's angle, of which the model knows nothing; negative drives it away.

    With a constant torque beside it the spring rests elsewhere than at the joint's zero. Not at joints that have a
    spring already; of several joints only where there is no weight, or that slide level: elsewhere a link that is
    heavier than believed does nearly the same, or a base that leans.
    """

    name = "joint_spring"
    title = "spring at a joint"
    phrase = "a spring"
    curve = "a line in d"
    formula = r"f = -k\, d"
    source = "Hooke (1678)"
    same_as = ("stiffness",)
    parameters = (Parameter("stiffness_N_m", "N/m", 0.0, 1.0, -1e7, 1e7, (1.0, -1.0, 30.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Joints without a spring, one alone or, of several, those that no weight moves."""
        joints = positions(mechanism, "joint")
        if len(joints) > 1 and (mechanism.gravity is None or any(mechanism.gravity)):
            joints = tuple(n for n in joints if n in mechanism.level)
        sprung = {f.port for f in mechanism.forces if f.role == "spring"}
        return tuple(n for n in joints if n not in sprung)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A further spring at the port; it is nobody's to replace."""
        return mechanism.with_force(Force(f"{self.name} at {where}", where, SPRING, (values["stiffness_N_m"],)))
