"""A filter of higher order, where a plain one and a late reading have done for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.forms import formed
from spacerobot.diagnosis.selection.search_state import Found, silent
from spacerobot.effects.registry import effect
from tests.diagnosis.rigs import write_study

SENSOR = "force_sensor"
TRUTH = "low_pass~2_butterworth"


@pytest.mark.parametrize("late", [SENSOR, "mocap"])
def test_it_takes_the_place_of_both_whichever_stream_is_called_late(tmp_path: Path, late: str) -> None:
    """What makes the camera early makes the force late: both stand at the force's place."""
    study = write_study(tmp_path, planted=[(TRUTH, SENSOR, {"cutoff_Hz": 160.0})], masses=(9.0,), speeds=(0.06, 0.11))
    shop = Workshop(study)
    sites = [shop.model.site(effect(name), at) for name, at in (("low_pass", SENSOR), ("time_offset", late))]
    pair = tuple(sorted(s.label for s in sites))
    begun = {f"low_pass@{SENSOR}.cutoff_Hz": 260.0, f"time_offset@{late}.delay_s": 7e-4 if late == SENSOR else -7e-4}
    base, first = shop.run(Task((), {})), shop.run(Task(pair, begun, max_iterations=30))
    assert base is not None
    assert first is not None
    with Pool(shop, 1) as pool:
        found = Found(base, singles=tuple(sites))
        found.keep(first)
        assert found.explained
        formed(pool, found, silent)
    assert found.best.hypothesis.label == ((TRUTH, SENSOR),)
    assert found.best.cost < first.cost
