"""The scale itself is weighed: what is right, what is excused, and where exactly the line runs."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from spacerobot.proof.judge import DEFINITE, NOTICEABLE, judge
from spacerobot.proof.rates import Rate, coverage, power_curve, smallest_found

RUB = {"effect": "coulomb_friction", "where": "wrist", "force_N": 0.3}
TILT = {"effect": "table_tilt", "where": "target", "angle_rad": 1e-3}
SAID = ("named", "wrong_parameter", "nothing_missing", "ambiguous", "unknown", "not_trusted")


def truth(
    *effects: dict[str, Any], expected: str = "named", strength: float | None = None, **more: Any
) -> dict[str, Any]:
    return {"effects": list(effects), "expected": expected, "parameters": [], "strength": strength, **more}


def verdict(said: str, *sets: list[dict[str, Any]], moved: tuple[str, ...] = ()) -> dict[str, Any]:
    def shown(e: dict[str, Any]) -> dict[str, Any]:
        values = {k: {"value": v, "ci95": [0.9 * v, 1.1 * v]} for k, v in e.items() if isinstance(v, float)}
        return {"effect": e["effect"], "where": e["where"], "parameters": values}

    listed = [[shown(e) for e in one] for one in sets]
    return {
        "verdict": said,
        "confidence": 0.9,
        "effects": listed[0] if said == "named" and listed else [],
        "alternatives": [{"effects": one} for one in listed],
        "parameters": {key: {} for key in moved},
    }


EXPECTED = {
    "named": truth(RUB),
    "nothing_missing": truth(expected="nothing_missing"),
    "unknown": truth(RUB, expected="unknown"),
    "wrong_parameter": {**truth(expected="wrong_parameter"), "parameters": ["wrist.stiffness"]},
}


@pytest.mark.parametrize(("expected", "said"), list(itertools.product(EXPECTED, SAID)))
def test_only_the_truth_is_right_and_only_a_claim_can_be_wrong(expected: str, said: str) -> None:
    """Of every pair of what is so and what is said (an answer of the right class is right in its content too)."""
    found = judge(EXPECTED[expected], verdict(said, [RUB], moved=("wrist.stiffness",)))
    right = said == expected or (expected, said) == ("named", "ambiguous")
    assert found.top == right
    assert found.confidently_wrong == (said in DEFINITE and not right)
    assert found.abstained == (said not in DEFINITE)
    assert found.in_set >= found.top


@pytest.mark.parametrize(
    ("strength", "excused"), [(None, False), (0.5, True), (NOTICEABLE - 1e-9, True), (NOTICEABLE, False), (9.0, False)]
)
def test_to_see_nothing_is_excused_below_the_line_and_not_at_it(strength: float | None, excused: bool) -> None:
    found = judge(truth(RUB, strength=strength), verdict("nothing_missing"))
    assert found.confidently_wrong != excused
    assert not found.top
    assert judge(truth(RUB, strength=strength), verdict("named", [TILT])).confidently_wrong, "a wrong name never is"


def test_a_set_is_right_as_a_whole_or_not_at_all() -> None:
    both = truth(RUB, TILT)
    assert judge(both, verdict("named", [TILT, RUB])).top
    for part in ([RUB], [TILT], [RUB, TILT, {"effect": "preload", "where": "wrist", "force_N": 1.0}]):
        assert judge(both, verdict("named", part)).confidently_wrong
    elsewhere = {**RUB, "where": "target"}
    assert judge(truth(RUB), verdict("named", [elsewhere])).confidently_wrong


def test_an_alternative_is_in_the_set_and_only_the_first_is_the_favourite() -> None:
    second = judge(truth(RUB), verdict("ambiguous", [TILT], [RUB]))
    assert (second.top, second.in_set, second.confidently_wrong) == (False, True, False)
    assert judge(truth(RUB), verdict("ambiguous", [RUB], [TILT])).top


def test_every_wrong_value_has_to_be_recognised() -> None:
    two = {**truth(expected="wrong_parameter"), "parameters": ["wrist.stiffness", "target.mass"]}
    assert judge(two, verdict("wrong_parameter", moved=("wrist.stiffness", "target.mass", "wrist.mass"))).top
    assert judge(two, verdict("wrong_parameter", moved=("wrist.stiffness",))).confidently_wrong
    assert judge(two, verdict("wrong_parameter")).confidently_wrong


def test_no_answer_is_no_claim() -> None:
    found = judge(truth(RUB), None)
    assert (found.top, found.in_set, found.confidently_wrong, found.abstained) == (False, False, False, True)


@pytest.mark.parametrize(
    ("hits", "total", "low", "high"),
    [(0, 20, 0.0, 0.16843), (20, 20, 0.83157, 1.0), (10, 20, 0.27196, 0.72804), (434, 470, 0.89553, 0.94593)],
)
def test_rates_have_the_interval_of_clopper_and_pearson(hits: int, total: int, low: float, high: float) -> None:
    """Bounds at which so many hits, or more extreme ones, have 2.5 % (Clopper and Pearson 1934)."""
    from scipy.stats import binom

    found = Rate(hits, total)
    assert (found.low, found.high) == (pytest.approx(low, abs=2e-4), pytest.approx(high, abs=2e-4))
    if hits:
        assert binom.sf(hits - 1, total, found.low) == pytest.approx(0.025, rel=1e-6)
    if hits < total:
        assert binom.cdf(hits, total, found.high) == pytest.approx(0.025, rel=1e-6)


def record(strength: float, top: bool, low: float = 0.0, high: float = 1.0, true: float = 0.5) -> dict[str, Any]:
    parameter = {"parameter": "coulomb_friction@wrist.force_N", "true": true, "value": 0.4, "low": low, "high": high}
    return {"strength": strength, "top": top, "family": "rig", "parameters": [parameter]}


def test_an_interval_holds_the_truth_at_its_ends_too() -> None:
    ends = [
        record(1.0, True, 0.5, 0.6),
        record(1.0, True, 0.4, 0.5),
        record(1.0, True, 0.51, 0.6),
        record(1.0, True, 0.3, 0.49),
    ]
    found = coverage(ends)
    assert (found.hits, found.total) == (2, 4)


def test_each_strength_is_in_one_bin() -> None:
    """A bin begins at its lower edge and ends before its upper one."""
    edges = (0.5, 1.0, 2.0)
    found = power_curve([record(s, s >= 1.0) for s in (0.5, 0.75, 1.0, 1.5)], edges)
    assert [(r.hits, r.total) for _, r in found] == [(0, 2), (2, 2)]


def test_the_smallest_found_is_where_the_rest_holds() -> None:
    hits = [(0.5, False), (1.0, True), (2.0, False), (3.0, True), (4.0, True)]
    assert smallest_found([record(s, t) for s, t in hits], share=0.95) == 3.0
    assert smallest_found([record(s, False) for s, _ in hits]) is None
