"""What a diagnosis asks of a study before it begins: one door for `study check`, `overlay` and `diagnose`."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter

from spacerobot.diagnosis.machines.mechanism_cache import MOST
from spacerobot.diagnosis.machines.rig_channels import readable
from spacerobot.diagnosis.machines.whole_rig import rig_model
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.alignment import LEAST, TRACK, first_seen
from spacerobot.diagnosis.terms.data import TrialData, one_trial
from spacerobot.effects.mechanism import Mechanism
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, SpacerobotError

if TYPE_CHECKING:
    from spacerobot.diagnosis.machines.contract import Machine


def has_wrist(study: Study) -> bool:
    """Whether the study is of a wrist that meets a target; any other machine is diagnosed part by part."""
    return "wrist.stiffness" in study.values() or "wrist.stiffness" in study.baseline.unknown


def admit(study: Study) -> tuple[Machine, ...]:
    """Refuse a study that cannot be diagnosed; its machines where it can, but for a wrist's rig.

    Raises:
        InputError: the first reason.
    """
    refusals = of_study(study)
    try:
        raise next(refusals)
    except StopIteration as end:
        machines: tuple[Machine, ...] = end.value
    ask = questions(study)
    for trial in study.trials:
        for refusal in ask(study.recording(trial)):
            raise refusal
    return machines


def of_study(study: Study) -> Generator[InputError, None, tuple[Machine, ...]]:
    """Why no diagnosis can be made, of what shows without the recordings of a wrist's trials; then its machines."""
    models: tuple[Machine, ...] = ()
    yield from _filtered_by_none(study)
    if not has_wrist(study):
        from spacerobot.diagnosis.machines.choose import some_models_for  # takes half a second to load

        try:
            for trial in study.trials:
                enough(study, study.recording(trial))
            moving(study)
            models = some_models_for(study)
        except InputError as error:
            yield error
        else:
            from spacerobot.diagnosis.machines.doubted import found_by_none

            for model in models:
                yield from of_model(study, model)
            yield from found_by_none(study, (key for model in models for key in model.believed.zeros))
    elif len(study.trials) < 2:
        valid = "a second trial, which a fit to the first is tried on (hits in one recording: a `window` for each)"
        yield InputError(
            "a diagnosis needs at least two trials", given=len(study.trials), valid=valid, where=str(study.path)
        )
    return models


def _filtered_by_none(study: Study) -> Iterator[InputError]:
    """Why stated filters cannot all be taken in: a wrist's rig alone reads its channels through them."""
    shown = readable(study) if has_wrist(study) else frozenset()
    for spec in (c for s in study.streams.values() for c in s.channels):
        if spec.filter is not None and spec.name not in shown:
            what = f"the filter of {spec.name} is stated, and no machine of this study reads it through one"
            yield InputError(what, valid="a channel of a wrist rig, or no filter", where=spec.where)


def enough(study: Study, recording: Recording) -> None:
    """Refuse a trial in which a channel was hardly recorded.

    Raises:
        InputError: fewer readings than a line through them needs; of events, fewer than pieces to hold out in turn.
    """
    from spacerobot.diagnosis.machines.windows import PIECES

    for series in recording.values():
        least = PIECES if study.streams[series.stream].kind == "events" else LEAST
        count = int(series.valid.sum())
        if count < least and not series.name.startswith("aux."):
            given = f"{count} in trial {recording.trial.id}"
            where = recording.trial.where or str(study.path)
            raise InputError(f"{series.name} has too few readings", given=given, valid=f"at least {least}", where=where)


def moving(study: Study) -> None:
    """Refuse a reading that is the same from the first sample of the first trial to the last of the last.

    Raises:
        InputError: with the channel's line.
    """
    specs = [
        c for s in study.streams.values() for c in s.channels if c.use == "output" and not c.name.startswith("aux.")
    ]
    for spec in specs:
        values = [study.recording(t)[spec.name].good()[1] for t in study.trials if spec.name in study.recording(t)]
        if values and np.ptp(np.concatenate(values)) == 0.0:
            what = f"{spec.name} is {values[0][0]:g} throughout every trial, so that nothing can be weighed by it"
            raise InputError(
                what, valid="a sensor that was at work, or the study without the channel", where=spec.where
            )


