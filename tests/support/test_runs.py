"""Run folders: reused, resumed, refused; whole after a kill at any point."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from spacerobot.support import runs
from spacerobot.support.errors import InputError
from spacerobot.support.run_record import KEY
from spacerobot.support.runs import MARKER, RunFolder, combined_hash


def finished(folder: Path, input_hash: str = "a", command: str = "diagnose") -> None:
    with RunFolder(folder, command, input_hash) as run:
        run.write("verdict.json", "{}")
        run.finish()


def test_a_new_folder_is_a_new_run(tmp_path: Path) -> None:
    with RunFolder(tmp_path / "a" / "b", "diagnose", "a") as run:
        assert not run.finished
        assert not run.resumed


def test_a_finished_run_is_reused(tmp_path: Path) -> None:
    finished(tmp_path)
    with RunFolder(tmp_path, "diagnose", "a") as run:
        assert run.finished
    assert (tmp_path / "verdict.json").read_text() == "{}"


def test_an_interrupted_run_is_resumed_with_its_partial_results(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), RunFolder(tmp_path, "diagnose", "a") as run:
        run.save("pair/coulomb+drag: x", {"cost": 1.5})
        run.save_arrays("fit", {"x": np.array([1.0, np.nan])})
        raise KeyboardInterrupt
    with RunFolder(tmp_path, "diagnose", "a") as run:
        assert run.resumed
        assert run.load("pair/coulomb+drag: x") == {"cost": 1.5}
        assert run.load("pair/coulomb_drag: x") is None
        arrays = run.load_arrays("fit")
        assert arrays is not None
        np.testing.assert_array_equal(arrays["x"], [1.0, np.nan])
        run.finish()
    assert not (tmp_path / "partial").exists()


@pytest.mark.parametrize(
    ("command", "input_hash", "reason"),
    [("sweep", "a", "'diagnose'"), ("diagnose", "b", "other inputs")],
)
def test_another_run_is_refused(tmp_path: Path, command: str, input_hash: str, reason: str) -> None:
    finished(tmp_path)
    with pytest.raises(InputError, match=reason):
        RunFolder(tmp_path, command, input_hash)
    assert (tmp_path / "verdict.json").exists()


def test_a_run_of_other_sources_is_not_taken_for_the_same(tmp_path: Path) -> None:
    finished(tmp_path)
    with pytest.raises(InputError, match="sources have changed"):
        RunFolder(tmp_path, "diagnose", "a", code="0123456789abcdef")
    with RunFolder(tmp_path, "diagnose", "a") as run:
        assert run.finished


@pytest.mark.parametrize("ended", [True, False], ids=["finished", "interrupted"])
@pytest.mark.parametrize("what", KEY)
def test_a_run_that_differs_in_one_thing_is_another(
    what: str, ended: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Command, input, version, and the package's sources where no other code is named: neither reused nor resumed."""
    run = RunFolder(tmp_path, "diagnose", "a")
    run.save("half", 1)
    run.write("verdict.json", "{}")
    if ended:
        run.finish()
    run.close()
    asked = {"command": "diagnose", "input_hash": "a"}
    if what in asked:
        asked[what] = "another"
    else:
        name, value = {"version": ("__version__", "0"), "code": ("package_hash", lambda: "another")}[what]
        monkeypatch.setattr(runs, name, value)
    with pytest.raises(InputError, match="the folder holds"):
        RunFolder(tmp_path, **asked)
    monkeypatch.undo()
    with RunFolder(tmp_path, "diagnose", "a") as again:
        assert again.finished is ended
        assert again.resumed is not ended


def test_foreign_files_are_refused_and_survive_an_overwrite(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match=r"thesis\.tex"):
        RunFolder(tmp_path, "diagnose", "a")
    with RunFolder(tmp_path, "diagnose", "a", overwrite=True) as run:
        run.finish()
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_overwrite_removes_the_old_runs_files_even_of_an_interrupted_one(tmp_path: Path) -> None:
    with RunFolder(tmp_path, "diagnose", "a") as run:
        run.write("report.html", "old")
        run.save("x", 1)
    with RunFolder(tmp_path, "diagnose", "b", overwrite=True) as run:
        assert not (tmp_path / "report.html").exists()
        assert run.load("x") is None


