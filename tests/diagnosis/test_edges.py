"""Each line that a diagnosis draws, tried just on this side of it and just on the other."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.adequacy import ChannelLeft
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.selection.model_choice import pays, ratio
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import GROUP_LIMIT, LEVEL_LIMIT, SIGNIFICANT, WORTH_OF_REST
from spacerobot.support.runs import combined_hash

EPS = 1e-6
PLAIN = ChannelLeft("target.x", 1.0, 1.0, 10_000_000, 0.0, 0.0, 0.0, 0.0, "01")


@pytest.mark.parametrize(
    ("field", "limit"), [("colour", SIGNIFICANT), ("worst", GROUP_LIMIT), ("level", 1.0 + LEVEL_LIMIT)]
)
def test_what_is_left_is_noise_up_to_its_limit_and_not_beyond(field: str, limit: float) -> None:
    assert replace(PLAIN, **{field: limit - EPS}).white
    assert not replace(PLAIN, **{field: limit + EPS}).white


@pytest.mark.parametrize("noise", [0.5, 2.0])
def test_the_level_is_held_against_the_noise_seen_before_contact(noise: float) -> None:
    one = replace(PLAIN, noise=noise)
    assert replace(one, level=noise * (1.0 + LEVEL_LIMIT - EPS)).white
    assert not replace(one, level=noise * (1.0 + LEVEL_LIMIT + EPS)).white


def test_of_few_samples_an_excess_has_to_be_five_of_its_own_errors() -> None:
    few = replace(PLAIN, samples=200, early=400)
    edge = SIGNIFICANT * math.sqrt(2.0 / 200 + 2.0 / 400)
    assert edge > LEVEL_LIMIT
    assert replace(few, level=1.0 + edge - EPS).white
    assert not replace(few, level=1.0 + edge + EPS).white


def test_an_approach_that_is_no_free_motion_is_never_noise() -> None:
    assert PLAIN.white
    assert not replace(PLAIN, bent=True).white


def tried(residual: dict[str, np.ndarray]) -> Candidate:
    counted = {k: np.ones(r.size, dtype=bool) for k, r in residual.items()}
    return Candidate(SimpleNamespace(hypothesis=SimpleNamespace(sites=(), label=())), HeldOut(residual, counted))  # type: ignore[arg-type]


def named(count: int) -> list[TrialData]:
    return [TrialData(f"{k:02d}", "", {}, (), 0.0, 1.0) for k in range(count)]


def against(factors: list[float], size: float = 30.0) -> tuple[Candidate, Candidate]:
    """Two models: the rest of the one is that of the other times a factor, trial by trial."""
    rng = np.random.default_rng(1)
    old = {f"{k:02d}": size * rng.normal(size=400) for k in range(len(factors))}
    return tried({k: f * old[k] for k, f in zip(old, factors, strict=True)}), tried(old)


@pytest.mark.parametrize("count", [1, 2, 5, 9])
def test_a_further_parameter_pays_from_its_share_on(count: int) -> None:
    new, old = against([1.0 - WORTH_OF_REST - 1e-4] * count)
    assert ratio(new, old) == pytest.approx(1.0 - WORTH_OF_REST - 1e-4)
    assert pays(new, old, named(count))
    assert not pays(*against([1.0 - WORTH_OF_REST + 1e-4] * count), named(count))
    assert not pays(old, new, named(count)), "and never the other way round"


def test_models_that_say_the_same_are_not_told_apart() -> None:
    one, other = against([1.0] * 5)
    assert ratio(one, other) == 1.0
    assert not pays(one, other, named(5))


def test_hashes_of_numbers_do_not_run_together() -> None:
    assert combined_hash(1, 23) != combined_hash(12, 3)
    assert combined_hash([1], [2]) != combined_hash([1, 2])
    assert combined_hash(None, "a") != combined_hash("a", None)
    assert combined_hash(0.1) != combined_hash(0.1 + 1e-16 * 2)
