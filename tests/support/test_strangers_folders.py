"""What a run has not written is never touched: not in a folder that is refused, not beside a run that is replaced."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.cli.main import COMMANDS, main
from spacerobot.support.errors import InputError
from spacerobot.support.runs import RunFolder
from tests.support.trees import plant, seen, trees

ROBOT = ["pa10_wrist", "--q", "0 45 0 90 0 -45 0", "--deg"]
WITH_OUT: dict[str, list[str]] = {
    "demo": [],
    "robots": [],
    "mass": ROBOT,
    "simulate": ["pa10_wrist"],
    "paper": [],
    "overlay": ["guide-friction"],
    "diagnose": ["guide-friction"],
    "prove": ["--quick", "--seed", "1"],
    "sweep": ["SWEEP"],
}


@contextlib.contextmanager
def planted(tree: Any) -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as top:
        plant(Path(top), tree)
        yield Path(top)


@given(tree=trees())
@settings(max_examples=60, deadline=None)
def test_a_folder_that_is_refused_is_left_as_it_was(tree: Any) -> None:
    with planted(tree) as top:
        before = seen(top)
        with pytest.raises(InputError):
            RunFolder(top / "out", "diagnose", "a")
        assert seen(top) == before


@given(tree=trees())
@settings(max_examples=60, deadline=None)
def test_a_run_that_replaces_touches_only_what_it_writes(tree: Any) -> None:
    """Strangers' files stay although the run may overwrite; its own names alone become its own."""
    with planted(tree) as top:
        before = seen(top, times=False)
        try:
            with RunFolder(top / "out", "diagnose", "a", overwrite=True) as run:
                run.write("verdict.json", "{}")
                run.save("fit 1", {"cost": 1.0})
                run.finish()
        except (InputError, OSError):  # a folder or a link where the run would write
            pass
        after = seen(top, times=False)
        own = {"out/verdict.json", "out/run.json", "out/partial"}
        assert {k: v for k, v in after.items() if k not in own} == {k: v for k, v in before.items() if k not in own}


@given(tree=trees())
@settings(max_examples=40, deadline=None)
def test_a_finished_run_and_its_neighbours(tree: Any) -> None:
    """What strangers laid into a run's folder afterwards stays when the run is asked for again, or replaced."""
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        with RunFolder(top / "out", "diagnose", "a") as run:
            run.write("verdict.json", "{}")
            run.finish()
        plant(top, [entry for entry in tree if entry[0] not in ("run.json", "verdict.json")])
        before = seen(top, times=False)
        with RunFolder(top / "out", "diagnose", "a") as run:
            assert run.finished
        assert seen(top, times=False) == before
        with pytest.raises(InputError), RunFolder(top / "out", "diagnose", "b"):
            pass
        assert seen(top, times=False) == before


@pytest.mark.parametrize("change", ["flipped", "longer", "a link", "a folder"])
def test_a_finished_run_is_believed_by_its_content(tmp_path: Path, change: str) -> None:
    """A file of the same size with another word in it is not what the run found; nor is it written over."""
    with RunFolder(tmp_path / "out", "diagnose", "a") as run:
        path = run.write("verdict.json", '{"verdict": "named"}')
        run.finish()
    if change == "flipped":
        path.write_text('{"verdict": "mined"}')
    elif change == "longer":
        path.write_text('{"verdict": "named"}\n')
    else:
        path.rename(tmp_path / "elsewhere")
        path.symlink_to(tmp_path / "elsewhere") if change == "a link" else path.mkdir()
    before = seen(tmp_path)
    with pytest.raises(InputError, match=r"changed since: verdict\.json"):
        RunFolder(tmp_path / "out", "diagnose", "a")
    assert seen(tmp_path) == before


@pytest.mark.parametrize("state", ["finished", "running"])
def test_an_output_is_not_written_over_a_strangers_file(tmp_path: Path, state: str) -> None:
    with RunFolder(tmp_path, "diagnose", "a") as run:
        run.write("verdict.json", "{}")
    (tmp_path / "report.html").write_text("a thesis")
    with RunFolder(tmp_path, "diagnose", "a") as run, pytest.raises(InputError, match="not written"):
        run.write("report.html", "a report")
    assert (tmp_path / "report.html").read_text() == "a thesis"


