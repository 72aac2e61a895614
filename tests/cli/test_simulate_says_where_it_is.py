"""The first simulation after an installation compiles for minutes: whoever waits is told so."""

from __future__ import annotations

from typing import Any

import pytest

from spacerobot.cli import simulate_run
from spacerobot.cli.main import main
from spacerobot.support import progress
from spacerobot.support.jit import numba
from spacerobot.support.progress import Progress


def test_a_simulation_tells_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[str] = []

    class Told(Progress):
        def __init__(self, what: str, *rest: Any, **options: Any) -> None:
            begun.append(what)
            super().__init__(what, *rest, **options)

    monkeypatch.setattr(simulate_run, "Progress", Told)
    assert main(["simulate", "pa10_wrist", "--wrist-stiffness", "530", "--target-mass", "9", "--speed", "0.07"]) == 0
    assert begun == ["simulating"]


def test_whatever_waits_for_a_compiler_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    work = Progress("simulating", 1, unit="scene", quiet=True)
    told = progress.compiling

    def listened(more: int) -> None:
        told(more)
        said.append(work.line())

    monkeypatch.setattr("spacerobot.support.jit.compiling", listened)
    numba().njit(lambda x: x + 1)(1.0)  # kept nowhere, so compiled now
    assert said[0].endswith("s (compiling, once after an installation)")
    assert said[-1] == work.line()
    assert "compiling" not in work.line()
