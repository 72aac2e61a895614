"""The next trial that would tell two explanations apart: each candidate trial simulated under both."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.answer.record import NextExperiment, placed
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.support.errors import InputError, SimulationError

SPEEDS = (0.5, 1.0, 2.0, 3.0)
MASSES = (0.5, 1.0, 2.0)
"""Factors on what was recorded."""

Play = tuple[Machine, TrialData, np.ndarray]
"""A trial to simulate, on which machine and from which start, shape (N,)."""


@dataclass(frozen=True, eq=False)
class Variant:
    """Trials as they might be recorded next.

    Attributes:
        change: what is different, by name.
        plays: what is simulated.
    """

    change: Mapping[str, float | str]
    plays: Sequence[Play]


def furthest(pair: Sequence[Fit], variants: Iterable[Variant], least: float = 0.0) -> tuple[Variant | None, float]:
    """The variant under which two explanations differ most, and by how much; none where all differ by less."""
    best, most = None, least
    for variant in variants:
        distance = apart(pair, variant.plays)
        if distance is not None and distance > most:
            best, most = variant, distance
    return best, most


def apart(pair: Sequence[Fit], plays: Sequence[Play]) -> float | None:
    """How far two explanations are apart over some trials, in the trials' own weights; None where one cannot be run.

    Both begin alike, so that what a start can absorb counts as well.
    """
    total = 0.0
    for machine, trial, start in plays:
        try:
            shown = [
                machine.predict(machine.trial_mechanism(f.hypothesis, f.z, trial), trial, start).blocks for f in pair
            ]
        except (SimulationError, InputError):
            return None
        for a, b, block in zip(*shown, trial.blocks, strict=True):
            total += float((((a - b) * block.weight) ** 2).sum())
    return float(np.sqrt(total))


def next_trial_of_rig(model: RigModel, trials: Sequence[TrialData], fits: Sequence[Fit]) -> NextExperiment | None:
    """The change of speed and mass under which the two best explanations differ most, in sensor sigmas.

    Args:
        model: of the rig.
        trials: what was recorded; candidates are its middle trial with other speeds and target masses.
        fits: the explanations, best first.

    Returns:
        None for fewer than two explanations.
    """
    if len(fits) < 2:
        return None
    trial = trials[len(trials) // 2]
    best, distance = furthest(fits[:2], _variants(model, trial))
    here = apart(fits[:2], _plain(model, trial, 1.0))
    return NextExperiment(
        change=dict(best.change) if best is not None and best.change else {"hand.x": "a marker on the hand"},
        separates=[placed(f.hypothesis.label) for f in fits[:2]],
        why=f"one such trial would separate the two by {distance:.1f} sensor sigmas in all, "
        f"against {0.0 if here is None else here:.1f} for a trial like those recorded",
    )


def _variants(model: RigModel, trial: TrialData) -> Iterator[Variant]:
    """The trial with another target at other speeds; what is not stated of it cannot be changed."""
    known = trial.overrides.get("target.mass")
    rates = [n.guess for n in model.nuisances(trial) if n.rate and n.coordinate == "target"]
    for mass in MASSES:
        other = trial if known is None else replace(trial, overrides={**trial.overrides, "target.mass": known * mass})
        for speed in SPEEDS:
            change: dict[str, float | str] = {}
            if rates and speed != 1.0:
                change["target.speed_m_s"] = float(f"{abs(rates[0]) * speed:.3g}")
            if known is not None and mass != 1.0:
                change["target.mass"] = float(f"{known * mass:.4g}")
            yield Variant(change, _plain(model, other, speed))


def _plain(model: RigModel, trial: TrialData, speed: float) -> list[Play]:
    return [(model, trial, np.array([n.guess * speed if n.rate else n.guess for n in model.nuisances(trial)]))]
