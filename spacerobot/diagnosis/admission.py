"""What a diagnosis asks of a study before it begins: one door for `study check`, `overlay` and `diagnose`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.data import one_trial
from spacerobot.diagnosis.rig_model import LEAST, RigModel, readable
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, SpacerobotError

TRACK = "target.x"
"""Without it a trial of a wrist has no start."""


def has_wrist(study: Study) -> bool:
    """Whether the study is of a wrist that meets a target; any other machine is diagnosed part by part."""
    return "wrist.stiffness" in study.values()


def admit(study: Study) -> None:
    """Refuse a study that cannot be diagnosed.

    Raises:
        InputError: the first reason.
    """
    for refusal in of_study(study):
        raise refusal
    if has_wrist(study):
        for trial in study.trials:
            for refusal in wrist_trial(study, study.recording(trial)):
                raise refusal


def of_study(study: Study) -> Iterator[InputError]:
    """Why no diagnosis can be made, of what shows without the recordings of a wrist's trials."""
    if not has_wrist(study):
        from spacerobot.diagnosis.models.choose import some_models_for  # takes half a second to load

        try:
            some_models_for(study)
        except InputError as error:
            yield error
    elif len(study.trials) < 2:
        yield InputError("a diagnosis needs at least two trials", given=len(study.trials), where=str(study.path))


def of_trial(study: Study, recording: Recording) -> Iterator[InputError]:
    """As `wrist_trial`, for any study; other machines are asked as a whole."""
    return wrist_trial(study, recording) if has_wrist(study) else iter(())


def wrist_trial(study: Study, recording: Recording) -> Iterator[InputError]:
    """Why a trial of a wrist rig cannot be fitted: no track, no noise to weigh it by, no simulation as believed."""
    where = recording.trial.where or str(study.path)
    shown = readable(study)
    used = [s for s in recording.outputs() if s.name in shown]
    refused = [r for r in map(weighable, used) if r is not None]
    if TRACK not in {s.name for s in used}:
        valid = "a stream with target.x in every trial"
        yield InputError("a trial without target.x has no start", given=recording.trial.id, valid=valid, where=where)
    elif recording[TRACK].valid.sum() < LEAST:
        given = f"{recording[TRACK].valid.sum()} in trial {recording.trial.id}"
        yield InputError("target.x has too few readings", given=given, valid=f"at least {LEAST}", where=where)
    elif refused:
        for what, valid in refused:
            yield InputError(f"{what} in trial {recording.trial.id}", valid=valid, where=where)
    else:
        yield from _simulated(study, recording, where)


def weighable(series: Series) -> tuple[str, str] | None:
    """Why a channel has no weight in a fit, and what would give it one; None where it has."""
    if math.isfinite(series.sigma) and series.sigma > 0.0:
        return None
    value = series.good()[1]
    flat = value.size > 0 and np.ptp(value) == 0.0
    why = f"is {value[0]:g} throughout" if flat else f"has {value.size} readings"
    return f"{series.name} {why}, so that its noise cannot be estimated", f"its sigma in [streams.{series.stream}]"


def left_aside(study: Study) -> tuple[str, ...]:
    """Channels that were recorded as readings, and that no model of a wrist rig predicts."""
    if not has_wrist(study):
        return ()
    shown = readable(study)
    used = {name for trial in study.trials for name in trial.sources}
    every = (c for s in study.streams.values() if s.name in used for c in s.channels if c.use == "output")
    return tuple(dict.fromkeys(c.name for c in every if c.name not in shown and not c.name.endswith(".reference")))


def _simulated(study: Study, recording: Recording, where: str) -> Iterator[InputError]:
    """Whether the rig as believed can be simulated from the trial's start."""
    alone = replace(study, trials=(recording.trial,))  # else each trial would look through all the others
    trial = one_trial(alone, recording, readable(alone))
    try:
        model = RigModel(alone, (trial,))
        values = {**model.base, **model.believed.unknown, **trial.overrides}
        start = np.array([n.guess for n in model.nuisances(trial)])
        shown = model.predict(model.mechanism(values), trial, start)
    except SpacerobotError as error:
        yield InputError(f"the rig as believed cannot be simulated in trial {trial.id}: {error}", where=where)
    else:
        if not all(np.isfinite(block).all() for block in shown.blocks):
            yield InputError(f"the rig as believed leaves every bound in trial {trial.id}", where=where)
