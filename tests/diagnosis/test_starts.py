"""Where fits begin."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.screen import Screener
from spacerobot.diagnosis.fitting.starts import effect_starts, informed_starts, moments
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import pairs
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.registry import effect
from tests.diagnosis.rigs import write_study


def test_a_stop_is_looked_for_where_the_wrist_turns_back(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    site = Site(effect("end_stop"), "wrist")
    deepest = max(float(np.abs(t.channel("wrist.x")[1]).max()) for t in workshop.trials)
    soft, hard = informed_starts(site, workshop.trials)
    for start in (soft, hard):
        assert start["end_stop@wrist.travel_m"] == pytest.approx(deepest, rel=0.02)
        assert start["end_stop@wrist.travel_m"] < deepest
        assert set(start) == set(effect_starts([site])[0])
    assert soft["end_stop@wrist.stiffness_N_m"] < hard["end_stop@wrist.stiffness_N_m"]


def test_a_slider_travels_against_the_hand_that_carries_it(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    site = Site(effect("end_stop"), "wrist")
    plain = informed_starts(site, workshop.trials)[0]["end_stop@wrist.travel_m"]
    moving = []
    for trial in workshop.trials:
        blocks = []
        for block in trial.blocks:
            if "wrist.x" not in block.channels:
                blocks.append(block)
                continue
            k = block.channels.index("wrist.x")
            value = np.vstack([block.value, 0.4 * block.value[k]])  # the hand gives way by two fifths
            weight = np.vstack([block.weight, block.weight[k]])
            blocks.append(replace(block, channels=(*block.channels, "hand.x"), value=value, weight=weight))
        moving.append(replace(trial, blocks=tuple(blocks)))
    assert informed_starts(site, moving)[0]["end_stop@wrist.travel_m"] == pytest.approx(0.6 * plain)


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


def test_a_special_case_begins_where_the_general_effect_ended(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,)))
    label = (("preload", "wrist"), ("stribeck_friction", "wrist"))
    start = {"preload@wrist.force_N": 0.3, "stribeck_friction@wrist.static_force_N": 0.2}
    general = workshop.run(Task(label, start, max_iterations=1))
    assert general is not None
    values = general.values()
    sites = [Site(effect("coulomb_friction"), "wrist"), Site(effect("preload"), "wrist")]
    found = [s["coulomb_friction@wrist.force_N"] for s in pairs._inherited(sites, general)]
    assert found == [values[f"stribeck_friction@wrist.{n}_force_N"] for n in ("static", "coulomb")]
    assert pairs._inherited([Site(effect("preload"), "wrist")], general) == []
