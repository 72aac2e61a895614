"""The next trial that would tell two explanations of a part apart: variants of what was recorded, under both."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.answer.next_trial import Play, Variant, apart, furthest
from spacerobot.diagnosis.answer.record import NextExperiment, placed
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.machine import Model
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.windows import Drive
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.nested_laws import least_alike
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData

FACTORS = (0.5, 2.0, 3.0)
"""By how much a speed, a drive or a mass is changed."""

LONGER = 1.5
"""By how much a trial is lengthened."""

TRIALS = 6
"""Recorded pieces that are varied, evenly over all."""


def next_trial(part: Part) -> NextExperiment | None:
    """The variant under which the chosen explanation and its best rival differ most.

    Returns:
        None where there is no rival, or no variant of the part's trials is known.
    """
    if not part.rivals:
        return None
    rival = min(part.rivals, key=lambda c: c.error)
    if contains(rival.label, part.chosen.label):
        rival = Candidate(least_alike(rival.fit))
    pair = (part.fit, rival.fit)
    here = apart(pair, _plays(part, part.model)) or 0.0
    best, most = furthest(pair, _variants(part, part.model), here)
    if best is None:
        return None
    return NextExperiment(
        part=part.name,
        change=dict(best.change),
        separates=[placed(f.hypothesis.label) for f in pair],
        why=f"such trials would separate the two by {most:.1f} sigmas of what the better one leaves over, "
        f"against {here:.1f} for trials like those recorded",
    )


def _variants(part: Part, model: Model) -> Iterator[Variant]:
    if isinstance(model, InverseDynamics):
        for factor in FACTORS:
            change = {"speed": f"{factor:g} times that of the recorded motion"}
            yield Variant(change, _plays(part, model.faster(factor)))
    if isinstance(model, Simulated):
        driven = {t: d for t, d in model.drives.items() if d.value}
        for factor in FACTORS:
            if driven:
                other = copy(model)
                other.drives = {t: _scaled(d, factor) for t, d in driven.items()}
                yield Variant({"drive": f"{factor:g} times the recorded one"}, _plays(part, other, rates=factor))
            else:
                change = {"initial speed": f"{factor:g} times the recorded one"}
                yield Variant(change, _plays(part, model, rates=factor))
            if "body.mass" in model.trials[0].overrides or ("body.mass" in model.base and not model.relative_to):
                change = {"mass": f"{factor:g} times, with the same shape"}
                yield Variant(change, _plays(part, model, masses=factor))
        if not driven:
            change = {"length of the trial": f"{LONGER:g} times the recorded one"}
            yield Variant(change, _plays(part, model, longer=LONGER))


def _scaled(drive: Drive, factor: float) -> Drive:
    return replace(drive, value={c: factor * v for c, v in drive.value.items()})


def _plays(part: Part, model: Model, rates: float = 1.0, masses: float = 1.0, longer: float = 1.0) -> list[Play]:
    """Some of the part's pieces, from the chosen explanation's starts.

    Args:
        part: whose.
        model: that predicts them.
        rates: factor on the initial speeds.
        masses: factor on the moving mass.
        longer: factor on their length.
    """
    out: list[Play] = []
    for trial in part.trials[:: max(1, len(part.trials) // TRIALS)]:
        start = part.fit.trials[trial.id].initial.copy()
        start[np.array([n.rate for n in part.model.nuisances(trial)], dtype=bool)] *= rates
        out.append((model, _changed(model, trial, masses, longer), start))
    return out


def _changed(model: Model, trial: TrialData, masses: float, longer: float) -> TrialData:
    overrides = {n: v * (masses if n == "body.mass" else 1.0) for n, v in trial.overrides.items()}
    if masses != 1.0 and "body.mass" not in overrides:
        overrides["body.mass"] = model.base["body.mass"] * masses
    end = trial.start + longer * (trial.end - trial.start)
    blocks = tuple(replace(b, time=trial.start + longer * (b.time - trial.start)) for b in trial.blocks)
    return replace(trial, overrides=overrides, end=end, blocks=blocks)
