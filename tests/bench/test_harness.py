"""The benchmark harness: what it measures, what it writes, and that a wrong engine would be seen."""

from __future__ import annotations

import json
import math
import os
import time
from pathlib import Path

import numpy as np
import pytest

from benchmarks import collision, diagnosis_page, run, timing
from benchmarks.engines.meeting import SCENES, Outcome, read

ROOT = Path(__file__).resolve().parents[2]


def busy(seconds: float) -> None:
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def test_costs_are_those_of_the_processor() -> None:
    found = timing.costs({"one": lambda: busy(0.002), "two": lambda: busy(0.004)}, repeats=5, least=0.01)
    assert found["two"].median / found["one"].median == pytest.approx(2.0, rel=0.2)
    assert found["one"].low <= found["one"].median <= found["one"].high
    idle = timing.costs({"sleep": lambda: time.sleep(0.02)}, repeats=3, least=1e-4)
    assert idle["sleep"].median < 0.01


def test_a_small_run_writes_numbers_and_page(tmp_path: Path) -> None:
    cores = os.sched_getaffinity(0)
    try:
        names = ["right_hand_side", "effective_mass"]
        assert run.main([*names, "--quick", "--results", str(tmp_path), "--page", str(tmp_path / "page.md")]) == 0
        assert len(os.sched_getaffinity(0)) == 1
    finally:
        os.sched_setaffinity(0, cores)
    text = (tmp_path / "page.md").read_text()
    assert "## One multibody right-hand side" in text
    assert "A quick run: its numbers say little." in text
    about = json.loads((tmp_path / "effective_mass.json").read_text())
    assert about["versions"]["numpy"] == np.__version__
    assert all(0.1 < row["ratio"] < 100.0 for row in about["found"]["rows"])


def test_quartiles_stand_beside_the_median_where_they_differ() -> None:
    assert timing.with_quartiles(vars(timing.spread([1.0, 2.0, 3.0])), 1e3) == "2e+03 (1.5e+03 to 2.5e+03)"
    assert timing.with_quartiles({"median": 0.25}) == "0.25"


def test_several_cores_are_lent_and_given_back() -> None:
    cores = os.sched_getaffinity(0)
    try:
        timing.pin_to_one_core()
        with timing.all_cores() as available:
            assert available == len(os.sched_getaffinity(0)) >= len(cores)
        assert len(os.sched_getaffinity(0)) == 1
    finally:
        os.sched_setaffinity(0, cores)


def test_growth_is_the_exponent() -> None:
    size = [3.0, 6.0, 12.0]
    assert diagnosis_page.exponent(size, [0.1 * s**1.5 for s in size]) == pytest.approx(1.5)
    assert math.isnan(diagnosis_page.exponent([1.0], [1.0]))


def test_an_unknown_benchmark_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run.main(["speed"])
    assert "no such benchmark: speed" in capsys.readouterr().err


def test_the_page_is_that_of_the_results() -> None:
    pytest.importorskip("pyarrow", reason="extra 'scale' is not installed")
    assert (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8") == run.page(ROOT / "benchmarks" / "results")
    for path in (ROOT / "benchmarks" / "results").glob("*.json"):
        assert json.loads(path.read_text())["quick"] is False, path.name


def test_the_last_separation_is_read_between_the_samples() -> None:
    scene = SCENES["ground arm, held"]
    time_, end = np.linspace(0.0, 0.6, 601), 0.38765
    found = read(scene, time_, 1e-3 * np.sin(math.pi * time_ / end), -0.05)
    assert found.contact_time == pytest.approx(end, abs=1e-8)
    assert found.restitution == pytest.approx(0.05 / 0.07)
    assert math.isnan(read(scene, time_, np.full(601, 1e-3), -0.05).contact_time)


def test_the_fastest_way_to_a_level() -> None:
    rows = [
        {"engine": "A slow", "setting": "1", "error": 1e-7, "seconds": 3.0},
        {"engine": "A fast", "setting": "2", "error": 1e-5, "seconds": 1.0},
        {"engine": "B lost", "setting": "3", "error": None, "seconds": 0.1},
    ]
    assert collision.best(rows, 1e-4)["A"]["seconds"] == 1.0
    assert collision.best(rows, 1e-6)["A"]["seconds"] == 3.0
    assert "B" not in collision.best(rows, 1.0)


@pytest.mark.parametrize("name", list(SCENES))
def test_another_engine_converges_to_our_reference(name: str) -> None:
    pytest.importorskip("mujoco")
    from benchmarks.engines import by_mujoco, ours

    reference = ours.reference(name)
    errors = []
    for step in (1e-3, 1e-4):
        found = by_mujoco.collide(SCENES[name], *by_mujoco.model_of(SCENES[name], "tendon", "RK4", step))
        errors.append(found.error(reference))
    assert errors[0] < 1e-2
    assert errors[1] < 2e-4
    stiffer = Outcome(reference.restitution * 1.001, reference.contact_time)
    assert found.error(stiffer) > 5e-4
