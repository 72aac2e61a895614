"""Friction that is smooth about rest: what holds in closed form, and against the sharp law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.effects.catalogue.coulomb_friction import smooth
from spacerobot.effects.registry import effect
from spacerobot.effects.sizes import Sizes
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.rig import rig
from spacerobot.support.errors import InputError
from tests.effects.test_catalogue_laws import VALUES, brought, strike

NAME = "coulomb_friction~creeping"
LEVEL, SPEED = 0.4, 2e-3


PLAIN = {
    "coulomb_friction": {"force_N": LEVEL},
    "stribeck_friction": {"static_force_N": 1.5 * LEVEL, "coulomb_force_N": LEVEL, "velocity_m_s": 0.02},
}


@pytest.mark.parametrize(
    ("name", "where"), [("coulomb_friction", "wrist"), ("coulomb_friction", "target"), ("stribeck_friction", "wrist")]
)
def test_it_nears_the_sharp_law_as_its_speed_goes_to_nothing(name: str, where: str) -> None:
    times = np.linspace(0.0, 0.8, 81)
    sharp = strike(effect(name).apply(rig(VALUES), where, PLAIN[name])).positions(times)

    def away(speed: float) -> float:
        one = effect(f"{name}~creeping").apply(rig(VALUES), where, {**PLAIN[name], "creep_m_s": speed})
        return float(np.abs(strike(one).positions(times) - sharp).max())

    near, far = away(1e-5), away(1e-3)
    assert near < 1e-5  # what creeps for 0.8 s at 1e-5 m/s goes no further
    assert near < 0.1 * far


@pytest.mark.parametrize("name", PLAIN)
def test_it_brings_no_energy(name: str) -> None:
    one = effect(f"{name}~creeping")
    assert brought(one.apply(rig(VALUES), "wrist", {**PLAIN[name], "creep_m_s": SPEED})) < 1e-9


@given(st.floats(1e-6, 1.0), st.floats(0.0, 2.0 * math.pi))
def test_in_the_plane_it_acts_against_the_velocity_whatever_its_direction(speed: float, angle: float) -> None:
    v = speed * np.array([math.cos(angle), math.sin(angle)])
    both = np.array([smooth(0.0, float(v[i]), float(v[1 - i]), (LEVEL, SPEED)) for i in (0, 1)])
    assert np.linalg.norm(both) == pytest.approx(LEVEL * math.tanh(speed / SPEED), rel=1e-6)
    assert both @ v == pytest.approx(-np.linalg.norm(both) * speed, rel=1e-9)


def test_a_law_that_is_level_nowhere_is_no_friction_of_this_kind() -> None:
    one, sizes = effect(NAME), Sizes(force=10.0, length=0.02, time=0.2)
    assert one.implausible({"force_N": LEVEL, "creep_m_s": 1e-3}, sizes) == ""
    assert "damper" in one.implausible({"force_N": LEVEL, "creep_m_s": 0.2}, sizes)


def test_a_scene_states_its_kind() -> None:
    stated = EffectAt("coulomb_friction", "wrist", {"force_N": LEVEL, "creep_m_s": SPEED, "kind": "creeping"})
    named = effect(NAME).apply(rig(VALUES), "wrist", {"force_N": LEVEL, "creep_m_s": SPEED})
    assert stated.apply(rig(VALUES)).forces[-1] == named.forces[-1]
    with pytest.raises(InputError):
        EffectAt("coulomb_friction", "wrist", {"force_N": LEVEL, "kind": "creaking"}).apply(rig(VALUES))
