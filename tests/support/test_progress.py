"""Progress goes to standard error, and only where somebody watches."""

from __future__ import annotations

import pytest

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
