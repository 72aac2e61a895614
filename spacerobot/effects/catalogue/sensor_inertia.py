"""Sensor inertia: a force sensor that rides on a moving part feels its own mass."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap


class SensorInertia(Effect):
    """The sensor's own mass times the acceleration of the wrist it rides on."""

    name = "sensor_inertia"
    title = "sensor inertia"
    formula = r"F_\mathrm{read} = F - m_s\, \ddot x_w"
    source = "Newton's second law for the sensor's own mass"
    kind = "sensor"
    parameters = (Parameter("mass_kg", "kg", 0.0, 0.02, -10.0, 10.0, (0.05, 0.2, -0.05)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Sensors that read the contact force."""
        if "wrist.position" not in mechanism.ports:
            return ()
        return tuple(s for s, channels in mechanism.sensors.items() if "contact.force" in channels)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """An inertia map on the sensor's force channels."""
        channels = [c for c in mechanism.sensors[where] if c == "contact.force"]
        return mechanism.with_map(*(ChannelMap(c, "inertia", values["mass_kg"], "wrist.position") for c in channels))
