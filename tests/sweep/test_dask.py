"""A real scheduler and worker processes on loopback; one of them killed midway."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")
distributed = pytest.importorskip("distributed")

from spacerobot.support.errors import InputError  # noqa: E402
from spacerobot.support.executors.base import WorkersLostError  # noqa: E402
from spacerobot.support.executors.cluster import DaskWorkers  # noqa: E402
from tests.processes import gone  # noqa: E402
from tests.sweep.helpers_sweep import SWEEP, TOTAL, files, sweep, table, write  # noqa: E402


@pytest.fixture(scope="module")
def cluster() -> Iterator[distributed.LocalCluster]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, silence_logs=50
    ) as found:
        yield found


@pytest.mark.slow
def test_files_are_those_of_one_process(tmp_path: Path, cluster: distributed.LocalCluster) -> None:
    path = write(tmp_path)
    assert sweep(path, tmp_path / "alone") == 0
    assert sweep(path, tmp_path / "dask", "--dask", cluster.scheduler_address) == 0
    assert files(tmp_path / "dask") == files(tmp_path / "alone")


@pytest.mark.slow
def test_a_worker_killed_midway_loses_nothing_and_counts_nothing_twice(
    tmp_path: Path, cluster: distributed.LocalCluster
) -> None:
    text = SWEEP.replace("repeats = 20", "repeats = 800").replace("rows_per_part = 64", "rows_per_part = 400")
    path, out = write(tmp_path, text), tmp_path / "out"
    with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
        victim = next(iter(client.run(os.getpid).values()))
    killed: list[int] = []

    def kill() -> None:
        until = time.monotonic() + 120.0
        while time.monotonic() < until:
            done = len(list((out / "collisions").glob("*.parquet")))
            if done >= 3:
                os.kill(victim, signal.SIGKILL)
                killed.append(done)
                return
            time.sleep(0.005)

    thread = threading.Thread(target=kill)
    thread.start()
    assert sweep(path, out, "--dask", cluster.scheduler_address) == 0
    thread.join()
    assert killed
    assert killed[0] < 48, "the worker outlived the sweep"
    assert gone({victim})
    assert len(list((out / "collisions").glob("*"))) == 48
    assert table(out)["collision"] == list(range(40 * TOTAL))
    assert sweep(path, tmp_path / "alone") == 0
    assert files(out) == files(tmp_path / "alone")


def test_an_error_of_a_task_comes_back(tmp_path: Path, cluster: distributed.LocalCluster) -> None:
    with DaskWorkers(cluster.scheduler_address) as workers, pytest.raises(ZeroDivisionError):
        list(workers.run(inverse, [1.0, 0.0]))


def inverse(x: float) -> float:
    return 1.0 / x


def test_tasks_are_taken_as_there_is_room(cluster: distributed.LocalCluster) -> None:
    taken = []

    def tasks() -> Iterator[float]:
        for i in range(1, 200):
            taken.append(i)
            yield float(i)

    with DaskWorkers(cluster.scheduler_address) as workers:
        for done, (task, value) in enumerate(workers.run(inverse, tasks()), start=1):
            assert value == 1.0 / task
            assert len(taken) <= done + 2 * workers.workers
    assert len(taken) == 199


def test_a_folder_that_workers_do_not_see_is_refused(
    tmp_path: Path,
    cluster: distributed.LocalCluster,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(DaskWorkers, "everywhere", lambda *_: {"tcp://elsewhere": False})
    monkeypatch.setattr(DaskWorkers, "_same_version", lambda _: None)
    assert sweep(write(tmp_path), tmp_path / "out", "--dask", cluster.scheduler_address) == 2
    assert "do not see the folder" in capsys.readouterr().err


@pytest.mark.slow
def test_nobody_there() -> None:
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        DaskWorkers("tcp://127.0.0.1:9")


def test_a_scheduler_without_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    from spacerobot.support.executors import cluster as module

    monkeypatch.setattr(module, "PATIENCE", 2.0)
    with (
        distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None, silence_logs=50) as empty,
        pytest.raises(InputError, match="no workers"),
    ):
        DaskWorkers(empty.scheduler_address)


def test_a_scheduler_that_goes_away_is_told() -> None:
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
    ) as lost:
        workers = DaskWorkers(lost.scheduler_address)
        results = workers.run(slow_inverse, [float(i) for i in range(1, 100)])
        next(results)
        lost.close()
        with pytest.raises(WorkersLostError, match="went away"):
            list(results)
        workers.close()  # returns, though nobody answers


def slow_inverse(x: float) -> float:
    time.sleep(0.2)
    return 1.0 / x
