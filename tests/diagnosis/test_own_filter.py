"""A sensor's own filter: stated, it acts as the effect does; near half of the rate it is no missing physics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.own_filter import own_filters, told, with_filters
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import effect
from spacerobot.recordings.sensor_filter import SensorFilter
from spacerobot.recordings.synthetic import SAMPLER
from spacerobot.simulation.parts import EffectAt
from tests.diagnosis.rigs import write_study

BOTH_WAYS = "low_pass~2_zero_phase"
SENSOR = "force_sensor"
CUTOFF = f"{BOTH_WAYS}@{SENSOR}.cutoff_Hz"


HARD = {"contact.stiffness": 4e5}
TRUTH = {**HARD, "contact.damping": 200.0}
"""A contact that rings at 125 Hz, so that a filter at some 450 Hz shows."""


def planted(cutoff: float, name: str = BOTH_WAYS) -> list[tuple[str, str, dict[str, float]]]:
    return [(name, SENSOR, {"cutoff_Hz": cutoff})]


@pytest.mark.parametrize("form", ["1_butterworth", "2_bessel", "4_butterworth", "2_zero_phase"])
def test_a_stated_filter_acts_as_the_effect_does(tmp_path: Path, form: str) -> None:
    order, kind = form.split("_", 1)
    plain = write_study(tmp_path, masses=(9.0,), speeds=(0.1,))
    shop = Workshop(plain)
    stated = Workshop(plain.with_filter("contact.force", SensorFilter(150.0, int(order), kind)))
    (trial,) = shop.trials
    start = np.array([n.guess for n in shop.model.nuisances(trial)])
    law = effect("low_pass" if order == "1" else f"low_pass~{form}")
    effective = law.apply(shop.model.plain(), SENSOR, {"cutoff_Hz": 150.0})
    for own, other in zip(
        stated.model.predict(stated.model.plain(), trial, start).blocks,
        shop.model.predict(effective, trial, start).blocks,
        strict=True,
    ):
        np.testing.assert_allclose(own, other, rtol=0.0, atol=1e-12)
    unfiltered = shop.model.predict(shop.model.plain(), trial, start).blocks
    assert np.abs(unfiltered[1] - other).max() > 1.0


def test_the_mended_scene_has_it(tmp_path: Path) -> None:
    study = write_study(tmp_path, masses=(9.0,), speeds=(0.1, 0.11)).with_filter(
        "contact.force", SensorFilter(150.0, 2, "bessel")
    )
    shop = Workshop(study)
    fit = shop.fitter().fit(hypothesis(shop.model.believed, []), max_iterations=2)
    assert scene_of(study, shop.model, fit).effects == (
        EffectAt("low_pass", SENSOR, {"cutoff_Hz": 150.0, "order": 2, "kind": "bessel"}),
    )


@pytest.mark.parametrize(
    ("name", "share", "own"),
    [(BOTH_WAYS, 0.95, True), (BOTH_WAYS, 0.5, False), ("low_pass", 0.95, False), ("low_pass~2_bessel", 0.95, False)],
)
def test_only_one_without_delay_near_half_of_the_rate_is_the_sensors_own(name: str, share: float, own: bool) -> None:
    """A late reading is missing physics, and so is what ends far below."""
    values = {"cutoff_Hz": share * 0.5 * SAMPLER}
    assert effect(name).innate(values, SAMPLER) is own
    assert not effect("time_offset").innate({"delay_s": 0.0}, SAMPLER)


def test_taken_as_stated_it_leaves_what_its_fit_leaves(tmp_path: Path) -> None:
    study = write_study(tmp_path, planted=planted(0.45 * SAMPLER), truth=TRUTH, believed=HARD)
    shop = Workshop(study)
    base = shop.fitter().fit(hypothesis(shop.model.believed, []))
    fit = shop.run(Task(((BOTH_WAYS, SENSOR),), {CUTOFF: 0.45 * SAMPLER}, near=base))
    assert fit is not None
    own = own_filters(shop, fit)
    assert own == {"contact.force": SensorFilter(pytest.approx(fit.values()[CUTOFF]), 2, "zero_phase")}
    beside = with_filters(shop, own)
    again = beside.fitter().fit(hypothesis(beside.model.believed, []))
    assert again.chi2 < base.chi2 - 20.0
    assert again.chi2 == pytest.approx(fit.chi2, abs=1.0)
    assert own_filters(beside, fit) == {}  # what is stated already is no longer looked for
    assert told(study, shop) == []
    (said,) = told(study, beside)
    assert "not as missing physics" in said


@pytest.mark.slow
def test_where_nothing_else_is_hidden_nothing_is_missing(tmp_path: Path) -> None:
    found = diagnose(write_study(tmp_path, planted=planted(0.45 * SAMPLER), truth=TRUTH, believed=HARD), jobs=1)
    assert found.verdict["verdict"] == "nothing_missing"
    assert any("own filter" in line for line in found.verdict["why"])


@pytest.mark.slow
def test_one_that_ends_far_below_is_named(tmp_path: Path) -> None:
    found = diagnose(write_study(tmp_path, planted=planted(0.15 * SAMPLER), truth=TRUTH, believed=HARD), jobs=1)
    assert found.verdict["verdict"] == "named"
    assert [(e["effect"], e["where"]) for e in found.verdict["effects"]] == [("low_pass", SENSOR)]


@pytest.mark.slow
def test_a_late_track_may_be_late_by_its_filter(tmp_path: Path) -> None:
    """Of the fourth order, well above all that moves, a filter delays and does no more: either may be there."""
    late = [("low_pass~4_butterworth", "mocap", {"cutoff_Hz": 43.0})]
    found = diagnose(write_study(tmp_path, planted=late), jobs=1)
    assert found.verdict["verdict"] == "ambiguous"
    said = {(e["effect"], e["where"]) for a in found.verdict["alternatives"] for e in a["effects"]}
    assert {("time_offset", "mocap"), ("low_pass", "mocap")} <= said