def of_model(study: Study, model: Machine) -> Iterator[InputError]:
    """Why a machine's model cannot be fitted and tried: one piece of data, no weight, a sign against all others."""
    from spacerobot.diagnosis.selection.held_out import folds

    for piece in model.trials:
        for block in piece.blocks:
            for name, weight in zip(block.channels, block.weight, strict=True):
                if not np.isfinite(weight).all():
                    trial = study.trial(piece.recorded)
                    series = study.recording(trial).get(name)
                    what = f"{name} does not change, so that its noise cannot be estimated, in trial {trial.id}"
                    valid = f"its sigma in [streams.{block.stream if series is None else series.stream}]"
                    yield InputError(what, valid=valid, where=trial.where or str(study.path))
                    return
    what, mended = model.contradiction()
    if what:
        yield InputError(what, valid=mended, where=str(study.path))
    if len(folds(model.trials)) < 2:
        trial = study.trial(model.trials[0].recorded)
        what = f"{model.name} was recorded once, in one piece: nothing is left to try a fit on"
        where = trial.where or str(study.path)
        yield InputError(what, given=f"trial {trial.id}", valid="a second trial of it", where=where)


SHARE = 20
"""A wrist rests in the first of so many parts of a trial."""

DEEP = 0.8
"""Share of the wrist's way beyond which the target is still at it."""

GLITCH = 5
"""Readings whose median is taken: one or two that are lost say nothing of where it went."""

CLEARLY = 20.0
"""Sigmas by which it moves, if a zero is asked for: a wrist that nothing touched shows none."""

Questions = Callable[[Recording], Iterator[InputError]]
"""Asked of a recording: why it cannot be fitted."""


def questions(study: Study, *, to_draw: bool = False) -> Questions:
    """What is asked of each trial; nothing of the trials of other machines, which are asked as a whole.

    Args:
        study: whose trials.
        to_draw: only what a picture needs too: a picture shows best that a zero is elsewhere.
    """
    return WristDoor(study, to_draw).refusals if has_wrist(study) else lambda recording: iter(())


class WristDoor:
    """Asks trials of a wrist rig, one after the other, and keeps none: they share the rig as it is believed."""

    def __init__(self, study: Study, to_draw: bool = False) -> None:
        self._study, self._shown, self._to_draw = study, readable(study), to_draw
        self._models: dict[bool, RigModel] = {}
        self._mechanisms: dict[object, Mechanism] = {}

    def refusals(self, recording: Recording) -> Iterator[InputError]:
        """Why a trial cannot be fitted: no track, no noise to weigh it by, no simulation as believed."""
        where = recording.trial.where or str(self._study.path)
        used = [s for s in recording.outputs() if s.name in self._shown]
        refused = [r for r in map(weighable, used) if r is not None]
        if TRACK not in {s.name for s in used}:
            valid = "a stream with target.x in every trial"
            what = "a trial without target.x has no start"
            yield InputError(what, given=recording.trial.id, valid=valid, where=where)
        elif recording[TRACK].valid.sum() < LEAST:
            given = f"{recording[TRACK].valid.sum()} in trial {recording.trial.id}"
            yield InputError("target.x has too few readings", given=given, valid=f"at least {LEAST}", where=where)
        elif refused:
            for what, valid in refused:
                yield InputError(f"{what} in trial {recording.trial.id}", valid=valid, where=where)
        else:
            yield from self._simulated(recording, where)

    def _simulated(self, recording: Recording, where: str) -> Iterator[InputError]:
        """Whether the rig as believed can be simulated from the trial's start."""
        try:
            trial = one_trial(self._study, recording, self._shown)
        except InputError as error:
            yield error
            return
        if not self._to_draw:
            yield from misplaced(self._study, recording, where)
        try:
            model = self._model(trial)
            start = np.array([n.guess for n in model.nuisances(trial)])
            shown = model.predict(self._mechanism(model, trial), trial, start)
        except SpacerobotError as error:
            yield InputError(f"the rig as believed cannot be simulated in trial {trial.id}: {error}", where=where)
        else:
            if not all(np.isfinite(block).all() for block in shown.blocks):
                yield InputError(f"the rig as believed leaves every bound in trial {trial.id}", where=where)

    def _model(self, trial: TrialData) -> RigModel:
        """The rig in this trial."""
        sideways = "target.y" in trial.channels
        if sideways not in self._models:
            self._models[sideways] = rig_model(self._study, (trial,))
        return self._models[sideways].of(trial)

    def _mechanism(self, model: RigModel, trial: TrialData) -> Mechanism:
        """The rig as believed with the trial's overrides, made once for all trials that share them."""
        key = model.sideways, tuple(trial.overrides.items())
        if key not in self._mechanisms:
            if len(self._mechanisms) >= MOST:
                self._mechanisms.clear()
            self._mechanisms[key] = model.mechanism({**model.base, **model.believed.unknown, **trial.overrides})
        return self._mechanisms[key]


