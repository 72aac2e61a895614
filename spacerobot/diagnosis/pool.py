"""Fits side by side: worker processes that each hold the study, or the calling process where one job is asked for."""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.data import trial_data
from spacerobot.diagnosis.fit import Fitter
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Label, Site, hypothesis
from spacerobot.diagnosis.memory import Store, as_json, from_json, task_name
from spacerobot.diagnosis.rig_model import RigModel
from spacerobot.diagnosis.starts import fit_from, fit_near
from spacerobot.effects.registry import effect, load_file
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.support.executors.base import THREAD_VARIABLES, Executor
from spacerobot.support.orphans import end_with_parent
from spacerobot.support.runs import combined_hash

WARM, COLD = "warm", "cold"

Only = tuple[tuple[tuple[str, str], tuple[str, ...]], ...]
"""Effects and places that act in some trials alone, and which."""


@dataclass(frozen=True)
class Task:
    """One fit to make.

    Attributes:
        label: effects and places.
        start: start values by key.
        initials: start of the trials' initial values.
        near: a finished fit to begin at instead.
        loose: whether it may end on old derivatives.
        eager: whether it may be given up on what a step promises.
        hopeless: cost above which it may be given up.
        max_iterations: of each fit.
        without: trials left out.
        only: effects and places that act in some trials alone, and which; those of `near` are known by it.
    """

    label: Label
    start: Mapping[str, float]
    initials: Mapping[str, np.ndarray] | None = None
    hopeless: float = np.inf
    max_iterations: int = 40
    without: tuple[str, ...] = ()
    near: Fit | None = None
    loose: bool = False
    eager: bool = False
    only: Only = ()

    def sites(self) -> list[Site]:
        """What is to be fitted."""
        near = () if self.near is None else self.near.hypothesis.sites
        some = {**{s.label: s.trials for s in near}, **dict(self.only)}
        return [Site(effect(name), where, some.get((name, where), ())) for name, where in self.label]

    @property
    def mode(self) -> str:
        """WARM where it begins at a finished fit, else COLD."""
        return COLD if self.near is None else WARM


@dataclass
class Workshop:
    """What a worker needs: the model, its trials, and a fitter."""

    study: Study
    make_model: Callable[[Study, Any], Any] = RigModel
    threads: int = 1
    fitters: dict[tuple[str, ...], Fitter] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.trials = trial_data(self.study)
        self.model = self.make_model(self.study, self.trials)

    def fitter(self, without: tuple[str, ...] = ()) -> Fitter:
        """A fitter of all trials but some."""
        if without not in self.fitters:
            kept = [t for t in self.trials if t.id not in without]
            self.fitters[without] = Fitter(self.model, kept, threads=self.threads, hasty=True)
        return self.fitters[without]

    def run(self, task: Task) -> Fit | None:
        """Do a task; None where it cannot be simulated."""
        sites = task.sites()
        try:
            if task.near is not None:
                return fit_near(
                    self.fitter(task.without),
                    self.model.believed,
                    sites,
                    task.near,
                    task.start,
                    task.max_iterations,
                    task.hopeless,
                    task.loose,
                    task.eager,
                )
            return fit_from(
                self.fitter(task.without),
                self.model.believed,
                sites,
                task.start,
                task.initials,
                task.max_iterations,
                task.hopeless,
            )
        except (SimulationError, InputError):  # a start outside what the rig can be
            return None


@contextlib.contextmanager
def _without_interrupts() -> Iterator[None]:
    """Hold back Ctrl-C: it is this process's to answer, and a worker that has just begun would answer it too."""
    held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, held)


_workshop: Workshop | None = None


def _open(study: Study, make_model: Callable[[Study, Any], Any], files: tuple[str, ...]) -> None:
    global _workshop
    import os

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt is the parent's to answer
    end_with_parent()
    for name in THREAD_VARIABLES:
        os.environ[name] = "1"
    for file in files:
        load_file(Path(file))
    _workshop = Workshop(study, make_model)


