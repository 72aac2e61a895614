"""The next trial: how far two explanations are apart in sensor sigmas, and where they are furthest."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.answer.next_trial import Variant, apart, furthest
from spacerobot.diagnosis.answer.verdict import alternative
from spacerobot.diagnosis.selection.penalty import PENALTY, score


def explanation(slope: float) -> Any:
    return SimpleNamespace(hypothesis=None, z=slope)


class Ruler:
    """A machine that shows slope times start at every reading."""

    def trial_mechanism(self, hypothesis: Any, z: float, trial: Any) -> float:
        return z

    def predict(self, mechanism: float, trial: Any, start: np.ndarray) -> Any:
        return SimpleNamespace(blocks=[np.full((1, 4), mechanism * start[0])])


def plays(size: float, weight: float = 10.0) -> Any:
    return [(Ruler(), SimpleNamespace(blocks=[SimpleNamespace(weight=np.full((1, 4), weight))]), np.array([size]))]


PAIR: Any = [explanation(1.0), explanation(1.5)]


def test_apart_counts_sensor_sigmas() -> None:
    assert apart(PAIR, plays(2.0)) == pytest.approx(np.sqrt(4 * (0.5 * 2.0 * 10.0) ** 2))
    assert apart(PAIR, plays(2.0, weight=0.0)) == 0.0, "readings that do not count tell nothing"


def test_the_furthest_is_neither_the_first_nor_the_last() -> None:
    some = [Variant({"k": k}, plays(size)) for k, size in enumerate((1.0, 5.0, 2.0))]
    best, distance = furthest(PAIR, some)
    assert best is some[1]
    assert distance == apart(PAIR, plays(5.0))
    assert furthest(PAIR, some, least=1e9) == (None, 1e9)


def fitted(cost: float, *, freed: tuple[str, ...] = (), moved: float = 0.0) -> Any:
    free = SimpleNamespace(kind="believed", key="target.mass", centre=20.0, value=lambda z: 20.0 + z)
    made = SimpleNamespace(label=(), sites=(), freed=freed, free=[free])
    return SimpleNamespace(hypothesis=made, cost=cost, z=[moved], values=lambda: {"target.mass": 20.0 + moved})


def test_an_alternative_costs_what_it_leaves_more_than_the_best() -> None:
    assert alternative(fitted(12.0), fitted(10.0), {"target.mass": 0.01}).score == pytest.approx(2.0)


def test_it_is_told_by_values_beyond_three_of_their_own_sigmas() -> None:
    sigma = {"target.mass": 0.01}  # of 20 kg
    for moved, told in ((0.5, {}), (-0.5, {}), (0.7, {"target.mass": 20.7}), (-0.7, {"target.mass": 19.3})):
        assert alternative(fitted(1.0, moved=moved), fitted(0.0), sigma).parameters == pytest.approx(told)


def test_a_belief_that_is_given_up_is_paid_for() -> None:
    assert score(fitted(10.0, freed=("target.mass",)), 2.0) == pytest.approx(5.0 + PENALTY)
    assert score(fitted(10.0), 2.0) == pytest.approx(5.0)
