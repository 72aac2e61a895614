"""The period with which a force at a port repeats along its way: teeth, poles, the pitch of a screw."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.screen import FAINT, Screener
from spacerobot.diagnosis.learning.ground import Ground, visited
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.formula import Formula, FormulaLaw

FEWEST, MOST = 2.0, 40.0
"""Periods that a range holds: fewer do not repeat, and more are finer than the test functions that see them."""

STEP = 0.5
"""In periods of the range: half of what tells two waves apart along it."""

A_TURN = 72
"""Waves a turn that are tried where a joint goes round."""


def period(ground: Ground, beside: Fit, port: str, turns: bool) -> float | None:
    """The length [m or rad] of the wave that takes most of what a fit leaves over; None where the way is too short.

    Args:
        ground: of the trials.
        beside: the fit, whose free parameters take what they can of each wave.
        port: where.
        turns: whether what moves there is an angle: once it goes round, whole waves fit into a turn.
    """
    seen = visited(ground, beside, port)
    low, high = seen["d"]
    reach = high - low
    if not reach > 0.0:
        return None
    gain = _gains(ground, beside, port, low, high, ground.model.typical_law(port, seen)[0])
    if turns and reach > 2.0 * math.pi:
        lengths = [2.0 * math.pi / n for n in range(1, A_TURN + 1)]
        return max(lengths, key=gain)
    counts = np.arange(FEWEST, MOST + STEP, STEP)
    found = [gain(reach / n) for n in counts.tolist()]
    from scipy.optimize import minimize_scalar

    best = float(counts[int(np.argmax(found))])
    ends = max(best - STEP, FEWEST), min(best + STEP, MOST)
    finer = minimize_scalar(lambda n: -gain(reach / n), bounds=ends, method="bounded", options={"maxiter": 20})
    return reach / float(finer.x)


def _gains(ground: Ground, beside: Fit, port: str, low: float, high: float, push: float) -> Callable[[float], float]:
    """Length of a wave -> by how much chi-squared falls with it, to first order."""
    site = Site(FormulaLaw(Formula("force", "d", low, high, (("wave", push),))), port)
    screener = Screener(Fitter(ground.model, ground.trials), ground.model.believed, plain=True)
    at = screener.at(beside, robust=False)
    left = at.residual

    def gain(length: float) -> float:
        columns = []
        for place in (0.0, 0.25 * length):
            numbers = {"a_1": FAINT * push, "a_1_place": low + place, "a_1_length": length}
            moved = screener.with_effect(beside, at.state, site, {site.key(k): v for k, v in numbers.items()})
            if moved is None:
                return 0.0
            columns.append(at.change(moved))
        rest = np.linalg.lstsq(np.stack(columns, axis=1), left, rcond=1e-9)
        fitted = np.stack(columns, axis=1) @ rest[0]
        return float(2.0 * left @ fitted - fitted @ fitted)

    return gain
