"""A hidden oscillator: part of the target's mass rides on a spring (slosh, a flexible appendage)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from spacerobot.effects.divided import divided
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import InputError


class HiddenOscillator(Effect):
    """A mass inside the target's own, on a spring and a damper."""

    name = "hidden_oscillator"
    title = "hidden oscillator"
    phrase = "a hidden oscillator"
    formula = r"m_s (\ddot\xi + \ddot x) = -m_s (2\zeta\omega_s \dot\xi + \omega_s^2 \xi), \quad m_t \to m_t - m_s"
    source = "Abramson (1966), NASA SP-106, equivalent mechanical model of slosh"
    kind = "body"
    carried = True  # in free fall nothing shakes it
    parameters = (
        Parameter("mass_kg", "kg", 0.0, 0.2, 0.0, 1e4, (0.5, 1.5, 0.2)),
        Parameter("frequency_Hz", "Hz", 1.0, 0.1, 0.05, 100.0, (2.0, 0.8, 5.0), log=True, shape=True),
        Parameter("damping_ratio", "1", 0.05, 0.02, 0.0, 2.0, (0.03, 0.15), shape=True),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The target."""
        return ("target",) if "target" in mechanism.coordinates else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The target's mass divided in two; what pulls on the target pulls on both.

        Raises:
            InputError: more mass than the target has.
        """
        share = values["mass_kg"]
        if share == 0.0:
            return mechanism
        total = mechanism.coordinates[where].mass
        if share >= total:
            raise InputError(
                "mass_kg is all of the target's mass or more, and it is a part of it",
                given=share,
                valid=f"below {total:g} kg",
                where=f"{self.name} at {where}",
            )
        omega = 2.0 * math.pi * values["frequency_Hz"]
        damping = 2.0 * values["damping_ratio"] * omega * share
        edited, inner = divided(mechanism, where, "slosh", share, stiffness=share * omega * omega, damping=damping)
        pulls = [replace(f, body=inner.name) for f in mechanism.fields if f.body == where]
        return edited.with_field(*pulls)

    def swinging(self, inertia: float, pace: float, ratio: float) -> Mapping[str, float]:
        """The mass that sloshes."""
        return {"mass_kg": inertia, "frequency_Hz": pace / (2.0 * math.pi), "damping_ratio": ratio}
