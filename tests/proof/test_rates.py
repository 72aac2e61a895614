"""Rates, intervals and curves against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2, ncx2

from spacerobot.proof.orders import KINDS
from spacerobot.proof.rates import (
    Rate,
    calibration_error,
    confusion,
    coverage,
    median_interval,
    power_curve,
    relative_errors,
    reliability,
    smallest_found,
)
from spacerobot.proof.strength import LEVEL, POWER, critical
from spacerobot.proof.summary import TARGETS, as_json, held_out_ratio, met, outside, rates


def test_clopper_pearson_in_closed_form() -> None:
    none, every = Rate(0, 20), Rate(20, 20)
    assert none.low == 0.0
    assert none.high == pytest.approx(1.0 - 0.025 ** (1 / 20))
    assert every.low == pytest.approx(0.025 ** (1 / 20))
    assert every.high == 1.0


@pytest.mark.parametrize("p", [0.05, 0.3, 0.9])
def test_clopper_pearson_covers(p: float) -> None:
    """In repetitions the interval holds the true share at least as often as it says, and not always."""
    draws = np.random.default_rng(1).binomial(40, p, 4000)
    bounds = {k: Rate(int(k), 40) for k in np.unique(draws)}
    inside = np.mean([bounds[k].low <= p <= bounds[k].high for k in draws])
    assert 0.945 <= inside < 1.0


@pytest.mark.parametrize("parameters", [1, 2, 3, 4])
def test_critical_noncentrality_gives_the_power(parameters: int) -> None:
    rng = np.random.default_rng(2)
    shifted = rng.standard_normal((100_000, parameters))
    shifted[:, 0] += np.sqrt(critical(parameters))
    statistic = (shifted**2).sum(axis=1)
    found = np.mean(statistic > chi2.isf(LEVEL, parameters))
    assert found == pytest.approx(POWER, abs=0.004)
    assert ncx2.sf(chi2.isf(LEVEL, parameters), parameters, critical(parameters)) == pytest.approx(POWER)


def record(strength: float | None, top: bool, confidence: float = 0.8, **more: Any) -> dict[str, Any]:
    base = {
        "name": "x",
        "kind": "unlabelled",
        "family": "rig",
        "expected": "named",
        "hidden": [["coulomb_friction", "wrist"]],
        "strength": strength,
        "top": top,
        "in_set": top,
        "abstained": False,
        "confidently_wrong": not top,
        "said": "named",
        "favourite": [["coulomb_friction", "wrist"]] if top else [["viscous_drag", "target"]],
        "confidence": confidence,
        "parameters": [],
        "same": False,
        "equal": False,
        "seconds": 1.0,
    }
    return {**base, **more}


def test_the_smallest_found_is_where_detection_sets_in() -> None:
    records = [record(s, s > 2.0) for s in np.linspace(0.5, 8.0, 31)]
    found = smallest_found(records)
    assert found is not None
    assert found < 2.0  # from there on at least half are found, since all above are
    assert smallest_found([record(s, False) for s in (1.0, 5.0)]) is None
    assert smallest_found([record(s, True) for s in (1.0, 5.0)]) == 1.0


def test_power_curve_counts_by_strength() -> None:
    records = [record(1.0, False), record(1.1, True), record(5.0, True)]
    points = power_curve(records, (0.0, 2.0, 10.0))
    assert [(x, r.hits, r.total) for x, r in points] == [(1.05, 1, 2), (5.0, 1, 1)]


def test_reliability_compares_claims_with_outcomes() -> None:
    records = [record(5.0, i < 9, 0.9) for i in range(10)] + [record(5.0, i < 1, 0.3) for i in range(2)]
    points = reliability(records)
    assert [(x, r.value) for x, r in points] == [(pytest.approx(0.3), 0.5), (pytest.approx(0.9), 0.9)]


def test_confusion_counts_what_was_said() -> None:
    table = confusion(
        [record(5.0, True), record(5.0, False), record(None, True, hidden=[], expected="nothing_missing")]
    )
    assert table["coulomb_friction at wrist"] == {"coulomb_friction at wrist": 1, "viscous_drag at target": 1}
    assert table["nothing_missing"] == {"coulomb_friction at wrist": 1}
    blind = record(5.0, True, withheld="coulomb_friction", said="unknown", favourite=[])
    assert confusion([blind]) == {"coulomb_friction at wrist (withheld)": {"unknown": 1}}


def test_coverage_and_targets() -> None:
    good = {"parameter": "p", "true": 1.0, "value": 1.1, "low": 0.9, "high": 1.2}
    bad = {"parameter": "p", "true": 1.0, "value": 1.5, "low": 1.3, "high": 1.7}
    records = [record(5.0, True, parameters=[good, bad], held_out_ratio=1.02), record(2.0, False)]
    assert str(coverage(records)).startswith("50.0 % (1 of 2;")
    found = rates(records)
    assert (found["top"].hits, found["top"].total) == (1, 1)  # the weaker one is below three limits
    assert (found["confidently_wrong"].hits, found["confidently_wrong"].total) == (1, 2)
    assert held_out_ratio(records)[0] == 1.02
    many = [record(5.0, True, parameters=[good])] * 60 + [record(5.0, False, parameters=[bad])] * 20
    targets = as_json(many, {"seed": 1})["targets"]
    assert targets["top"]["met"] is False  # 75 %, 64 to 84
    assert targets["confidently_wrong"]["met"] is False
    assert targets["coverage"]["met"] is False
    assert targets["abstained"]["met"] is None  # of nothing


@given(st.sampled_from(list(TARGETS)), st.integers(0, 60), st.integers(1, 60))
def test_reached_is_said_of_an_intervals_end_and_never_of_a_bare_point(key: str, hits: int, total: int) -> None:
    found = Rate(min(hits, total), total)
    _, sense, bound = TARGETS[key]
    right = {">=": found.low >= bound, "<=": found.high <= bound, "between": bound <= found.low and found.high <= 0.98}
    wrong = found.high < bound if sense != "<=" else found.low > bound
    wrong = wrong or (sense == "between" and found.low > 0.98)
    assert met(key, found.low, found.high) is (True if right[sense] else False if wrong else None)


@pytest.mark.parametrize("key", ["nothing_missing", "top", "in_set", "wrong_parameter", "abstained"])
def test_two_of_two_reach_nothing(key: str) -> None:
    assert met(key, Rate(2, 2).low, Rate(2, 2).high) is None
    assert met(key, Rate(500, 500).low, Rate(500, 500).high) is True


@pytest.mark.parametrize("count", [6, 25, 80])
def test_the_medians_interval_holds_it_as_often_as_it_says(count: int) -> None:
    draws = np.random.default_rng(3).standard_exponential((3000, count))
    ends = [median_interval(d) for d in draws]
    inside = np.mean([low <= np.log(2.0) <= high for low, high in ends])
    assert 0.945 <= inside < 1.0
    assert median_interval(draws[0][:5]) == (-np.inf, np.inf)  # five are too few for 95 %


def test_false_claims_and_intervals_count_in_power_curves_too() -> None:
    """One more false claim, or one more interval that misses, anywhere makes the rate worse."""
    wide = {"parameter": "p", "true": 1.0, "value": 1.5, "low": 1.3, "high": 1.7}
    right = record(5.0, True, parameters=[{**wide, "low": 0.9}])
    for kind in KINDS:
        bad = record(0.5, False, kind=kind, parameters=[wide])
        found = rates([right, bad])
        assert (found["confidently_wrong"].hits, found["confidently_wrong"].total) == (1, 2), kind
        assert (found["coverage"].hits, found["coverage"].total) == (1, 2), kind


@pytest.mark.parametrize("family", ["rig", "servo arm"])
def test_no_parameter_is_left_out(family: str) -> None:
    """One mass that stands for seven modes has an interval that claims to know, as any other."""
    wide = {"true": 1.0, "value": 1.5, "low": 1.3, "high": 1.7}
    names = ("mass_kg", "stiffness_N_m", "damping_Ns_m")
    parameters = [{"parameter": f"arm_compliance@arm.{n}", **wide} for n in names]
    assert coverage([record(5.0, True, parameters=parameters, family=family)]).total == 3
    assert len(relative_errors([record(5.0, True, parameters=parameters, family=family)])) == 3


def test_what_a_stand_in_predicts_is_scored_apart() -> None:
    hidden = record(9.0, False, kind="withheld", expected="unknown", said="named", same=True)
    honest = record(
        9.0, True, kind="outsider", expected="unknown", said="unknown", abstained=True, confidently_wrong=False
    )
    apart, same = outside([hidden, honest])
    assert apart == [honest]
    assert same == [hidden]
    assert rates([hidden, honest])["abstained"].value == 1.0
    assert rates([hidden, honest])["confidently_wrong"].total == 1


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=1, max_size=60))
def test_calibration_is_no_further_off_than_the_furthest_answer(said: list[tuple[float, bool]]) -> None:
    records = [{"confidence": c, "top": t} for c, t in said]
    error, low, high = calibration_error(records)
    assert 0.0 <= low <= high <= 1.0
    assert error <= max(abs(c - t) for c, t in said) + 1e-12


def test_calibration_knows_the_sure_and_wrong_from_the_doubtful() -> None:
    sure = [{"confidence": 0.99, "top": False}] * 20
    honest = [{"confidence": 0.5, "top": k % 2 == 0} for k in range(200)]
    assert calibration_error(sure)[0] == pytest.approx(0.99)
    assert calibration_error(honest)[0] == pytest.approx(0.0, abs=1e-12)
    assert calibration_error(honest)[2] < 0.15
    assert math.isnan(calibration_error([{"confidence": None, "top": True}])[0])
