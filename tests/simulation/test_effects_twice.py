"""An effect that stands twice at one place is one of twice its strength, in what moves and in the energy ledger."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.simulation.parts import EffectAt, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate

SCENE = Scene(wrist=Wrist(stiffness=530.0, damping=2.0), target=Target(mass=9.0, speed=0.1, gap=0.004), duration=0.6)


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
@pytest.mark.parametrize(
    ("name", "where", "values"),
    [
        ("cubic_stiffness", "wrist", {"k3_N_m3": 2e5}),
        ("quadratic_drag", "target", {"coefficient_Ns2_m2": 4.0}),
        ("coulomb_friction", "wrist", {"force_N": 0.2}),
    ],
)
def test_twice_is_twice_as_strong(name: str, where: str, values: dict[str, float], backend: str) -> None:
    one = SCENE.with_effects(EffectAt(name, where, {k: 2.0 * v for k, v in values.items()}))
    two = SCENE.with_effects(*[EffectAt(name, where, values)] * 2)
    single, double = (simulate(s, backend=backend, tolerance=1e-10, rate=200.0) for s in (one, two))
    assert double.restitution.target == pytest.approx(single.restitution.target, abs=1e-7)
    assert double.ledger.closure < 1e-6
    for element, stored in single.ledger.stored.items():
        held = double.ledger.stored[element]
        np.testing.assert_allclose(
            np.interp(0.1, double.ledger.time, held), np.interp(0.1, single.ledger.time, stored), rtol=1e-4, atol=1e-9
        )
