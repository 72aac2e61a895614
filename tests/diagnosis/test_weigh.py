"""Weighing sets of unlike size: what a further effect must earn, and beside what."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from spacerobot.diagnosis.weigh import SLIGHT, SMALL, simplest

FRICTION, DRAG = ("coulomb_friction", "wrist"), ("viscous_drag", "target")
STRIBECK = ("stribeck_friction", "wrist")


def fit(*label: tuple[str, str]) -> Any:
    return SimpleNamespace(hypothesis=SimpleNamespace(label=tuple(sorted(label)), sites=label))


def winner(general: Any, special: Any, share: float, adequate: bool) -> Any:
    """Which wins where the special one explains 1e5 of the cost and the general one that share of it more."""
    base = fit()
    scores = {id(base): 2e5, id(special): 1e5, id(general): 1e5 - share * 1e5}
    return simplest([general, special], scores, base, lambda f: adequate and f is special)


@pytest.mark.parametrize(
    ("share", "adequate", "both"),
    [
        (0.5 * SMALL, False, False),
        (2.0 * SMALL, False, True),
        (2.0 * SMALL, True, False),
        (0.8 * SLIGHT, True, False),
        (1.2 * SLIGHT, True, True),
    ],
)
def test_a_further_effect_beside_one_that_leaves_noise_must_earn_more(share: float, adequate: bool, both: bool) -> None:
    pair, single = fit(FRICTION, DRAG), fit(FRICTION)
    assert winner(pair, single, share, adequate) is (pair if both else single)


def test_a_richer_law_in_a_laws_place_is_no_further_effect() -> None:
    rich, plain = fit(STRIBECK), fit(FRICTION)
    assert winner(rich, plain, 2.0 * SMALL, True) is rich
    assert winner(rich, plain, 0.5 * SMALL, True) is plain


def test_what_does_not_hold_the_best_never_takes_its_place() -> None:
    pair, other = fit(FRICTION, DRAG), fit(("backlash", "wrist"))
    assert winner(pair, other, 1e-9, True) is pair
