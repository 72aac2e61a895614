"""Base of the effects that sit at a sensor: one kind of map on all its channels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from spacerobot.effects.effect import Effect
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap


class SensorEffect(Effect):
    """A map of one kind, with the effect's single parameter as its value, on every channel of a sensor."""

    kind = "sensor"
    map_kind: ClassVar[str]

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Every sensor."""
        return tuple(mechanism.sensors)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The map on each of the sensor's channels."""
        (value,) = values.values()
        return mechanism.with_map(*(ChannelMap(c, self.map_kind, value) for c in mechanism.sensors[where]))
