"""The preferred set moves on to deeper minima along what goes by factors, and along moments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import restarts as minima
from spacerobot.diagnosis.selection.search_state import Found
from tests.diagnosis.rigs import write_study

LABEL = (("low_pass", "force_sensor"),)
KEY = "low_pass@force_sensor.cutoff_Hz"


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("minima")
    return Workshop(write_study(folder, planted=[("low_pass", "force_sensor", {"cutoff_Hz": 90.0})]))


def test_a_deeper_minimum_along_what_goes_by_factors_is_found(shop: Workshop) -> None:
    base, right = shop.run(Task((), {})), shop.run(Task(LABEL, {KEY: 90.0}))
    assert base is not None
    assert right is not None
    shallow = replace(right, chi2=right.chi2 + 40.0, z=_at(right, 160.0))
    found = Found(base)
    found.keep(shallow)
    minima.other_minima(Pool(shop, 1), found, lambda *a: None)
    best = found.fits[LABEL]
    assert best.cost < right.cost + 0.5
    assert best.values()[KEY] == pytest.approx(90.0, rel=0.05)


def test_nothing_is_fitted_again_where_nothing_is_missing(shop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    base = shop.run(Task((), {}))
    assert base is not None
    monkeypatch.setattr(minima, "run_tasks", lambda *a: pytest.fail("fitted again"))
    minima.other_minima(cast(Pool, None), Found(base), lambda *a: None)
    idle = Found(base)
    other = shop.run(Task((("preload", "wrist"),), {}, max_iterations=1))
    assert other is not None
    idle.keep(replace(other, chi2=base.chi2 - 1.0, prior=base.prior))
    minima.other_minima(cast(Pool, None), idle, lambda *a: None)


def _at(fit: Fit, cutoff: float) -> Any:
    k = fit.hypothesis.keys.index(KEY)
    z = fit.z.copy()
    z[k] = fit.hypothesis.free[k].z(cutoff)
    return z


@pytest.mark.slow
def test_a_moment_is_looked_for_before_and_after_although_only_noise_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    label, when = (("external_impulse", "target"),), "external_impulse@target.time_s"
    planted = [(*label[0], {"impulse_Ns": -0.1, "time_s": 0.5})]
    own = Workshop(write_study(tmp_path, planted=planted))
    base = own.run(Task((), {}))
    right = own.run(Task(label, {"external_impulse@target.impulse_Ns": -0.1, when: 0.5}))
    assert base is not None
    assert right is not None
    z = right.z.copy()
    index = right.hypothesis.keys.index(when)
    z[index] = right.hypothesis.free[index].z(0.52)
    found = Found(base)
    found.keep(replace(right, chi2=right.chi2 + 40.0, z=z))
    assert found.explained  # forty in some thousands: no test of what is left shows it
    begun: list[list[float]] = []

    def run_tasks(pool: Pool, found: Found, tasks: Sequence[Task], *rest: Any) -> list[Task]:
        begun.extend([[t.start[when] for t in tasks]] if tasks else [])
        for task in tasks:
            found.keep(own.run(task))
        return []

    monkeypatch.setattr(minima, "run_tasks", run_tasks)
    minima.other_minima(cast(Pool, None), found, lambda *a: None)
    first, close = begun
    assert sorted(first) == pytest.approx([0.49, 0.505, 0.535, 0.55])  # 0.3 and 0.6 of the moment's scale, 0.05 s
    assert found.fits[label].values()[when] == pytest.approx(0.5, abs=2e-3)
    assert found.fits[label].cost < right.cost + 0.5
    assert max(abs(b - 0.5) for b in close) < 0.02
