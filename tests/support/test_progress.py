"""Progress goes to standard error, and only where somebody watches."""

from __future__ import annotations

import signal
import time

import pytest

from spacerobot.support import progress
from spacerobot.support.progress import Progress, plural, say
from tests.processes import eventually


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
    """Of the innermost work, as often as the alarm rings; what was there before is there again."""
    monkeypatch.setattr(progress, "SILENT", 0.05)
    before = signal.getsignal(signal.SIGALRM)
    said = ""

    def told() -> bool:
        nonlocal said
        out, err = capsys.readouterr()
        assert out == ""
        said += err
        return said.count("\n") > 1

    with Progress("fitting", 10, unit="step"), Progress("drawing", 10, unit="step") as bar:
        bar.advance(4)
        assert eventually(told)
    assert "drawing: 4 of 10 steps" in said.splitlines()[-1]
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0


def test_several_short_stages_are_one_long_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock of the test's own: the alarm of a stage rings when that of the one before it would have."""
    now = [5000.0]
    monkeypatch.setattr(progress, "_heart", progress._Heart())
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(progress, "SILENT", 1000.0)

    def until_it_rings(seconds: float) -> float:
        with Progress("fitting", 10):
            now[0] += seconds
            left, every = signal.getitimer(signal.ITIMER_REAL)
        assert every == 1000.0
        return left

    assert 600.0 < until_it_rings(400.0) <= 1000.0
    assert 0.0 < until_it_rings(0.0) <= 600.0, "the next stage at once: the silence is one"
    now[0] += 50.0
    assert 600.0 < until_it_rings(0.0) <= 1000.0, "work that begins after a pause has its own"


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


@pytest.mark.parametrize(("noun", "several"), [("trial", "trials"), ("study", "studies"), ("day", "days")])
def test_nouns_have_their_plural(noun: str, several: str) -> None:
    assert plural(noun) == several
    assert Progress("diagnosing", 3, unit=noun, quiet=True).line().startswith(f"diagnosing: 0 of 3 {several}, ")
