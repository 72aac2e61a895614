"""The next trial that would tell two explanations apart: each candidate trial simulated under both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.answer.record import NextExperiment, placed
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.support.errors import InputError, SimulationError

SPEEDS = (0.5, 1.0, 2.0, 3.0)
MASSES = (0.5, 1.0, 2.0)


def next_experiment(model: RigModel, trials: Sequence[TrialData], fits: Sequence[Fit]) -> NextExperiment | None:
    """The change of speed and mass under which the two best explanations differ most, in sensor sigmas.

    Args:
        model: of the rig.
        trials: what was recorded; candidates are its last trial with other speeds and target masses.
        fits: the explanations, best first.

    Returns:
        change, separates and why; None for fewer than two explanations.
    """
    if len(fits) < 2:
        return None
    trial = trials[len(trials) // 2]
    here = _distance(model, trial, fits, 1.0, 1.0)
    best = (0.0, 1.0, 1.0)
    for mass in MASSES:
        for speed in SPEEDS:
            distance = _distance(model, trial, fits, speed, mass)
            if distance is not None and distance > best[0]:
                best = (distance, speed, mass)
    distance, speed, mass = best
    names = [n for n in model.nuisances(trial) if n.rate and n.coordinate == "target"]
    change: dict[str, float | str] = {}
    if names and speed != 1.0:
        change["target.speed_m_s"] = float(f"{abs(names[0].guess) * speed:.3g}")
    if mass != 1.0 and "target.mass" in trial.overrides:
        change["target.mass"] = float(f"{trial.overrides['target.mass'] * mass:.4g}")
    if not change:
        change["hand.x"] = "a marker on the hand"
    return NextExperiment(
        change=change,
        separates=[placed(f.hypothesis.label) for f in fits[:2]],
        why=f"one such trial would separate the two by {distance:.1f} sensor sigmas in all, "
        f"against {0.0 if here is None else here:.1f} for a trial like those recorded",
    )


def _distance(model: RigModel, trial: TrialData, fits: Sequence[Fit], speed: float, mass: float) -> float | None:
    overrides = dict(trial.overrides)
    if "target.mass" in overrides:
        overrides["target.mass"] *= mass
    initial = np.array([n.guess * speed if n.rate else n.guess for n in model.nuisances(trial)])
    changed = replace(trial, overrides=overrides)
    shown = []
    try:
        for fit in fits[:2]:
            mechanism = model.trial_mechanism(fit.hypothesis, fit.z, changed)
            shown.append(model.predict(mechanism, changed, initial).blocks)
    except (SimulationError, InputError):
        return None
    total = 0.0
    for a, b, block in zip(shown[0], shown[1], trial.blocks, strict=True):
        total += float((((a - b) * block.weight) ** 2).sum())
    return float(np.sqrt(total))
