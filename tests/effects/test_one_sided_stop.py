"""A stop on one side: what it pushes with, where it is looked for, and what a scene calls it."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.terms.candidates import redundant
from spacerobot.diagnosis.terms.reach import reached_edge
from spacerobot.effects.kernel import padded
from spacerobot.effects.one_sided import KERNEL
from spacerobot.effects.registry import effect
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.support.errors import NotFoundError


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_it_pushes_back_beyond_where_it_begins_and_nowhere_else(way: float) -> None:
    p = padded((50.0, 0.2 * way, way))
    for d in np.linspace(-0.5, 0.5, 21):
        over = max(way * d - 0.2, 0.0)
        assert KERNEL.force(d, 0.0, 0.0, p) == pytest.approx(-way * 50.0 * over)
        step = 1e-6
        fall = KERNEL.energy(d - step, 0.0, 0.0, p) - KERNEL.energy(d + step, 0.0, 0.0, p)
        assert KERNEL.force(d, 0.0, 0.0, p) == pytest.approx(fall / (2.0 * step), abs=1e-3)


@pytest.mark.parametrize(
    ("seen", "forms"),
    [
        (np.linspace(-0.3, 0.3, 50), ("above", "below")),
        (np.linspace(0.2, 0.8, 50), ("below",)),  # the plain one acts above there, whichever is meant
        (np.linspace(-0.8, -0.2, 50), ("above",)),
        (np.linspace(-0.01, 0.8, 50), ("below",)),  # a wrist that is pushed in and comes back
        (np.zeros(0), ()),
    ],
)
def test_it_is_another_than_one_on_both_sides_where_the_place_goes_both_ways(
    seen: np.ndarray, forms: tuple[str, ...]
) -> None:
    assert effect("end_stop").forms_at(seen) == forms


@pytest.mark.parametrize(
    ("name", "edge"),
    [("end_stop", 0.792), ("end_stop~above", 0.79), ("end_stop~below", -0.19)],
)
def test_it_is_looked_for_where_its_own_side_was_reached(name: str, edge: float) -> None:
    assert reached_edge(effect(name), np.linspace(-0.2, 0.8, 500)) == pytest.approx(edge, abs=1e-3)


def test_a_range_that_does_not_hold_zero_has_its_stop_at_the_near_end_too() -> None:
    assert reached_edge(effect("end_stop~below"), np.linspace(0.2, 0.8, 500)) == pytest.approx(0.206, abs=1e-3)


def test_two_forms_of_one_effect_are_two_laws_of_one_thing() -> None:
    assert redundant([("end_stop", "joint.a"), ("end_stop~above", "joint.a")])
    assert not redundant([("end_stop~above", "joint.a"), ("end_stop~above", "joint.b")])


def test_a_scene_says_on_which_side() -> None:
    said = EffectAt("end_stop", "wrist", {"kind": "below", "travel_m": -0.01, "stiffness_N_m": 1e4})
    assert said._formed()[0].name == "end_stop~below"
    with pytest.raises(NotFoundError):
        EffectAt("end_stop", "wrist", {"kind": "left", "travel_m": 0.01, "stiffness_N_m": 1e4})._formed()
