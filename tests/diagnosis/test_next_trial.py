"""The next trial: how far two explanations are apart in sensor sigmas, and where they are furthest."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.answer.next_trial import apart, furthest
from spacerobot.diagnosis.answer.verdict import alternative
from spacerobot.diagnosis.machines.contract import Variant
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.terms.decision import PENALTY


def explanation(slope: float) -> Any:
    return SimpleNamespace(hypothesis=None, z=slope)


class Ruler:
    """A machine that shows slope times start at every reading; its starts can be made larger."""

    def __init__(self, *sizes: float) -> None:
        self.sizes = sizes

    def nuisances(self, trial: Any) -> Any:
        return [SimpleNamespace(rate=True)]

    def variants(self, trial: Any) -> Any:
        return [Variant({"size": size}, self, rates=size) for size in self.sizes]  # type: ignore[arg-type]

    def trial_mechanism(self, hypothesis: Any, z: float, trial: Any) -> float:
        return z

    def predict(self, mechanism: float, trial: Any, start: np.ndarray) -> Any:
        return SimpleNamespace(blocks=[np.full((1, 4), mechanism * start[0])])


def shown(size: float, weight: float = 10.0) -> float | None:
    trial: Any = SimpleNamespace(id="one", blocks=[SimpleNamespace(weight=np.full((1, 4), weight))])
    return apart(PAIR, Variant({}, Ruler()), [trial], {"one": np.array([size])})  # type: ignore[arg-type]


PAIR: Any = [explanation(1.0), explanation(1.5)]


def test_apart_counts_sensor_sigmas() -> None:
    assert shown(2.0) == pytest.approx(np.sqrt(4 * (0.5 * 2.0 * 10.0) ** 2))
    assert shown(2.0, weight=0.0) == 0.0, "readings that do not count tell nothing"


def test_the_furthest_is_neither_the_first_nor_the_last() -> None:
    trial: Any = SimpleNamespace(id="one", blocks=[SimpleNamespace(weight=np.full((1, 4), 10.0))])
    machine: Any = Ruler(1.0, 5.0, 2.0)
    best, distance, here = furthest(PAIR, machine, [trial], {"one": np.ones(1)})
    assert best is not None
    assert best.change == {"size": 5.0}
    assert (distance, here) == (shown(5.0), shown(1.0))
    alike: Any = Ruler(1.0, 0.5)
    assert furthest(PAIR, alike, [trial], {"one": np.ones(1)}) == (None, here, here), "no trial tells more than these"


def fitted(cost: float, *, freed: tuple[str, ...] = (), moved: float = 0.0) -> Any:
    free = SimpleNamespace(kind="believed", key="target.mass", centre=20.0, value=lambda z: 20.0 + z)
    in_sigmas = {"target.mass": moved / 0.2}  # 1 % of 20 kg
    made = SimpleNamespace(label=(), sites=(), freed=freed, free=[free], sigmas=lambda z: in_sigmas)
    return SimpleNamespace(hypothesis=made, cost=cost, z=[moved], values=lambda: {"target.mass": 20.0 + moved})


def test_an_alternative_costs_what_it_leaves_more_than_the_best() -> None:
    assert alternative(fitted(12.0), fitted(10.0)).score == pytest.approx(2.0)


def test_it_is_told_by_values_beyond_three_of_their_own_sigmas() -> None:
    for moved, told in ((0.5, {}), (-0.5, {}), (0.7, {"target.mass": 20.7}), (-0.7, {"target.mass": 19.3})):
        assert alternative(fitted(1.0, moved=moved), fitted(0.0)).parameters == pytest.approx(told)


def test_a_belief_that_is_given_up_is_paid_for() -> None:
    assert score(fitted(10.0, freed=("target.mass",)), 2.0) == pytest.approx(5.0 + PENALTY)
    assert score(fitted(10.0), 2.0) == pytest.approx(5.0)
