"""The next trial that would tell two explanations apart: variants of what was recorded, simulated under both."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from msgspec import UNSET, UnsetType

from spacerobot.diagnosis.answer.record import NextExperiment, placed
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.contract import Machine, Variant
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.support.errors import InputError, SimulationError

WHY_RIG = (
    "one such trial would separate the two by {most:.1f} sensor sigmas in all, "
    "against {here:.1f} for a trial like those recorded"
)
WHY_PART = (
    "such trials would separate the two by {most:.1f} sigmas of what the better one leaves over, "
    "against {here:.1f} for trials like those recorded"
)

Starts = Mapping[str, np.ndarray]
"""By trial, initial values, shape (N,)."""


def next_trial(
    pair: Sequence[Fit],
    machine: Machine,
    trials: Sequence[TrialData],
    starts: Starts,
    *,
    why: str,
    part: str | UnsetType = UNSET,
) -> NextExperiment | None:
    """The variant of some trials under which two explanations differ most.

    Args:
        pair: the explanations, the better one first.
        machine: both are of it.
        trials: as recorded.
        starts: from which they are simulated.
        why: what is said of the distances `most` and `here`, one of those above.
        part: of what, where the machine is one of several.

    Returns:
        None where nothing tells more than these trials do, and the machine knows no other measurement either.
    """
    best, most, here = furthest(pair, machine, trials, starts)
    change = machine.otherwise if best is None else best.change
    if not change:
        return None
    return NextExperiment(
        change=dict(change),
        separates=[placed(f.hypothesis.label) for f in pair],
        why=why.format(most=most, here=here),
        part=part,
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