def _way(workshop: Workshop) -> str:
    """How to begin processes: as copies of this one where that is safe, for they then load and compile nothing."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return "spawn"
    if isinstance(workshop.model, RigModel):  # loads the compiled code, once for all
        fitter, believed = workshop.fitter(), hypothesis(workshop.model.believed, [])
        with contextlib.suppress(SimulationError, InputError):
            trial = workshop.trials[0]
            fitter.residual(believed, believed.start(), trial, fitter.guess()[trial.id])
    return "fork"


def _ready() -> None:
    """What a process does first."""


def _run(task: Task) -> Fit | None:
    assert _workshop is not None  # the initializer ran
    return _workshop.run(task)


@dataclass(frozen=True)
class Shipment:
    """A task with all that workers elsewhere need to do it; they read the study's files under the same paths.

    `key` is made of the contents of all files: workers outlive a study, and files may change.
    """

    key: str
    study: Study
    make_model: Callable[[Study, Any], Any]
    files: tuple[str, ...]
    task: Task


_shops: dict[str, Workshop] = {}


def unpacked(shipment: Shipment) -> Fit | None:
    """In a worker elsewhere: the task done, in a workshop that is kept for the next one of the same study."""
    if shipment.key not in _shops:
        _shops.clear()
        for file in shipment.files:
            load_file(Path(file))
        _shops[shipment.key] = Workshop(shipment.study, shipment.make_model)
    return _shops[shipment.key].run(shipment.task)


class Pool:
    """Runs tasks, in processes if more than one job is allowed; closes them on exit.

    Where a process is lost (killed for want of memory, most often) the rest is done in the calling one.

    Args:
        workshop: of this process.
        jobs: processes.
        files: with further effects.
        store: keeps finished fits.
        workers: that do the tasks instead of processes of this machine.
    """

    def __init__(
        self,
        workshop: Workshop,
        jobs: int,
        files: Sequence[str] = (),
        store: Store | None = None,
        workers: Executor | None = None,
    ) -> None:
        self.workshop = workshop
        self._store = store
        self._workers = workers
        self._files = tuple(files)
        self._executor: ProcessPoolExecutor | None = None
        if jobs > 1 and workers is None:
            self._executor = ProcessPoolExecutor(
                jobs,
                mp_context=multiprocessing.get_context(_way(workshop)),
                initializer=_open,
                initargs=(workshop.study, workshop.make_model, tuple(files)),
            )
            with _without_interrupts():  # begins the processes, before there are threads
                self._executor.submit(_ready)

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self._close(now=kind is not None)

    def _close(self, now: bool) -> None:
        if self._executor is None:
            return
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        self._executor.shutdown(wait=not now, cancel_futures=True)
        if now:
            for process in processes:  # nobody waits for what they are at
                process.terminate()
        self._executor = None

    def run(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, Fit | None]]:
        """Results as they come; tasks begin in the order given, those that the store holds are not done again."""
        left = []
        for task in tasks:
            known, fit = self._recalled(task)
            if known:
                yield task, fit
            else:
                left.append(task)
        for task, fit in self._done(left):
            self._keep(task, fit)
            yield task, fit

    def here(self, task: Task) -> Fit | None:
        """A task done in this process, with all its threads, unless the store holds it."""
        known, fit = self._recalled(task)
        if not known:
            fit = self.workshop.run(task)
            self._keep(task, fit)
        return fit

    def _keep(self, task: Task, fit: Fit | None) -> None:
        if self._store is not None:
            self._store.save(task_name(task), as_json(fit))

    def _recalled(self, task: Task) -> tuple[bool, Fit | None]:
        kept = None if self._store is None else self._store.load(task_name(task))
        if kept is None:
            return False, None
        made = hypothesis(self.workshop.model.believed, task.sites(), task.start)
        fit = from_json(kept, self.workshop.fitter(task.without), made)
        return fit is not None or kept["fit"] is None, fit

    def _done(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, Fit | None]]:
        if self._workers is not None:
            yield from self._elsewhere(self._workers, tasks)
            return
        left = {id(task): task for task in tasks}
        if self._executor is not None:
            try:
                for task, found in self._in_processes(tasks):
                    del left[id(task)]
                    yield task, found
            except BrokenProcessPool:
                self._close(now=True)
        for task in left.values():
            yield task, self.workshop.run(task)

    @functools.cached_property
    def _key(self) -> str:
        contents = [Path(file).read_text(encoding="utf-8") for file in self._files]
        return combined_hash(self.workshop.study.input_hash, *contents)

    def _elsewhere(self, workers: Executor, tasks: Sequence[Task]) -> Iterator[tuple[Task, Fit | None]]:
        study, make_model = self.workshop.study.unread(), self.workshop.make_model
        shipments = (Shipment(self._key, study, make_model, self._files, t) for t in tasks)
        for shipment, fit in workers.run(unpacked, shipments):
            yield shipment.task, fit

    def _in_processes(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, Fit | None]]:
        assert self._executor is not None
        with _without_interrupts():  # submitting begins processes, and they take over what is blocked
            waiting: dict[Future[Fit | None], Task] = {self._executor.submit(_run, t): t for t in tasks}
        while waiting:
            done, _ = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield waiting.pop(future), future.result()
