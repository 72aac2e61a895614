"""How far believed values may be off, as errors of the balances: what a wrong value within its sigma would do."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.locate.balances import Balance
from spacerobot.diagnosis.machines.contract import Baseline
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed

STEP = 1e-3
"""Relative step of the differences; the balances are almost linear in the values."""

FREE = 3.0
"""A value that is not stated, or whose job is to absorb what is left out, counts as wrong by this many times itself."""


def believed_values(model: Baseline, trial: TrialData) -> dict[str, float]:
    """The values as believed, the trial's overrides on top."""
    return {**model.believed.unknown, **model.base, **trial.overrides}


def deviations(believed: Believed, values: Mapping[str, float], trials: Sequence[TrialData]) -> dict[str, float]:
    """Standard deviation of each value, in its own unit, as one trial's balances must allow for it.

    A value that all n trials share is given sqrt(n) times its sigma in each as if independent: a pattern's mean over
    the trials is then allowed exactly the shared deviation.

    Args:
        believed: what the study says.
        values: of the trial.
        trials: all of the study.
    """
    shared = math.sqrt(len(trials))
    counts = [sum(t.condition == c for t in trials) for c in dict.fromkeys(t.condition for t in trials)]
    alike = math.sqrt(max(counts, default=1))
    squares: dict[str, float] = {}
    for name, sigma in believed.sigma.items():
        if name in values and name not in believed.absorbing:
            squares[name] = (shared * sigma * values[name]) ** 2
    for name, size in believed.absolute.items():
        if name in values:
            squares[name] = (shared * size) ** 2
    for name, sigma in believed.scatter.items():
        if name in values:
            squares[name] = squares.get(name, 0.0) + (alike * sigma * values[name]) ** 2
    for name in (*believed.unknown, *believed.absorbing):
        if name in values:
            size = max(abs(values[name]), abs(believed.values.get(name, believed.unknown.get(name, 0.0))))
            squares[name] = (FREE * size) ** 2
    return {name: math.sqrt(s) for name, s in squares.items() if s > 0.0}


def directions(
    values: Mapping[str, float],
    sizes: Mapping[str, float],
    base: Mapping[str, Balance],
    rebuild: Callable[[Mapping[str, float]], Mapping[str, Balance]],
) -> dict[str, dict[str, np.ndarray]]:
    """Balance -> value's name -> change of the residual by one standard deviation, shape (I,).

    Args:
        values: of the trial.
        sizes: standard deviations, as from `deviations`.
        base: the trial's balances with these values.
        rebuild: the trial's balances with other values.
    """
    out: dict[str, dict[str, np.ndarray]] = {name: {} for name in base}
    for name, size in sizes.items():
        step = STEP * (abs(values[name]) or size)
        moved = rebuild({**values, name: values[name] + step})
        for balance, old in base.items():
            change = moved[balance].residual.value - old.residual.value
            if np.any(change):
                out[balance][name] = change * (size / step)
    return out
