"""Scores against the seal: every outcome that a verdict can have."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from spacerobot.proof.judge import band_share, judge

FRICTION = {"effect": "coulomb_friction", "where": "wrist", "force_N": 0.3}
DRAG = {"effect": "quadratic_drag", "where": "target", "coefficient_Ns2_m2": 4.0}
CLAIM = {
    "effect": "coulomb_friction",
    "where": "wrist",
    "parameters": {"force_N": {"value": 0.31, "ci95": [0.29, 0.33], "unit": "N"}},
}
OTHER = {"effect": "viscous_drag", "where": "target", "parameters": {}}


def truth(*effects: dict[str, Any], expected: str = "named", strength: float = 10.0, **more: Any) -> dict[str, Any]:
    return {"effects": list(effects), "expected": expected, "parameters": [], "strength": strength, **more}


def verdict(kind: str, *effects: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"verdict": kind, "confidence": 0.9, "effects": list(effects), "alternatives": [], "parameters": {}, **more}


def sets(*groups: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{"effects": g, "parameters": {}, "score": 0.0} for g in groups]


@pytest.mark.parametrize(
    ("seal", "said", "top", "in_set", "wrong", "abstained"),
    [
        (truth(FRICTION), verdict("named", CLAIM), True, True, False, False),
        (truth(FRICTION), verdict("named", OTHER), False, False, True, False),
        (truth(FRICTION), verdict("named", CLAIM, OTHER), False, False, True, False),
        (truth(FRICTION, DRAG), verdict("named", CLAIM), False, False, True, False),
        (truth(FRICTION), verdict("ambiguous", alternatives=sets([CLAIM], [OTHER])), True, True, False, True),
        (truth(FRICTION), verdict("ambiguous", alternatives=sets([OTHER], [CLAIM])), False, True, False, True),
        (truth(FRICTION), verdict("unknown"), False, False, False, True),
        (truth(FRICTION), verdict("nothing_missing"), False, False, True, False),
        (truth(FRICTION, strength=1.5), verdict("nothing_missing"), False, False, False, False),
        (truth(FRICTION, strength=1.5), verdict("named", OTHER), False, False, True, False),
        (truth(FRICTION), verdict("wrong_parameter", parameters={"wrist.mass": {}}), False, False, True, False),
        (truth(expected="nothing_missing"), verdict("nothing_missing"), True, True, False, False),
        (truth(expected="nothing_missing"), verdict("named", CLAIM), False, False, True, False),
        (truth(expected="nothing_missing"), verdict("unknown"), False, False, False, True),
        (truth(FRICTION, expected="unknown"), verdict("unknown"), True, True, False, True),
        (truth(FRICTION, expected="unknown"), verdict("named", OTHER), False, False, True, False),
        (truth(FRICTION, expected="unknown"), verdict("not_trusted"), False, True, False, True),
    ],
)
def test_outcomes(
    seal: dict[str, Any], said: dict[str, Any], top: bool, in_set: bool, wrong: bool, abstained: bool
) -> None:
    found = judge(seal, said)
    assert (found.top, found.in_set, found.confidently_wrong, found.abstained) == (top, in_set, wrong, abstained)


def test_wrong_values_are_recognised_by_name() -> None:
    seal = {**truth(expected="wrong_parameter"), "parameters": ["wrist.mass"]}
    right = verdict("wrong_parameter", parameters={"wrist.mass": {}, "wrist.stiffness": {}})
    assert judge(seal, right).top
    other = judge(seal, verdict("wrong_parameter", parameters={"wrist.stiffness": {}}))
    assert not other.top
    assert other.confidently_wrong
    assert judge(seal, verdict("named", CLAIM)).confidently_wrong


def test_a_belief_that_was_drawn_far_off_may_be_called_wrong() -> None:
    seal = {**truth(expected="nothing_missing"), "parameters": ["wrist.mass"]}
    assert judge(seal, verdict("wrong_parameter", parameters={"wrist.mass": {}})).top
    assert judge(seal, verdict("nothing_missing")).top
    more = judge(seal, verdict("wrong_parameter", parameters={"wrist.mass": {}, "wrist.stiffness": {}}))
    assert more.confidently_wrong


def test_a_payload_may_be_called_so_or_a_wrong_mass() -> None:
    payload = {"effect": "payload", "where": "wrist", "mass_kg": 0.2}
    seal = {**truth(payload, expected="wrong_parameter"), "parameters": ["wrist.mass"]}
    claim = {"effect": "payload", "where": "wrist", "parameters": {}}
    assert judge(seal, verdict("wrong_parameter", parameters={"wrist.mass": {}})).top
    assert judge(seal, verdict("named", claim)).top
    assert judge(seal, verdict("ambiguous", alternatives=sets([OTHER], [claim]))).in_set
    assert judge(seal, verdict("named", OTHER)).confidently_wrong


MOVED = {"wrist.mass": {"value": 0.7, "ci95": [0.68, 0.72]}, "target.mass": {"value": 1.02, "ci95": [1.0, 1.04]}}


@pytest.mark.parametrize(
    ("said", "stated"),
    [
        (verdict("named", CLAIM, OTHER), {"coulomb_friction@wrist.force_N": (0.3, 0.29)}),  # one too many
        (verdict("named", OTHER), {}),
        (
            verdict("wrong_parameter", parameters=MOVED),
            {"wrist.mass": (0.71, 0.68), "target.mass": (1.01, 1.0)},
        ),
        (
            verdict("named", CLAIM, parameters={"wrist.unheard_of": {"value": 1.0, "ci95": [0.0, 2.0]}}),
            {"coulomb_friction@wrist.force_N": (0.3, 0.29)},
        ),
        (
            verdict(
                "ambiguous",
                alternatives=[{"effects": [CLAIM], "parameters": {"coulomb_friction@wrist.force_N": 0.31}, "score": 0}],
            ),
            {"coulomb_friction@wrist.force_N": (0.3, None)},
        ),
    ],
)
def test_whatever_is_stated_of_a_known_truth_counts(
    said: dict[str, Any], stated: dict[str, tuple[float, float | None]]
) -> None:
    seal = truth(
        FRICTION, DRAG, rig_as_built={"wrist.mass": 0.71, "target.mass": 9.0, "target.mass over believed": 1.01}
    )
    assert {p["parameter"]: (p["true"], p["low"]) for p in judge(seal, said).parameters} == stated


def test_parameters_are_read_where_the_set_is_right() -> None:
    (found,) = judge(truth(FRICTION), verdict("named", CLAIM)).parameters
    assert found == {
        "parameter": "coulomb_friction@wrist.force_N",
        "true": 0.3,
        "value": 0.31,
        "low": 0.29,
        "high": 0.33,
    }
    assert judge(truth(FRICTION), verdict("named", OTHER)).parameters == ()


def test_no_answer_is_an_abstention_that_is_not_right() -> None:
    found = judge(truth(FRICTION), None)
    assert found.abstained
    assert not found.top
    assert found.said == "failed"


def test_a_band_is_judged_by_the_true_force_with_what_it_trades_with() -> None:
    numbers = {"coefficient_Ns_m": 10.0, "way": 1.0, "soft_m_s": 1e-6}
    truth = {
        "effects": [{"effect": "valve", "where": "wrist", **numbers}],
        "rig_as_built": {"wrist.damping": 3.0},
    }
    x = np.linspace(-0.1, 0.1, 11)
    total = 3.0 * x + 10.0 * np.maximum(x, 0.0)
    table = {"variable": "v", "x": list(x), "total_with": ["wrist.damping"]}

    def said(off: float, kind: str = "force") -> dict[str, Any]:
        band = {"low": list(total + off - 0.01), "high": list(total + off + 0.01)}
        return {"verdict": "learned", "learned": [{"where": "wrist", "kind": kind, "table": {**table, **band}}]}

    assert band_share(truth, said(0.0)) == 1.0
    assert band_share(truth, said(0.1)) == 0.0
    assert band_share(truth, said(0.0, "friction")) is None
    assert band_share(truth, {"verdict": "unknown"}) is None


def test_a_law_learned_elsewhere_is_wrong_and_one_at_its_port_right() -> None:
    truth = {"effects": [{"effect": "worn", "where": "wrist"}], "expected": "learned", "strength": 9.0}

    def at(where: str) -> Any:
        effects = [{"effect": "learned_law", "where": where, "parameters": {}}]
        verdict = {"verdict": "learned", "confidence": 0.9, "effects": effects, "learned": [{"where": where}]}
        return judge({**truth, "parameters": [], "withheld": None}, verdict)

    assert at("wrist").top
    assert not at("wrist").confidently_wrong
    assert not at("target").top
    assert at("target").confidently_wrong
