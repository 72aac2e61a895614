"""The next trial that would tell two explanations of a part apart: variants of what was recorded, under both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

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
from spacerobot.support.errors import InputError, SimulationError

FACTORS = (0.5, 2.0, 3.0)
"""By how much a speed, a drive or a mass is changed."""

LONGER = 1.5
"""By how much a trial is lengthened."""

TRIALS = 6
"""Recorded pieces that are varied, evenly over all."""


@dataclass(frozen=True, eq=False)
class Variant:
    """A trial as it might be recorded next.

    Attributes:
        change: what is different, by name.
        model: that predicts it.
        rates: factor on the initial speeds.
        masses: factor on the moving mass.
        longer: factor on its length.
    """

    change: Mapping[str, float | str]
    model: Model
    rates: float = 1.0
    masses: float = 1.0
    longer: float = 1.0


def next_trial(part: Part) -> NextExperiment | None:
    """The variant under which the chosen explanation and its best rival differ most.

    Returns:
        change, separates, why and part; None where there is no rival, or no variant of the part's trials is known.
    """
    if not part.rivals:
        return None
    rival = min(part.rivals, key=lambda c: c.error)
    if contains(rival.label, part.chosen.label):
        rival = Candidate(least_alike(rival.fit))
    pair = (part.chosen, rival)
    here = _distance(part, pair, Variant({}, part.model))
    best, most = None, here or 0.0
    for variant in _variants(part.model):
        distance = _distance(part, pair, variant)
        if distance is not None and distance > most:
            best, most = variant, distance
    if best is None:
        return None
    return NextExperiment(
        part=part.name,
        change=dict(best.change),
        separates=[placed(c.label) for c in pair],
        why=f"such trials would separate the two by {most:.1f} sigmas of what the better one leaves over, "
        f"against {here or 0.0:.1f} for trials like those recorded",
    )


def _variants(model: Model) -> Iterator[Variant]:
    if isinstance(model, InverseDynamics):
        for factor in FACTORS:
            yield Variant({"speed": f"{factor:g} times that of the recorded motion"}, model.faster(factor))
    if isinstance(model, Simulated):
        driven = {t: d for t, d in model.drives.items() if d.value}
        for factor in FACTORS:
            if driven:
                other = copy(model)
                other.drives = {t: _scaled(d, factor) for t, d in driven.items()}
                yield Variant({"drive": f"{factor:g} times the recorded one"}, other, factor)
            else:
                yield Variant({"initial speed": f"{factor:g} times the recorded one"}, model, rates=factor)
            if "body.mass" in model.trials[0].overrides or ("body.mass" in model.base and not model.relative_to):
                yield Variant({"mass": f"{factor:g} times, with the same shape"}, model, masses=factor)
        if not driven:
            yield Variant({"length of the trial": f"{LONGER:g} times the recorded one"}, model, longer=LONGER)


def _scaled(drive: Drive, factor: float) -> Drive:
    return replace(drive, value={c: factor * v for c, v in drive.value.items()})


def _distance(part: Part, pair: tuple[Candidate, Candidate], variant: Variant) -> float | None:
    """How far the two explanations are apart over some of the trials; the trials' own starts stay as the first has
    them, so that what a start can absorb counts as well.
    """
    total = 0.0
    for trial in part.trials[:: max(1, len(part.trials) // TRIALS)]:
        changed = _changed(trial, variant)
        shown = []
        try:
            for candidate in pair:
                fit = candidate.fit
                start = pair[0].fit.trials[trial.id].initial.copy()
                rates = [n.rate for n in part.model.nuisances(trial)]
                start[np.array(rates, dtype=bool)] *= variant.rates
                mechanism = variant.model.trial_mechanism(fit.hypothesis, fit.z, changed)
                shown.append(variant.model.predict(mechanism, changed, start).blocks)
        except (SimulationError, InputError):
            return None
        for a, b, block in zip(*shown, changed.blocks, strict=True):
            total += float((((a - b) * block.weight) ** 2).sum())
    return float(np.sqrt(total))


def _changed(trial: TrialData, variant: Variant) -> TrialData:
    overrides = {n: v * (variant.masses if n == "body.mass" else 1.0) for n, v in trial.overrides.items()}
    if variant.masses != 1.0 and "body.mass" not in overrides:
        overrides["body.mass"] = variant.model.base["body.mass"] * variant.masses
    end = trial.start + variant.longer * (trial.end - trial.start)
    blocks = tuple(replace(b, time=trial.start + variant.longer * (b.time - trial.start)) for b in trial.blocks)
    return replace(trial, overrides=overrides, end=end, blocks=blocks)
