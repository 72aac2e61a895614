"""Scratch folders: gone after use, and after whoever used them was killed; never taken from the living."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from spacerobot.support import scratch as module
from spacerobot.support.scratch import clear, scratch

HOLD = """
import sys, time
from spacerobot.support.scratch import scratch
with scratch("held") as folder:
    (folder / "study").mkdir()
    (folder / "study" / "a.csv").write_text("t")
    print(folder, flush=True)
    time.sleep(60)
"""


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary folder of the test's own, in which nothing was cleared yet."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    module._cleared.cache_clear()
    return tmp_path


def test_it_is_there_and_gone(temporary: Path) -> None:
    with scratch("proof") as folder:
        assert folder.is_dir()
        assert folder.parent == temporary
        assert "proof" in folder.name
        (folder / "a").write_text("b")
    assert not list(temporary.iterdir())


def test_gone_after_an_error_and_where_it_was_emptied_already(temporary: Path) -> None:
    with pytest.raises(KeyError), scratch() as folder:
        folder.rmdir()
        raise KeyError
    assert not list(temporary.iterdir())


def test_what_a_killed_process_left_is_cleared_by_the_next(temporary: Path) -> None:
    holder = subprocess.Popen([sys.executable, "-c", HOLD], stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None
    held = Path(holder.stdout.readline().strip())
    try:
        assert clear(temporary) == [], "its owner lives"
        with scratch():
            assert (held / "study" / "a.csv").exists()
    finally:
        holder.kill()
        holder.communicate()
    assert held.exists()
    module._cleared.cache_clear()
    with scratch() as mine:
        assert not held.exists()
        assert list(temporary.iterdir()) == [mine]


def test_links_and_other_folders_stay(temporary: Path) -> None:
    precious = temporary / "precious"
    precious.mkdir()
    (precious / "a").write_text("b")
    (temporary / "spacerobot-scratch-link").symlink_to(precious)
    (temporary / "spacerobot-scratch-file").write_text("not a folder")
    (temporary / "spacerobot-numba-0").mkdir()
    assert clear(temporary) == []
    assert (precious / "a").exists()
    assert (temporary / "spacerobot-numba-0").exists()


def test_nested_ones_are_kept_apart(temporary: Path) -> None:
    with scratch("outer") as outer:
        with scratch("inner") as inner:
            assert clear(temporary) == []
            assert {outer, inner} == set(temporary.iterdir())
        assert list(temporary.iterdir()) == [outer]
