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
    spring already, nor at those of an arm that gravity pulls at: a link that is heavier than believed does nearly the
    same there.
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
        """Joints without a spring, where no weight hangs on the pose."""
        if any(mechanism.gravity or ()):
            return ()
        sprung = {f.port for f in mechanism.forces if f.role == "spring"}
        return tuple(n for n in positions(mechanism, "joint") if n not in sprung)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A further spring at the port; it is nobody's to replace."""
        return mechanism.with_force(Force(f"{self.name} at {where}", where, SPRING, (values["stiffness_N_m"],)))
