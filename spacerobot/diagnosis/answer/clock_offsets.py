"""By how much a stream's own clock is ahead in each trial of a wrist rig, as the fit has it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from spacerobot.diagnosis.answer.record import ClockOffset, Value
from spacerobot.diagnosis.fitting.fitted import NORMAL_95, Fit
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.contract import CLOCK
from spacerobot.diagnosis.terms.alignment import TRACK
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.recordings.study import Study

WHY = "the touch shows on both, and the fit to all readings places it"


def clock_offsets(study: Study, workshop: Workshop, fit: Fit, inflation: float) -> list[ClockOffset]:
    """An entry for each trial and clock that is not the track's; positive: its readings are late.

    Args:
        study: whose recordings.
        workshop: that made the fit.
        fit: what is reported.
        inflation: by which the noise is larger, or less independent, than white noise as stated.
    """
    if not any(b.clock for t in workshop.trials for b in t.blocks):
        return []
    errors = own_errors(workshop, fit)
    return [
        one
        for trial in workshop.trials
        for one in _of_trial(study, workshop, fit, trial, np.sqrt(inflation) * errors[trial.id])
    ]


def own_errors(workshop: Workshop, fit: Fit) -> dict[str, np.ndarray]:
    """Standard errors of each trial's own numbers, all others marginalised, shape (N,) in their own units."""
    fitter, rows = workshop.fitter(), workshop.fitter().rows_at(fit)
    prior = fit.hypothesis.precision
    # a reading that was left out has no residual
    counted = [rows[t.id] * (fit.trials[t.id].residual != 0.0)[:, None] for t in fitter.trials]
    normal = Normal.build(counted, [fit.trials[t.id].residual for t in fitter.trials], fit.z, prior)
    shared = normal.covariance()
    out = {}
    for trial, (inner, cross, _) in zip(fitter.trials, normal.own, strict=True):
        passed_on = np.linalg.solve(inner, cross)
        variance = np.diag(np.linalg.inv(inner)) + np.einsum("ng,gh,nh->n", passed_on, shared, passed_on)
        scales = np.array([n.scale for n in workshop.model.nuisances(trial)])
        out[trial.id] = scales * np.sqrt(np.maximum(variance, 0.0))
    return out


def _of_trial(
    study: Study, workshop: Workshop, fit: Fit, trial: TrialData, errors: np.ndarray
) -> Iterator[ClockOffset]:
    recording = study.recording(trial.recorded)
    track = recording[TRACK]
    nuisances = workshop.model.nuisances(trial)
    for nuisance, value, error in zip(nuisances, fit.trials[trial.id].initial, errors, strict=True):
        own = [b for b in trial.blocks if nuisance.coordinate == CLOCK + b.clock]
        if not own:
            continue
        taken_off = recording.epoch.get(own[0].clock, 0.0) - recording.epoch.get(track.clock, 0.0)
        late, half = own[0].late + float(value) + taken_off, NORMAL_95 * float(error)
        yield ClockOffset(
            effect="time_offset",
            where=own[0].stream,
            trial=trial.id,
            against=track.stream,
            parameters={"delay_s": Value(value=late, ci95=(late - half, late + half), unit="s")},
            why=WHY,
        )
