"""Which forward model serves a study; its trials simulated by any executor's workers, a task for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay
from spacerobot.diagnosis.forward.driven_axis import DrivenAxis
from spacerobot.diagnosis.forward.floating_platform import FloatingPlatform
from spacerobot.diagnosis.forward.parts import AsDiagnosed, Parts
from spacerobot.diagnosis.forward.wrist_rig import WristRig
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError
from spacerobot.support.executors.base import Executor
from spacerobot.support.runs import combined_hash

MODELS: tuple[type[ForwardModel], ...] = (WristRig, DrivenAxis, FloatingPlatform, Parts)
"""In the order in which they are asked."""


def forward_model(study: Study) -> ForwardModel:
    """The first model that applies.

    Raises:
        InputError: none does; says what each needs.
    """
    for model in MODELS:
        if model.applies(study):
            return model.of(study)
    needs = "; ".join((m.applies.__doc__ or m.kind).split("\n", 1)[0].rstrip(".") for m in MODELS)
    raise InputError(
        "no forward model for this baseline and these channels",
        given=", ".join(study.channels()[:8]),
        valid=needs,
        where=str(study.path),
    )


@dataclass(frozen=True)
class OneTrial:
    """A trial to simulate. Workers read the study's files, and the diagnosis's, under the same paths.

    `key` is made of the contents of all files: workers outlive a study, and files may change.
    """

    key: str
    study: Study
    found: Path | None
    trial: str


_models: dict[str, ForwardModel] = {}


def model_of(study: Study, found: Path | None) -> ForwardModel:
    """The baseline, or what a diagnosis found, by its model.toml."""
    return forward_model(study) if found is None else AsDiagnosed.read(study, found)


def overlaid(task: OneTrial) -> TrialOverlay:
    """In a worker: the trial measured and simulated; the model is kept for the next trial of the same study."""
    if task.key not in _models:
        _models.clear()
        _models[task.key] = model_of(task.study, task.found)
    return _models[task.key].simulate(task.study.trial(task.trial))


def overlays(study: Study, found: Path | None, workers: Executor) -> Iterator[TrialOverlay]:
    """Every trial of the study, as they come."""
    bare = study.unread()
    key = combined_hash(study.input_hash, None if found is None else found.read_text(encoding="utf-8"))
    for _, done in workers.run(overlaid, (OneTrial(key, bare, found, t.id) for t in study.trials)):
        yield done
