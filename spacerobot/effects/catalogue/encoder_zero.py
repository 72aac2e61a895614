"""An encoder whose zero is not the model's."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap


class EncoderZero(Effect):
    """What a joint's encoder reads where the model has its zero: the arm stands otherwise than it says."""

    name = "encoder_zero"
    title = "encoder zero"
    phrase = "a wrong zero of the encoder"
    formula = r"y = q + z"
    source = "Mooring, Roth and Driels (1991), Fundamentals of Manipulator Calibration, ch. 2"
    kind = "sensor"
    together = "zero"
    same_as = ("zero",)
    parameters = (Parameter("zero_m", "m", 0.0, 0.01, -10.0, 10.0, (0.01, -0.01)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Joints whose place is read, or may be."""
        return tuple(p for p in mechanism.ports if p.startswith("joint."))

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Every reading of the place by so much more."""
        return mechanism.with_map(ChannelMap(f"{where}.position", "offset", values["zero_m"]))
