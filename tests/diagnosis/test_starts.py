"""Where fits begin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.hypothesis import Site
from spacerobot.diagnosis.starts import effect_starts, informed_starts
from spacerobot.diagnosis.workshop import Workshop
from spacerobot.effects.registry import effect
from tests.diagnosis.rigs import write_study


def test_a_stop_is_looked_for_where_the_wrist_turns_back(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    site = Site(effect("end_stop"), "wrist")
    deepest = max(float(np.abs(t.channel("wrist.x")[1]).max()) for t in workshop.trials)
    (start,) = informed_starts(site, workshop.trials)
    assert start["end_stop@wrist.travel_m"] == pytest.approx(deepest, rel=0.02)
    assert start["end_stop@wrist.travel_m"] < deepest
    assert set(start) == set(effect_starts([site])[0])


def test_what_is_no_displacement_has_no_such_start(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    assert informed_starts(Site(effect("coulomb_friction"), "wrist"), workshop.trials) == []
    assert informed_starts(Site(effect("end_stop"), "joint.1"), workshop.trials) == []
