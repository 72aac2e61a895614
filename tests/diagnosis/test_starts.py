"""Where fits begin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.hypothesis import Site
from spacerobot.diagnosis.screen import Screener
from spacerobot.diagnosis.starts import effect_starts, informed_starts, moments
from spacerobot.diagnosis.workshop import Task, Workshop
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


def test_a_knock_is_looked_for_all_over_the_trials_and_screened_best_where_it_was(tmp_path: Path) -> None:
    planted = [("external_impulse", "target", {"impulse_Ns": 0.05, "time_s": 1.1})]
    workshop = Workshop(write_study(tmp_path, planted=planted, masses=(9.0,)))
    site = Site(effect("external_impulse"), "target")
    times = [s["external_impulse@target.time_s"] for s in moments(site, workshop.trials)]
    gaps = np.diff(times)
    assert np.allclose(gaps, gaps[0])
    assert min(t.start for t in workshop.trials) < times[0] <= times[0] + 23 * gaps[0]
    assert times[-1] < max(t.end for t in workshop.trials)
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    screen = Screener(workshop.fitter(), workshop.model.believed).screen(baseline, [site])
    assert screen.scored[0].start["external_impulse@target.time_s"] == pytest.approx(1.1, abs=1.5 * gaps[0])


def test_what_has_no_moment_has_no_such_starts(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    assert moments(Site(effect("tether"), "target"), workshop.trials) == []
    assert moments(Site(effect("external_impulse"), "target"), ()) == []
