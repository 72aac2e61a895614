"""Progress goes to standard error, and only where somebody watches."""

from __future__ import annotations

import signal
import time

import pytest

from spacerobot.support import progress
from spacerobot.support.progress import Progress, say


def test_silent_where_nobody_watches(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress("fitting", 3) as bar:
        bar.advance(2, "coulomb_friction")
        bar.add(1)
    assert capsys.readouterr() == ("", "")


def test_verbose_shows_the_count_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress("fitting", 3, verbose=True) as bar:
        bar.advance(3)
        bar.add(2)
        assert bar.done == 3
    say("done")
    out, err = capsys.readouterr()
    assert out == ""
    assert "fitting" in err
    assert "3/5" in err
    assert err.endswith("done\n")


def test_a_pipe_is_told_where_long_work_is(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Every so many seconds, over several short stages too; what was there before is there again."""
    monkeypatch.setattr(progress, "SILENT", 0.2)
    before = signal.getsignal(signal.SIGALRM)
    for what in ("fitting", "drawing", "writing"):
        with Progress(what, 10, unit="step") as bar:
            bar.advance(4)
            time.sleep(0.15)
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert 1 <= len(lines) <= 3
    assert lines[0].startswith("drawing: 4 of 10 steps")
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0


def test_somebody_else_s_alarm_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "SILENT", 0.05)
    rung: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda *_: rung.append(1))
    try:
        with Progress("fitting", 3):
            time.sleep(0.12)
        assert not rung
    finally:
        signal.signal(signal.SIGALRM, before)
