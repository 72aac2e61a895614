"""The preferred set is fitted again from either side of what goes by factors, and a deeper minimum is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from spacerobot.diagnosis import minima
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.found import Found
from spacerobot.diagnosis.pool import Pool
from spacerobot.diagnosis.workshop import Task, Workshop
from tests.diagnosis.rigs import write_study

LABEL = (("low_pass", "force_sensor"),)
KEY = "low_pass@force_sensor.cutoff_Hz"


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("minima")
    return Workshop(write_study(folder, planted=[("low_pass", "force_sensor", {"cutoff_Hz": 90.0})]))


def test_a_deeper_minimum_beside_the_first_is_found(shop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    base, right = shop.run(Task((), {})), shop.run(Task(LABEL, {KEY: 90.0}))
    assert base is not None
    assert right is not None
    shallow = replace(right, chi2=right.chi2 + 40.0, z=_at(right, 120.0))
    found = Found(base)
    found.keep(shallow)
    begun: list[list[float]] = []

    def run_tasks(pool: Pool, found: Found, tasks: Sequence[Task], *rest: Any) -> list[Task]:
        begun.append([t.start[KEY] for t in tasks])
        for task in tasks:
            found.keep(shop.run(task))
        return []

    monkeypatch.setattr(minima, "run_tasks", run_tasks)
    minima.other_minima(cast(Pool, None), found, lambda *a: None)
    best = found.fits[LABEL]
    assert best.cost < right.cost + 0.5
    assert best.values()[KEY] == pytest.approx(90.0, rel=0.05)
    wide, close = ([b * v for b in by] for by, v in zip(minima.FACTORS, (120.0, best.values()[KEY]), strict=True))
    assert begun == [pytest.approx(wide), pytest.approx(close, rel=1e-2)]


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
