"""The labelled campaigns of an independent program: each gets its true verdict. Minutes: in `make test-long`."""

from __future__ import annotations

import functools
import json
import math
from typing import Any

import pytest

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.selection.unseen import frozen
from spacerobot.recordings.study import load_study
from tests.overlay.studies import DATA

NAMES = sorted(p.parent.name for p in DATA.glob("*/truth.json"))
WIDER = 3.290526731 / 1.959963985  # from 95 % to 99.9 %

pytestmark = [
    pytest.mark.slow,
    pytest.mark.campaigns,
    pytest.mark.skipif(not NAMES, reason="the campaigns are not here (SPACEROBOT_DATA)"),
]


@functools.cache
def found(name: str) -> Diagnosis:
    return diagnose(load_study(DATA / name))


def truth(name: str) -> dict[str, Any]:
    return json.loads((DATA / name / "truth.json").read_text())


def compared(name: str) -> list[tuple[str, float, float, float, float]]:
    """(parameter, truth, value, low, high) of every parameter that the truth states."""
    stated = {(e["effect"], e["where"]): e for e in truth(name)["effects"]}
    out = []
    for entry in found(name).verdict["effects"]:
        true = stated[entry["effect"], entry["where"]]
        for parameter, p in entry["parameters"].items():
            if parameter in true:
                out.append((parameter, true[parameter], p["value"], *p["ci95"]))
    return out


@pytest.mark.parametrize("name", NAMES)
def test_the_true_verdict(name: str) -> None:
    verdict = found(name).verdict
    true = {(e["effect"], e["where"]) for e in truth(name)["effects"]}
    assert verdict["verdict"] == ("named" if true else "nothing_missing")
    assert {(e["effect"], e["where"]) for e in verdict["effects"]} == true


@pytest.mark.parametrize("name", NAMES)
def test_parameters_are_near_the_truth(name: str) -> None:
    for parameter, true, value, low, high in compared(name):
        error = (high - low) / (2.0 * 1.96)
        assert abs(value - true) <= max(0.1 * abs(true), 2.5 * error), parameter


def test_intervals_hold_what_they_promise() -> None:
    rows = [row for name in NAMES for row in compared(name)]
    inside = sum(low <= true <= high for _, true, _, low, high in rows)
    assert inside >= math.ceil(14 / 17 * len(rows))
    for parameter, true, value, low, high in rows:
        assert value - WIDER * (value - low) <= true <= value + WIDER * (high - value), parameter


@pytest.mark.parametrize("name", NAMES)
def test_the_fit_costs_no_more_than_the_truth_does(name: str) -> None:
    said = found(name)
    assert said.judgement is not None
    chosen = said.judgement.chosen
    workshop = Workshop(load_study(DATA / name))
    built, values = truth(name)["rig_as_built"], chosen.values()
    for key in chosen.hypothesis.keys:
        if key == "target.mass":
            index = chosen.hypothesis.keys.index(key)
            values[key] = chosen.hypothesis.free[index].centre * built["target.mass over believed"]
        elif key == "wrist.equivalent_damping":
            believed = workshop.study.values()
            values[key] = built["wrist.damping + equivalent_damping"] - believed.get("wrist.damping", 0.0)
        elif key in built:
            values[key] = built[key]
    for effect in truth(name)["effects"]:
        prefix = f"{effect['effect']}@{effect['where']}."
        values.update({prefix + k: v for k, v in effect.items() if prefix + k in values})
    own = tuple(f.key for f in chosen.hypothesis.free if f.kind == "scatter")
    pinned = frozen(chosen.hypothesis, values, own)
    at_truth = workshop.fitter().fit(pinned, warm=values, initials=chosen.initials(), robust=False)
    prior = sum(
        z * z for f, z in zip(chosen.hypothesis.free, chosen.hypothesis.start(values)) if f.prior and f.key not in own
    )
    assert chosen.cost <= at_truth.cost + float(prior) + 1.0
