"""A fit's own checks, for any model; where one fails, nothing is concluded."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.selection.bench import STEPS
from spacerobot.diagnosis.selection.check import Check, agreed
from spacerobot.diagnosis.selection.checks import SLACK, calibration, copied
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.support.errors import SimulationError

AWAY = 0.5
"""A refit begins with every strength at this share of its value."""


def checks_of(part: Part) -> tuple[Check, ...]:
    """Whether more freedom costs more, and whether a synthetic copy of the chosen model is fitted as well as it is."""
    fit = part.fit
    if not fit.hypothesis.sites:
        return ()
    base = part.growth.before.fit
    nested = Check(
        f"nested cost, {part.name}",
        bool(fit.cost <= base.cost + SLACK),
        f"chi-squared {fit.cost:.1f} as chosen, {base.cost:.1f} without any effect",
    )
    return nested, *agreed(lambda copy: synthetic(part, fit, copy))


def synthetic(part: Part, fit: Fit, copy: int) -> tuple[Check, ...]:
    """On a copy of the trials made from the chosen model, a fit from afar ends no worse than the truth, and near it.

    The copies' noise is always the same: what is concluded hangs on no seed.
    """
    name = f"cost at truth, {part.name}"
    trials = copied(part.model, part.trials, fit, copy)
    fitter = Fitter(part.model, trials)
    state = fitter.state(fit.hypothesis, fit.z, fit.initials())
    try:
        again = fitter.fit(
            fit.hypothesis, warm=_away(fit), initials=fit.initials(), max_iterations=2 * STEPS, robust=False
        )
    except SimulationError:
        again = None
    if state is None or again is None:
        return (Check(name, False, "a synthetic copy could not be simulated"),)
    truth = state.chi2() + float(fit.z @ fit.hypothesis.precision @ fit.z)
    if again.cost > truth + SLACK:  # once more from where it ended, as fits that grow are
        with contextlib.suppress(SimulationError):
            more = fitter.fit(
                fit.hypothesis, warm=again.values(), initials=again.initials(), max_iterations=2 * STEPS, robust=False
            )
            again = more if more.cost < again.cost else again
    if again.cost > truth + SLACK:
        again = _careful(part, trials, again)
    cost = Check(
        name,
        bool(again.cost <= truth + SLACK),
        f"on a synthetic copy the fit costs {again.cost:.1f}, its truth {truth:.1f}",
    )
    sizes = calibration(fit, again, f"calibration, {part.name}")
    if not sizes.passed:
        sizes = calibration(fit, _careful(part, trials, again), sizes.name)
    return cost, sizes


def _careful(part: Part, trials: Sequence[TrialData], ended: Fit) -> Fit:
    """A fit taken to its last digit: differences to one side lead to a place beside the best one."""
    fitter = Fitter(part.model, trials, careful=True)
    with contextlib.suppress(SimulationError):
        return fitter.fit(
            ended.hypothesis, warm=ended.values(), initials=ended.initials(), max_iterations=STEPS, robust=False
        )
    return ended


def _away(fit: Fit) -> dict[str, float]:
    out = fit.values()
    for site in fit.hypothesis.sites:
        for parameter in site.effect.parameters:
            key = site.key(parameter.name)
            if not parameter.shape and not parameter.log and np.isfinite(parameter.null):
                out[key] = parameter.null + AWAY * (out[key] - parameter.null)
    return out
