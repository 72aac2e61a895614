"""Fits side by side: the same numbers wherever they are made, and none lost with a worker."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import WINDOW, Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.support.executors.base import Here
from tests.diagnosis.rigs import write_study

RUB = Task((("coulomb_friction", "wrist"),), {"coulomb_friction@wrist.force_N": 0.2}, max_iterations=4)
TILT = Task((("table_tilt", "target"),), {"table_tilt@target.angle_rad": 1e-5}, max_iterations=2)
TASKS = [Task((), {}, max_iterations=3), RUB, TILT]


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    planted = [("coulomb_friction", "wrist", {"force_N": 0.35})]
    return Workshop(write_study(tmp_path_factory.mktemp("study"), planted=planted, masses=(9.0,)))


@pytest.fixture(scope="module")
def here(workshop: Workshop) -> dict[Any, Fit | None]:
    return fitted(Pool(workshop, 1))


def fitted(pool: Pool) -> dict[Any, Fit | None]:
    with pool:
        return {task.label: fit for task, fit in pool.run(TASKS)}


def assert_equal(some: dict[Any, Fit | None], others: dict[Any, Fit | None]) -> None:
    assert set(some) == set(others)
    for label, fit in some.items():
        other = others[label]
        assert fit is not None
        assert other is not None
        np.testing.assert_array_equal(fit.z, other.z)
        assert fit.cost == other.cost


class Noting(Here):
    """Workers that note what they were sent."""

    def __init__(self) -> None:
        self.sent: list[Any] = []
        self.recordings: list[int] = []

    def run(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
        for task in tasks:
            self.sent.append(task)
            self.recordings.append(len(task.study._cache))
            yield task, function(task)


def test_workers_elsewhere_are_sent_no_recordings_and_find_the_same(
    workshop: Workshop, here: dict[Any, Fit | None]
) -> None:
    workers = Noting()
    assert_equal(here, fitted(Pool(workshop, 1, workers=workers)))
    assert [s.task.label for s in workers.sent] == [t.label for t in TASKS]
    assert workshop.study._cache  # this process has read them
    assert workers.recordings[0] == 0


@pytest.mark.slow
def test_a_cluster_finds_the_same_although_it_loses_a_worker(workshop: Workshop, here: dict[Any, Fit | None]) -> None:
    distributed = pytest.importorskip("distributed")
    from spacerobot.support.executors.cluster import DaskWorkers

    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, silence_logs=50
    ) as cluster:
        workers = DaskWorkers(cluster.scheduler_address)
        victim = next(iter(workers.everywhere(os.getpid).values()))
        found = {}
        try:
            with Pool(workshop, 1, workers=workers) as pool:
                for task, fit in pool.run(TASKS):
                    if not found:
                        os.kill(victim, signal.SIGKILL)
                    found[task.label] = fit
        finally:
            workers.close()
    assert_equal(here, found)


@pytest.mark.slow
def test_processes_find_the_same(workshop: Workshop, here: dict[Any, Fit | None]) -> None:
    assert_equal(here, fitted(Pool(workshop, 2)))


@pytest.mark.slow
def test_a_task_knows_the_same_results_however_many_processes_there_are(workshop: Workshop) -> None:
    tasks = [replace(TILT, max_iterations=1, start={"table_tilt@target.angle_rad": k * 1e-6}) for k in range(1, 14)]

    def noted(jobs: int) -> list[tuple[int, int]]:
        taken: list[Task] = []
        known: list[tuple[int, int]] = []

        def prepared(task: Task) -> Task:
            known.append((tasks.index(task), len(taken)))
            return task

        with Pool(workshop, jobs) as pool:
            for task, _ in pool.run(tasks, prepared):
                taken.append(task)
        assert taken == tasks
        return known

    known = noted(1)
    assert known == noted(2)
    assert known == [(k, max(0, k - WINDOW + 1)) for k in range(13)]


def test_what_nobody_takes_any_more_does_not_hold_up_the_rest(workshop: Workshop) -> None:
    with Pool(workshop, 2) as pool:
        for task, _ in pool.run([RUB] * 6):
            assert task is RUB
            break
        assert next(iter(pool.run([TILT])))[0] is TILT


def _where(workshop: Workshop, factor: int) -> tuple[int, int]:
    return os.getpid(), factor * len(workshop.trials)


@pytest.mark.slow
def test_work_aside_is_done_elsewhere_where_there_is_an_elsewhere(workshop: Workshop) -> None:
    count = 3 * len(workshop.trials)
    with Pool(workshop, 1) as pool:
        assert pool.aside(_where, 3)() == (os.getpid(), count)
    with Pool(workshop, 2) as pool:
        process, found = pool.aside(_where, 3)()
        assert process != os.getpid()
        assert found == count


def _dies_elsewhere(workshop: Workshop, home: int) -> tuple[int, int]:
    if os.getpid() != home:
        os.kill(os.getpid(), signal.SIGKILL)
    return _where(workshop, 3)


def test_work_aside_whose_process_dies_is_done_here(workshop: Workshop) -> None:
    home, count = os.getpid(), 3 * len(workshop.trials)
    with Pool(workshop, 2) as pool:
        waiting = [pool.aside(_dies_elsewhere, home), pool.aside(_where, 3)]
        assert waiting[0]() == (home, count)
        assert waiting[1]()[1] == count, "whoever did it, before or after the loss"
        assert pool.aside(_where, 3)() == (home, count), "the pool knows by now"


def test_whoever_answers_after_a_kill_nothing_is_lost(workshop: Workshop) -> None:
    count = 3 * len(workshop.trials)
    with Pool(workshop, 2) as pool:
        os.kill(pool.aside(_where, 3)()[0], signal.SIGKILL)
        for _ in range(20):  # before the pool can know, and after
            assert pool.aside(_where, 3)()[1] == count


def test_studies_do_not_mix_in_a_worker(workshop: Workshop, here: dict[Any, Fit | None], tmp_path: Path) -> None:
    workers = Noting()
    (tmp_path / "other").mkdir()
    other = Workshop(write_study(tmp_path / "other", masses=(9.0,), seed=5))
    fitted(Pool(other, 1, workers=workers))
    assert_equal(here, fitted(Pool(workshop, 1, workers=workers)))