def test_a_finished_run_that_lost_a_file_is_done_again(tmp_path: Path) -> None:
    finished(tmp_path)
    (tmp_path / "verdict.json").unlink()
    with RunFolder(tmp_path, "diagnose", "a") as run:
        assert not run.finished


def test_damaged_markers_and_partials_are_not_trusted(tmp_path: Path) -> None:
    with RunFolder(tmp_path, "diagnose", "a") as run:
        run.save("x", 1)
        run.save_arrays("y", {"y": np.ones(3)})
        for file in (tmp_path / "partial").iterdir():
            file.write_bytes(file.read_bytes()[:20])
        assert run.load("x") is None
        assert run.load_arrays("y") is None
    (tmp_path / MARKER).write_text("[1")
    with pytest.raises(InputError, match="other files"):
        RunFolder(tmp_path, "diagnose", "a")


def test_two_processes_do_not_share_a_folder(tmp_path: Path) -> None:
    with RunFolder(tmp_path, "diagnose", "a"), pytest.raises(InputError, match="another process"):
        RunFolder(tmp_path, "diagnose", "a")


@pytest.mark.parametrize("name", ["../out.json", "/etc/passwd", "."])
def test_outputs_stay_inside(tmp_path: Path, name: str) -> None:
    with RunFolder(tmp_path / "run", "diagnose", "a") as run, pytest.raises(InputError, match="inside"):
        run.path(name)


def test_a_file_in_the_way_is_an_input_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="--out"):
        RunFolder(tmp_path / "file", "diagnose", "a")


def test_hashes_do_not_run_together() -> None:
    assert combined_hash("ab", "c") != combined_hash("a", "bc")
    assert combined_hash({"seed": 1}) == combined_hash({"seed": 1})


_WRITER = """
import sys
from spacerobot.support.runs import RunFolder
with RunFolder(sys.argv[1], "diagnose", "a") as run:
    for i in range(10_000):
        run.save(f"step {i}", list(range(500)))
        print("ready", flush=True)
        run.write("report.html", "x" * (100_000 + i))
"""


@pytest.mark.parametrize("delay", [0.02, 0.11])
def test_kill_leaves_whole_files_and_a_run_that_resumes(tmp_path: Path, delay: float) -> None:
    process = subprocess.Popen([sys.executable, "-c", _WRITER, str(tmp_path)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(delay)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert json.loads((tmp_path / MARKER).read_text())["state"] == "running"
    if (tmp_path / "report.html").exists():
        assert set((tmp_path / "report.html").read_text()) == {"x"}
    with RunFolder(tmp_path, "diagnose", "a") as run:
        assert run.resumed
        assert run.load("step 0") == list(range(500))
        assert not list(tmp_path.rglob(".*.part"))


def test_a_run_that_is_refused_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError), RunFolder(tmp_path / "a" / "b", "fit", "1"):
        raise InputError("bad")
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_has_saved_something_stays(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), RunFolder(tmp_path / "a", "fit", "1") as run:
        run.save("half", 1)
        raise KeyboardInterrupt
    with RunFolder(tmp_path / "a", "fit", "1") as run:
        assert run.resumed
        assert run.load("half") == 1


def test_a_folder_that_was_there_stays(tmp_path: Path) -> None:
    with pytest.raises(InputError), RunFolder(tmp_path, "fit", "1"):
        raise InputError("bad")
    assert tmp_path.is_dir()


@pytest.mark.parametrize("name", ["\0", "a\0b", "\ud800"])
@pytest.mark.parametrize("overwrite", [False, True])
def test_a_marker_whose_outputs_are_no_paths_is_a_strangers(tmp_path: Path, name: str, overwrite: bool) -> None:
    finished(tmp_path)
    marker = json.loads((tmp_path / MARKER).read_text())
    (tmp_path / MARKER).write_text(json.dumps({**marker, "outputs": {name: 2}}))
    if overwrite:
        with RunFolder(tmp_path, "diagnose", "a", overwrite=True) as run:
            assert not run.finished
    else:
        with pytest.raises(InputError, match="the folder holds other files"):
            RunFolder(tmp_path, "diagnose", "a")
