"""Trials simulated by any executor's workers: a study is a task for each trial."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from spacerobot.diagnosis.forward.as_diagnosed import AsDiagnosed
from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay
from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.recordings.study import Study
from spacerobot.support.executors.base import Executor
from spacerobot.support.runs import combined_hash


@dataclass(frozen=True)
class OneTrial:
    """A trial to simulate. Workers read the study's files, and the diagnosis's, under the same paths."""

    study: Study
    found: Path | None
    trial: str


_models: dict[str, ForwardModel] = {}


def model_of(study: Study, found: Path | None) -> ForwardModel:
    """The baseline, or what a diagnosis found, by its model.toml."""
    return forward_model(study) if found is None else AsDiagnosed.read(study, found)


def overlaid(task: OneTrial) -> TrialOverlay:
    """In a worker: the trial measured and simulated; the model is kept for the next trial of the same study."""
    key = combined_hash(task.study.input_hash, str(task.found))
    if key not in _models:
        _models.clear()
        _models[key] = model_of(task.study, task.found)
    return _models[key].simulate(task.study.trial(task.trial))


def overlays(study: Study, found: Path | None, workers: Executor) -> Iterator[TrialOverlay]:
    """Every trial of the study, as they come."""
    bare = replace(study, _cache={})
    for _, done in workers.run(overlaid, (OneTrial(bare, found, t.id) for t in study.trials)):
        yield done
