"""Weighing sets of unlike size: what a further effect must earn, and how much of that a law's own defect may earn."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.selection.penalty import defect, simplest
from spacerobot.diagnosis.terms.decision import MARGIN, SLIGHT, SMALL

FRICTION, DRAG = ("coulomb_friction", "wrist"), ("viscous_drag", "target")
STRIBECK, ARM = ("stribeck_friction", "wrist"), ("arm_compliance", "arm")


def fit(*label: tuple[str, str]) -> Any:
    sites = [SimpleNamespace(effect=SimpleNamespace(stands_for="x" if one is ARM else "")) for one in label]
    return SimpleNamespace(hypothesis=SimpleNamespace(label=tuple(sorted(label)), sites=sites))


def winner(general: Any, special: Any, earned: float, explained: float = 0.0, adequate: bool = False) -> Any:
    scores = {id(special): 1e5, id(general): 1e5 - earned}
    ranked = sorted([general, special], key=lambda f: scores[id(f)])
    return simplest(ranked, scores, 1e5 + explained, lambda fit: adequate)


@given(st.integers(-100, 10**6))
def test_a_further_effect_wins_exactly_where_it_leads_by_the_margin(earned: int) -> None:
    """Whatever the first one explains, where it leaves more than noise."""
    pair, single = fit(FRICTION, DRAG), fit(FRICTION)
    assert winner(pair, single, earned) is (pair if earned >= MARGIN else single)
    assert winner(pair, single, earned, 1e6) is (pair if earned >= MARGIN else single)
    rich = fit(STRIBECK)
    assert winner(rich, single, earned) is (rich if earned >= MARGIN else single)


@given(st.integers(-100, 10**6), st.integers(0, 10**6))
def test_beside_a_law_that_leaves_noise_it_must_earn_more_than_that_laws_own_defects(earned: int, by: int) -> None:
    """A tiny further effect would else be named wherever the first one is as strong as a simulator is exact."""
    pair, single = fit(FRICTION, DRAG), fit(FRICTION)
    wins = earned >= max(MARGIN, SMALL * by)
    assert winner(pair, single, earned, by, True) is (pair if wins else single)


@given(st.integers(-(10**6), 10**6))
def test_what_does_not_hold_the_best_never_takes_its_place(earned: int) -> None:
    pair, other = fit(FRICTION, DRAG), fit(("backlash", "wrist"))
    assert winner(pair, other, earned) is (pair if earned >= 0.0 else other)


@pytest.mark.parametrize(
    ("part", "whole", "adequate", "share"),
    [
        (fit(FRICTION), fit(FRICTION, DRAG), False, SMALL),
        (fit(FRICTION), fit(FRICTION, DRAG), True, SLIGHT),
        (fit(FRICTION), fit(STRIBECK), True, SMALL),
        (fit(ARM), fit(ARM, DRAG), False, SLIGHT),
    ],
)
def test_how_much_a_laws_own_defect_may_earn(part: Any, whole: Any, adequate: bool, share: float) -> None:
    assert defect(part, whole, 1e5, adequate) == pytest.approx(share * 1e5)
    assert defect(part, whole, -1.0, adequate) == 0.0
