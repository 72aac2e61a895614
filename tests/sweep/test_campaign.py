"""Parts on disk: the same for any number of workers, resumed after a kill, none lost, none twice."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow")

from spacerobot.sweep import campaign
from tests.faults.harness import KILL, command, steps_of
from tests.sweep.helpers_sweep import SWEEP, TOTAL, files, sweep, table, write


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The small sweep, made by one process."""
    folder = tmp_path_factory.mktemp("alone")
    assert sweep(write(folder), folder / "out") == 0
    return files(folder / "out")


def test_the_table_holds_every_collision_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep(write(tmp_path), tmp_path / "out", "--json") == 0
    said = json.loads(capsys.readouterr().out)
    found = table(tmp_path / "out")
    assert found["collision"] == list(range(TOTAL))
    assert said["collisions"] == TOTAL
    assert said["method"] == "exact"
    e = np.array(found["restitution_hand"])
    assert said["results"]["restitution_hand"]["mean"] == pytest.approx(e.mean(), rel=1e-12)
    assert said["results"]["restitution_hand"]["max"] == e.max()
    assert json.loads((tmp_path / "out" / "sweep.json").read_text()) == said


def test_a_finished_sweep_is_reused_and_another_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, out = write(tmp_path), tmp_path / "out"
    assert sweep(path, out) == 0
    before = files(out)
    monkeypatch.setattr(campaign, "make_part", None)  # nothing is made again
    assert sweep(path, out) == 0
    assert sweep(path, out, "--seed", "4") == 2
    assert files(out) == before
    monkeypatch.undo()
    assert sweep(path, out, "--seed", "4", "--overwrite") == 0
    assert files(out).keys() == before.keys()
    assert files(out)["collisions/part-000000.parquet"] != before["collisions/part-000000.parquet"]


def test_an_interrupt_keeps_what_is_done(
    tmp_path: Path, alone: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    real = campaign.make_part

    def stopping(part: campaign.Part) -> dict:
        if len(made) == 3:
            raise KeyboardInterrupt
        made.append(part.number)
        return real(part)

    path, out = write(tmp_path), tmp_path / "out"
    monkeypatch.setattr(campaign, "make_part", stopping)
    assert sweep(path, out) == 130
    assert len(list((out / "collisions").glob("*.parquet"))) == 3
    assert not (out / "sweep.json").exists()
    again = []
    monkeypatch.setattr(campaign, "make_part", lambda part: again.append(part.number) or real(part))
    assert sweep(path, out) == 0
    assert not set(made) & set(again)
    assert files(out) == alone


@pytest.mark.parametrize("damage", ["truncated", "another run's", "another part", "gone"])
def test_a_part_that_is_not_right_is_made_again(tmp_path: Path, alone: dict[str, bytes], damage: str) -> None:
    path, out = write(tmp_path), tmp_path / "out"
    other = write(tmp_path / "other" if (tmp_path / "other").mkdir() is None else tmp_path, SWEEP)
    assert sweep(path, out) == 0
    part = out / "collisions" / "part-000002.parquet"
    if damage == "truncated":
        part.write_bytes(part.read_bytes()[:-20])
    elif damage == "gone":
        part.unlink()
    elif damage == "another part":
        part.write_bytes((out / "collisions" / "part-000001.parquet").read_bytes())
    else:
        assert sweep(other, tmp_path / "theirs", "--seed", "9") == 0
        part.write_bytes((tmp_path / "theirs" / "collisions" / "part-000002.parquet").read_bytes())
    marker = json.loads((out / "run.json").read_text())
    (out / "run.json").write_text(json.dumps({**marker, "state": "running"}))
    assert sweep(path, out) == 0
    assert files(out) == alone


@pytest.mark.parametrize("jobs", [2, 3])
@pytest.mark.slow
def test_the_files_are_the_same_for_any_number_of_processes(tmp_path: Path, alone: dict[str, bytes], jobs: int) -> None:
    assert sweep(write(tmp_path), tmp_path / "out", "--jobs", str(jobs)) == 0
    assert files(tmp_path / "out") == alone


def test_a_killed_command_is_taken_up_again(tmp_path: Path, alone: dict[str, bytes]) -> None:
    path, out, whole = write(tmp_path), tmp_path / "out", tmp_path / "whole"
    line = ["sweep", str(path), "--jobs", "1", "--out"]
    steps = steps_of(command([*line, str(whole)], whole))
    died = command([*line, str(out)], out, KILL, steps // 2)  # at this very step, however busy the machine is
    assert died.returncode == -signal.SIGKILL
    there = {p.name: p.stat().st_mtime_ns for p in (out / "collisions").glob("*.parquet")}
    assert 2 <= len(there) < len(alone)
    assert sweep(path, out) == 0
    after = {p.name: p.stat().st_mtime_ns for p in (out / "collisions").glob("*.parquet")}
    assert all(after[name] == there[name] for name in there)
    assert files(out) == files(whole) == alone


def test_bad_options_are_answered_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path)
    for options, says in (
        (["--jobs", "0"], "--jobs"),
        (["--jobs", "two"], "--jobs"),
        (["--seed", "-1"], "--seed"),
        (["--jobs", "2", "--dask", "tcp://127.0.0.1:1"], "--dask or --jobs"),
        (["--dask", "nonsense://"], "scheduler"),
    ):
        assert sweep(path, tmp_path / "out", *options) == 2, options
        said = capsys.readouterr().err
        assert says in said
        assert said.count("\n") == 1
    assert sweep(tmp_path / "none.toml", tmp_path / "out") == 2
    assert "no such sweep" in capsys.readouterr().err


def killed_once(task: tuple[str, int]) -> int:
    """Dies over task 3, the first time."""
    folder, number = task
    mark = Path(folder) / "died"
    if number == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def always_killed(task: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return task


@pytest.mark.slow
def test_a_process_that_dies_is_replaced(tmp_path: Path) -> None:
    from spacerobot.support.executors.local import LocalPool

    taken = []

    def tasks():
        for i in range(8):
            taken.append(i)
            yield str(tmp_path), i

    with LocalPool(2) as pool:
        results = []
        for (_, i), value in pool.run(killed_once, tasks()):
            results.append((i, value))
            assert len(taken) <= len(results) + 2 * 2  # no task is taken before there is room
    assert sorted(results) == [(i, i * i) for i in range(8)]
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_processes_that_always_die_are_given_up() -> None:
    from spacerobot.support.executors.base import WorkersLostError
    from spacerobot.support.executors.local import LocalPool

    with LocalPool(1) as pool, pytest.raises(WorkersLostError, match="died"):
        list(pool.run(always_killed, [1]))
