"""Same input, same bytes: in another process, with other hash seeds, more workers and threads of linear algebra, a
diagnosis writes the same.

So it does with another --seed, but for the seed itself.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers_balls import balls

from spacerobot.cli.main import main
from spacerobot.effects.registry import all_effects
from tests.diagnosis.rigs import write_study

SECONDS = re.compile(rb'"seconds": [\d.]+|<dd>[\d.]+ s</dd>')
"""What a run took: the one thing that may differ, in verdict.json and on the page."""


def written(study: Path, out: Path, seed: str, jobs: str, *options: str) -> dict[str, bytes]:
    """Verdict and page of one diagnosis, without what it took."""
    command = [sys.executable, "-m", "spacerobot", "diagnose", str(study), "--out", str(out), "--jobs", jobs, *options]
    done = subprocess.run(
        command,
        env={**os.environ, "PYTHONHASHSEED": seed, "OPENBLAS_NUM_THREADS": jobs},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode()
    return {name: SECONDS.sub(b"", (out / name).read_bytes()) for name in ("verdict.json", "report.html")}


def rig(folder: Path) -> None:
    write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.3})])


def bodies(folder: Path) -> None:
    balls(folder, {"light": (0.05, 0.003), "heavy": (8.0, 0.003)})


@pytest.mark.parametrize(
    "made", [pytest.param(bodies, marks=pytest.mark.slow), pytest.param(rig, marks=pytest.mark.slow)]
)
def test_two_processes_write_the_same(tmp_path: Path, made: Callable[[Path], None]) -> None:
    study = tmp_path / "study"
    study.mkdir()
    made(study)
    one = written(study, tmp_path / "one", "1", "1")
    assert written(study, tmp_path / "two", "2", "2") == one


def test_nothing_but_what_a_run_took_is_left_out() -> None:
    assert SECONDS.sub(b"", b'"seconds": 1.25,\n"score": 1.25') == b',\n"score": 1.25'


KEPT = ("coulomb_friction", "quadratic_drag", "payload")
"""Enough of the catalogue for a search and a judgement, of a ball and of a wrist."""

SMALL = [x for name in all_effects() if name not in KEPT for x in ("--without", name)]


def small_rig(folder: Path) -> None:
    write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.3})], masses=(9.0,))


@pytest.mark.parametrize(
    ("made", "seeds", "options"),
    [
        (bodies, (0, 123456789), SMALL),
        pytest.param(small_rig, (0, 123456789), SMALL, marks=pytest.mark.slow),
        pytest.param(rig, (0, 7, 123456789), [], marks=pytest.mark.slow),
    ],
)
def test_no_answer_hangs_on_a_seed(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    made: Callable[[Path], None],
    seeds: Sequence[int],
    options: Sequence[str],
) -> None:
    """Nor on luck that two seeds lead to one answer: whatever is drawn, is drawn from the same ones."""
    made(tmp_path)
    found, whole = [], np.random.default_rng
    drawn: list[set[str]] = []

    def drawing(*seed: Any) -> np.random.Generator:
        drawn[-1].add(repr(seed))
        return whole(*seed)

    monkeypatch.setattr(np.random, "default_rng", drawing)
    for seed in seeds:
        drawn.append(set())
        assert main(["diagnose", str(tmp_path), "--json", "--jobs", "1", "--seed", str(seed), *options]) == 0
        verdict = json.loads(capsys.readouterr().out)
        assert verdict.pop("seed") == seed
        del verdict["seconds"]
        found.append(verdict)
    assert all(one == found[0] for one in found[1:])
    assert drawn[0]
    assert all(one <= drawn[0] for one in drawn[1:])
