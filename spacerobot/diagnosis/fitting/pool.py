"""Fits side by side: worker processes that each hold the study, or the calling process where one job is asked for."""

from __future__ import annotations

import contextlib
import functools
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from spacerobot.diagnosis.fitting.fit_store import Store, again, as_json, from_json, plainly, task_name
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import MakeModel, Task, Workshop
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import load_effects
from spacerobot.recordings.study import Study
from spacerobot.support.copies import Copies, Waiting
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.support.executors.base import Executor
from spacerobot.support.runs import combined_hash

WINDOW = 8
"""Fits that are under way at the same time, at most."""

R = TypeVar("R")


def _opened(study: Study, make_model: MakeModel, files: tuple[str, ...]) -> Workshop:
    """In a process of its own."""
    for file in files:
        load_effects(file)
    return Workshop(study, make_model)


def _load(workshop: Workshop) -> None:
    """Load the compiled code."""
    if isinstance(workshop.model, RigModel):
        fitter, believed = workshop.fitter(), hypothesis(workshop.model.believed, [])
        with contextlib.suppress(SimulationError, InputError):
            trial = workshop.trials[0]
            fitter.residual(believed, believed.start(), trial, fitter.guess()[trial.id])


@dataclass(frozen=True)
class Shipment:
    """A task with all that workers elsewhere need to do it; they read the study's files under the same paths.

    `key` is made of the contents of all files: workers outlive a study, and files may change.
    """

    key: str
    study: Study
    make_model: MakeModel
    files: tuple[str, ...]
    task: Task


_shops: dict[str, Workshop] = {}


def unpacked(shipment: Shipment) -> Fit | None:
    """In a worker elsewhere: the task done, in a workshop that is kept for the next one of the same study."""
    if shipment.key not in _shops:
        _shops.clear()
        _shops[shipment.key] = _opened(shipment.study, shipment.make_model, shipment.files)
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
        opened = functools.partial(_opened, workshop.study, workshop.make_model, self._files)
        self._copies = Copies(workshop, 1 if workers is not None else jobs, opened, _load)

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self._copies.close(now=kind is not None)

    def run(
        self, tasks: Sequence[Task], prepared: Callable[[Task], Task] = lambda task: task
    ) -> Iterator[tuple[Task, Fit | None]]:
        """Results in the order of their tasks, WINDOW of which are under way; what the store holds is not redone.

        A task is prepared when all but the last WINDOW - 1 results before it were taken, however many processes there
        are and however fast: what `prepared` makes of earlier results is the same everywhere.
        """
        waiting: deque[tuple[Task, Waiting[Fit | None]]] = deque()
        try:
            for k in range(len(tasks) + WINDOW):
                if k >= WINDOW and waiting:
                    task, result = waiting.popleft()
                    fit = result()
                    self._keep(task, fit)
                    yield task, fit
                if k < len(tasks):
                    task = prepared(tasks[k])
                    waiting.append((task, self._begun(task)))
        finally:
            for _, result in waiting:  # nobody takes them any more
                result.cancel()

    def aside(self, work: Callable[..., R], *arguments: Any) -> Waiting[R]:
        """work(workshop, *arguments) in another process; where there is none or it is lost, in this one when asked for.

        Args:
            work: importable by name; changes nothing.
            arguments: picklable, as the result is.
        """
        return self._copies.aside(work, *arguments)

    def kept_aside(self, of: type[R], about: Sequence[Any], work: Callable[..., R], *arguments: Any) -> Waiting[R]:
        """The same for a result that a store can hold: not done again where it does.

        Args:
            of: the result's type.
            about: all that decides the result, beside the study.
            work, arguments: as of `aside`.
        """
        name = "kept-" + combined_hash(*about)
        kept = None if self._store is None else self._store.load(name)
        if kept is not None:
            known: R = again(kept, of)
            return Waiting(lambda: known)
        begun = self.aside(work, *arguments)

        def result() -> R:
            found = begun()
            if self._store is not None:
                self._store.save(name, plainly(found))
            return found

        return Waiting(result, begun.future)

    def here(self, task: Task) -> Fit | None:
        """A task done in this process, unless the store holds it."""
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
        model = self.workshop.model
        if task.near is not None and task.along:
            made = task.near.hypothesis
        else:
            made = hypothesis(model.believed.free_of(task.freed), task.sites(model), task.start)
        fit = from_json(kept, self.workshop.fitter(), made)
        return fit is not None or kept["fit"] is None, fit

    def _begun(self, task: Task) -> Waiting[Fit | None]:
        known, fit = self._recalled(task)
        if known:
            return Waiting(lambda: fit)
        if self._workers is not None:
            study, make_model = self.workshop.study.unread(), self.workshop.make_model
            shipment = Shipment(self._key, study, make_model, self._files, task)
            return Waiting(self._workers.begin(unpacked, shipment))
        return self.aside(Workshop.run, task)

    @functools.cached_property
    def _key(self) -> str:
        contents = [Path(file).read_text(encoding="utf-8") for file in self._files]
        return combined_hash(self.workshop.study.input_hash, *contents)
