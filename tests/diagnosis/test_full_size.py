"""Scores at full size: what hardly shows while it is faint is seen at the size that it has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.screen import Screener
from spacerobot.diagnosis.fitting.starts import full_starts, sized
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.registry import all_effects, effect
from tests.diagnosis.rigs import write_study

SLACK_LINE = ("tether", "target", {"stiffness_N_m": 8.0, "slack_m": 0.02})


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(write_study(tmp_path_factory.mktemp("held"), planted=[SLACK_LINE]))


def test_a_slack_line_is_promised_about_what_it_earns(held: Workshop) -> None:
    base = held.run(Task((), {}))
    assert base is not None
    sites = [Site(effect("tether"), "target"), Site(effect("cubic_stiffness"), "wrist")]
    screener = Screener(held.fitter(), held.model.believed)
    full = screener.screen_full(base, sites)
    assert full.scored[0].site.label == ("tether", "target")
    fit = held.run(Task((("tether", "target"),), full.scored[0].start, near=base, max_iterations=30))
    assert fit is not None
    earned = base.cost - fit.cost
    assert earned > 300.0
    assert 0.2 * earned < full.scored[0].gain < 1.2 * earned
    assert fit.values()["tether@target.stiffness_N_m"] == pytest.approx(8.0, rel=0.2)


def test_no_size_helps_where_nothing_is_missing(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path))
    base = workshop.run(Task((), {}))
    assert base is not None
    sites = [Site(effect("tether"), "target"), Site(effect("coulomb_friction"), "wrist")]
    full = Screener(workshop.fitter(), workshop.model.believed).screen_full(base, sites)
    assert all(s.gain < 15.0 for s in full.scored)


def test_starts_are_of_every_way_to_act_and_of_several_sizes(held: Workshop) -> None:
    starts = full_starts(Site(effect("tether"), "target"), held.trials)
    slacks = {s["tether@target.slack_m"] for s in starts}
    sizes = {s["tether@target.stiffness_N_m"] for s in starts}
    assert slacks == set(effect("tether").parameters[1].starts)
    assert len(starts) == len(slacks) * len(sizes)
    assert max(sizes) / min(sizes) > 50.0
    assert np.diff(np.log(sorted(sizes))).max() < np.log(3.0)  # no gap that a fit would not cross


def test_a_knock_is_tried_all_over_the_trial_and_both_ways(held: Workshop) -> None:
    starts = full_starts(Site(effect("external_impulse"), "target"), held.trials)
    times = {s["external_impulse@target.time_s"] for s in starts}
    assert len(times) > 8
    assert {np.sign(s["external_impulse@target.impulse_Ns"]) for s in starts} == {-1.0, 1.0}


def test_all_starts_are_within_bounds(held: Workshop) -> None:
    for kind in all_effects().values():
        site = Site(kind, "target")
        for start in full_starts(site, held.trials):
            for p in kind.parameters:
                assert p.lower <= start[site.key(p.name)] <= p.upper, (kind.name, p.name)


def test_a_size_is_a_share_of_the_distance_from_nothing() -> None:
    scale, slow = Site(effect("scale"), "mocap"), Site(effect("low_pass"), "mocap")
    assert sized(scale, {"scale@mocap.factor": 1.02}, 0.5) == {"scale@mocap.factor": pytest.approx(1.01)}
    assert sized(slow, {"low_pass@mocap.cutoff_Hz": 30.0}, 0.5) == {"low_pass@mocap.cutoff_Hz": 60.0}
