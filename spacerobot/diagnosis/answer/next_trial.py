"""The next trial that would tell two explanations apart: variants of what was recorded, simulated under both."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.answer.record import NextExperiment, placed
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.contract import Machine, Variant
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.nested_laws import least_alike
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.support.errors import InputError, SimulationError

TRIALS = 6
"""Recorded pieces of a part that are varied, evenly over all."""

MARKER = {"hand.x": "a marker on the hand"}
"""What a lab with a wrist may add where no other trial tells more."""

Starts = Mapping[str, np.ndarray]
"""By trial, initial values, shape (N,)."""


def next_trial_of_rig(machine: Machine, trials: Sequence[TrialData], fits: Sequence[Fit]) -> NextExperiment | None:
    """The change of speed and mass under which the two best explanations of a rig differ most, in sensor sigmas.

    Args:
        machine: the rig.
        trials: what was recorded; its middle trial is varied.
        fits: the explanations, best first.

    Returns:
        None for fewer than two explanations.
    """
    if len(fits) < 2:
        return None
    trial = trials[len(trials) // 2]
    starts = {trial.id: np.array([n.guess for n in machine.nuisances(trial)])}
    best, most, here = furthest(fits[:2], machine, [trial], starts)
    return NextExperiment(
        change=dict(MARKER if best is None else best.change),
        separates=[placed(f.hypothesis.label) for f in fits[:2]],
        why=f"one such trial would separate the two by {most:.1f} sensor sigmas in all, "
        f"against {here:.1f} for a trial like those recorded",
    )


def next_trial_of_part(part: Part) -> NextExperiment | None:
    """The variant under which the chosen explanation of a part and its best rival differ most.

    Returns:
        None where there is no rival, or no variant of the part's trials tells more than these do.
    """
    if not part.rivals:
        return None
    rival = min(part.rivals, key=lambda c: c.error)
    if contains(rival.label, part.chosen.label):
        rival = Candidate(least_alike(rival.fit))
    pair = (part.fit, rival.fit)
    trials = part.trials[:: max(1, len(part.trials) // TRIALS)]
    best, most, here = furthest(pair, part.model, trials, part.fit.initials())
    if best is None:
        return None
    return NextExperiment(
        part=part.name,
        change=dict(best.change),
        separates=[placed(f.hypothesis.label) for f in pair],
        why=f"such trials would separate the two by {most:.1f} sigmas of what the better one leaves over, "
        f"against {here:.1f} for trials like those recorded",
    )


def furthest(
    pair: Sequence[Fit], machine: Machine, trials: Sequence[TrialData], starts: Starts
) -> tuple[Variant | None, float, float]:
    """The variant under which two explanations differ most, by how much, and by how much they do as recorded.

    None where no variant tells more than the trials as they are.
    """
    here = apart(pair, Variant({}, machine), trials, starts) or 0.0
    best, most = None, here
    for variant in machine.variants(trials[0]):
        distance = apart(pair, variant, trials, starts)
        if distance is not None and distance > most:
            best, most = variant, distance
    return best, most, here


def apart(pair: Sequence[Fit], variant: Variant, trials: Iterable[TrialData], starts: Starts) -> float | None:
    """How far two explanations are apart over some trials, in the trials' own weights; None where one cannot be run.

    Both begin alike, so that what a start can absorb counts as well.
    """
    total, machine = 0.0, variant.machine
    for recorded in trials:
        trial, start = _changed(variant, recorded), starts[recorded.id].copy()
        start[np.array([n.rate for n in machine.nuisances(recorded)], dtype=bool)] *= variant.rates
        try:
            shown = [
                machine.predict(machine.trial_mechanism(f.hypothesis, f.z, trial), trial, start).blocks for f in pair
            ]
        except (SimulationError, InputError):
            return None
        for a, b, block in zip(*shown, trial.blocks, strict=True):
            total += float((((a - b) * block.weight) ** 2).sum())
    return float(np.sqrt(total))


def _changed(variant: Variant, trial: TrialData) -> TrialData:
    masses, longer = variant.masses, variant.longer
    if masses != 1.0:
        name = variant.machine.free_mass
        known = trial.overrides[name] if name in trial.overrides else variant.machine.base[name]
        trial = replace(trial, overrides={**trial.overrides, name: masses * known})
    if longer != 1.0:
        end = trial.start + longer * (trial.end - trial.start)
        blocks = tuple(replace(b, time=trial.start + longer * (b.time - trial.start)) for b in trial.blocks)
        trial = replace(trial, end=end, blocks=blocks)
    return trial
