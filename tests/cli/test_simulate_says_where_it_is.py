"""The first simulation after an installation compiles for minutes: whoever waits is told so."""

from __future__ import annotations

from typing import Any

import pytest

from spacerobot.cli import simulate_run
from spacerobot.cli.main import main
from spacerobot.support.progress import Progress


@pytest.mark.parametrize(("first", "said"), [(True, "compiling, once after an installation"), (False, "simulating")])
def test_a_simulation_says_whether_it_compiles(first: bool, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[str] = []

    class Told(Progress):
        def __init__(self, what: str, *rest: Any, **options: Any) -> None:
            begun.append(what)
            super().__init__(what, *rest, **options)

    monkeypatch.setattr(simulate_run, "Progress", Told)
    monkeypatch.setattr(simulate_run, "nothing_kept", lambda: first)
    assert main(["simulate", "pa10_wrist", "--wrist-stiffness", "530", "--target-mass", "9", "--speed", "0.07"]) == 0
    assert len(begun) == 1
    assert begun[0].startswith(said)
