"""What lets something move by itself says how: its values for a pace and a damping ratio give just these."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Readout
from spacerobot.effects.registry import all_effects

WHOLE = 2.0


def body(name: str) -> Mechanism:
    return Mechanism(
        coordinates={name: Coordinate(name, WHOLE, angular=name.startswith("joint."))},
        ports={name: {name: 1.0}},
        readouts={f"{name}.position": Readout(f"{name}.position", "position", name)},
    )


PLACED = [(e, w) for e in all_effects().values() for w in ("joint.j", "target") if w in e.places(body(w))]
SWINGING = [(e, w) for e, w in PLACED if e.swinging(1.0, 1.0, 0.1)]


@pytest.mark.parametrize(("effect", "where"), SWINGING, ids=lambda x: getattr(x, "name", x))
@given(share=st.floats(0.05, 0.95), pace=st.floats(0.5, 200.0), ratio=st.floats(0.0, 0.9))
def test_it_swings_at_that_pace_on_a_place_held_still(effect, where, share, pace, ratio) -> None:  # type: ignore[no-untyped-def]
    made = effect.apply(body(where), where, effect.swinging(share * WHOLE, pace, ratio))
    (inner,) = [c for n, c in made.coordinates.items() if n != where]
    spring, damper = (sum(f.p[0] for f in made.forces if f.kernel is law) for law in (SPRING, DAMPER))
    assert inner.mass == pytest.approx(share * WHOLE)
    assert made.coordinates[where].mass == pytest.approx((1.0 - share) * WHOLE)
    assert math.sqrt(spring / inner.mass) == pytest.approx(pace)
    assert damper == pytest.approx(2.0 * ratio * pace * inner.mass)


def test_every_effect_of_a_body_that_adds_a_motion_says_so() -> None:
    """Or no fit would begin near its resonance."""
    assert {e.name for e, _ in SWINGING} == {"joint_flexibility", "hidden_oscillator"}
    for effect, where in PLACED:
        starts = {p.name: p.starts[-1] for p in effect.parameters}
        adds = len(effect.edit(body(where), where, starts).coordinates) > 1
        assert adds == bool(effect.swinging(1.0, 1.0, 0.1)), effect.name