def misplaced(study: Study, recording: Recording, where: str) -> Iterator[InputError]:
    """Why a track cannot be laid over a rig: its zero is elsewhere than the rig's, by more than the wrist moves.

    The wrist's zero is where its spring is relaxed, the target's where it touches: there and then both read the same.
    Of a robot that moves, only the hand's own track tells how far the spring is pressed.
    """
    if TRACK not in recording:
        return
    if "wrist.x" not in recording:
        yield from _misplaced_track(recording, where)
        return
    if "hand.x" not in recording and (study.baseline.base, study.baseline.joints) != ("fixed", "locked"):
        return
    wrist, target = recording["wrist.x"], recording[TRACK]
    (time, place), (when, track) = wrist.good(), target.good()
    if place.size < LEAST or track.size < LEAST or not wrist.sigma > 0.0:
        return
    hand = np.interp(time, *recording["hand.x"].good()) if "hand.x" in recording else np.zeros_like(place)
    pressed = place - hand
    rest = float(np.median(pressed[: max(LEAST, place.size // SHARE)]))
    smooth = median_filter(pressed, GLITCH)
    moved = float(smooth.max()) - rest
    if moved < CLEARLY * wrist.sigma:
        return
    told = [(wrist, rest, "at rest")]
    if target.clock == wrist.clock:
        deep = smooth >= rest + DEEP * moved
        apart = float(np.median(np.interp(time[deep], when, track) - place[deep]))
        told.append((target, rest + apart, "when it touches"))
    for series, by, at in told:
        if abs(by) > moved:
            yield _elsewhere(recording, series, by, f"{at}, the wrist moves by {moved:.3g} m", where)


def _misplaced_track(recording: Recording, where: str) -> Iterator[InputError]:
    """The same of a track beside no wrist's, that keeps to one side of its zero: by where the target is when a force or
    a hand first shows the touch. A force that is late shows it further on, of a track that comes to its zero.
    """
    target = recording[TRACK]
    touch = first_seen([s for s in recording.values() if s.clock == target.clock])
    time, track = target.good()
    if touch is None or track.size < LEAST or not time[0] < touch < time[-1]:
        return
    smooth = median_filter(track, GLITCH)
    by = float(np.interp(touch, time, track))
    moved = float(smooth[time >= touch].max(initial=by)) - by
    aside = smooth.max() < 0.0 or smooth.min() > 0.0
    if aside and moved > CLEARLY * target.sigma and abs(by) > moved:
        yield _elsewhere(recording, target, by, f"when it touches, and goes on by {moved:.3g} m", where)


def _elsewhere(recording: Recording, series: Series, by: float, at: str, where: str) -> InputError:
    what = f"{series.name} reads {by:.4g} m {at}: its zero is elsewhere, in trial {recording.trial.id}"
    valid = f'0 m there: offset."{series.name}" = {-by:.4g} in the trial, or an offset on the channel'
    return InputError(what, valid=valid, where=where)


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