def test_outputs_do_not_leave_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    with RunFolder(tmp_path / "out", "diagnose", "a") as run:
        run.write("verdict.json", "{}")
        for name in ("plots", "partial"):
            (tmp_path / "out" / name).symlink_to(tmp_path / "elsewhere")
        with pytest.raises(InputError, match="inside"):
            run.write("plots/a.png", b"")
        with pytest.raises(InputError, match="link"):
            run.save("fit", 1)
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_a_system_that_cannot_lock_folders_has_a_file_for_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Network file systems; a stranger's folder stays clean there too, and two runs are still kept apart."""
    import fcntl

    real = fcntl.flock

    def flock(handle: int, how: int) -> None:
        if os.path.isdir(f"/proc/self/fd/{handle}"):
            raise OSError(9, "Bad file descriptor")
        real(handle, how)

    monkeypatch.setattr("spacerobot.support.runs.fcntl.flock", flock)
    with RunFolder(tmp_path / "out", "diagnose", "a") as run:
        run.write("verdict.json", "{}")
        with pytest.raises(InputError, match="another process"):
            RunFolder(tmp_path / "out", "diagnose", "a")
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "thesis.tex").write_text("years")
    before = seen(tmp_path)
    with pytest.raises(InputError, match="other files"):
        RunFolder(tmp_path / "theirs", "diagnose", "a")
    assert seen(tmp_path) == before


def test_the_check_can_fail() -> None:
    """What was done before: every leftover below the folder removed, a lock opened through a link."""

    def careless(folder: Path) -> None:
        for left in folder.rglob(".*.part"):
            left.unlink()
        (folder / ".lock").open("ab").close()

    tree = [("notes/.draft.part", "file", b"mine"), ("a.txt", "file", b"b")]
    with planted(tree) as top:
        before = seen(top)
        careless(top / "out")
        assert seen(top) != before


@pytest.fixture
def arguments(tmp_path: Path) -> Callable[[str], list[str]]:
    def of(command: str) -> list[str]:
        (tmp_path / "sweep.toml").write_text("[grid]\ntarget.speed = [0.05]\n")
        return [str(tmp_path / "sweep.toml") if a == "SWEEP" else a for a in WITH_OUT[command]]

    return of


THEIRS = [
    (".lock", "link", "elsewhere"),
    (".verdict.json.abcdefgh.part", "file", b"1"),
    ("notes/.draft.part", "file", b"2"),
    ("partial/fit-0123456789ab.json", "file", b"{}"),
    ("run.json", "file", json.dumps({"state": "finished", "outputs": {"thesis.tex": 5}}).encode()),
    ("thesis.tex", "file", b"years"),
]


@pytest.mark.parametrize("command", WITH_OUT)
def test_every_command_leaves_a_strangers_folder_alone(
    command: str, arguments: Callable[[str], list[str]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if command == "prove":
        pytest.importorskip("mujoco")
    if command == "sweep":
        pytest.importorskip("pyarrow")
    plant(tmp_path / "theirs", THEIRS)
    asked = arguments(command)
    before = seen(tmp_path)
    assert main([command, *asked, "--out", str(tmp_path / "theirs" / "out")]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert seen(tmp_path) == before


def test_no_command_is_forgotten() -> None:
    from spacerobot.cli.main import build_parser

    takes = {
        c
        for c in COMMANDS
        if c != "study" and "--out DIR" in build_parser(c)._subparsers._group_actions[0].choices[c].format_help()
    }  # type: ignore[union-attr,index]
    assert takes == set(WITH_OUT)


@given(data=st.data())
@settings(max_examples=10, deadline=None)
@pytest.mark.parametrize("command", ["study new", "study table", "view"])
def test_files_that_are_there_are_not_written_over(command: str, data: st.DataObject) -> None:
    """Were they links that lead nowhere."""
    kind = data.draw(st.sampled_from(["file", "link", "folder"]))
    with planted([("page.html", kind, b"x" if kind == "file" else "nowhere")]) as top:
        (top / "rec").mkdir()
        (top / "rec" / "a.csv").write_text("t,x\n0,1\n1,2\n2,3\n")
        file = str(top / "out" / "page.html")
        words = {
            "study new": ["study", "new", str(top / "rec"), "--out", file],
            "study table": ["study", "table", "guide-friction", "--out", file],
            "view": ["view", "pa10_wrist", "--html", file],
        }[command]
        before = seen(top)
        if kind == "folder" and command == "study new":
            return  # then the file is made in the folder
        assert main(words) == 2
        assert seen(top) == before
