"""Where fits of what lets something move by itself begin: at the resonances that recordings ask for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.fitting.screen import At, Screener
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site

SHARES = (0.5, 0.2, 0.8)
"""Of a body's inertia, as what may move by itself; the first at every frequency."""

NEAR = 2.0
"""Factor on the best frequency of the first share within which the others' are: from a resonance of a body held still
to that of one that is free beside four times its inertia."""

ROW = 1.2
"""Ratio of neighbouring frequencies: as wide as a resonance of this damping ratio is."""

RATIO = 0.1
"""Damping ratio at which they are tried, well below what still swings."""

FASTEST = 2.5
"""Cycles between two readings: faster ones, which the readings cannot follow, show by what they take of the inertia."""


def starts(screener: Screener, at: At, site: Site) -> list[dict[str, float]]:
    """For each share of what moves there, values at the frequency after which least would be left over.

    A resonance is nothing like a faint one, nor like one a factor away: every frequency that the trials could show is
    tried at full size. Where the study leaves the inertia open, it is tried as the fit has it and, since above its
    resonance a motor moves without its link, as if that were the motor's alone.
    """
    machine = screener.fitter.model
    fit, trials = at.fit, screener.fitter.trials
    inertia = machine.trial_mechanism(fit.hypothesis, fit.z, trials[0]).coordinates[site.where].mass
    key, every, found = f"{site.where}.mass", frequencies(trials), []
    for alone in (False, True) if key in machine.believed.unknown else (False,):
        row = every
        for share in SHARES:
            known = {key: inertia / (1.0 - share)} if alone else {}
            tried = [_values(site, share * known.get(key, inertia), f) | known for f in row]
            left = [_left(screener, at, site, start) for start in tried]
            best = int(np.argmin(left))
            if left[best] < np.inf:
                found.append(tried[best])
                row = row[(row >= row[best] / NEAR) & (row <= row[best] * NEAR)]
    return found


def frequencies(trials: Sequence[TrialData]) -> np.ndarray:
    """From a cycle in the longest trial to the fastest that may show in its readings, shape (F,) [Hz]."""
    slowest = 1.0 / max(t.end - t.start for t in trials)
    gaps = [float(np.median(np.diff(b.time))) for t in trials for b in t.blocks if b.time.size > 1]
    fastest = max(FASTEST / min(gaps), slowest)
    return np.geomspace(slowest, fastest, 1 + round(math.log(fastest / slowest) / math.log(ROW)))


def _values(site: Site, inertia: float, frequency: float) -> dict[str, float]:
    own = site.effect.swinging(inertia, 2.0 * math.pi * frequency, RATIO)
    return {site.key(name): value for name, value in own.items()}


def _left(screener: Screener, at: At, site: Site, start: Mapping[str, float]) -> float:
    """What would be left over of chi-squared; infinite where it cannot be simulated."""
    left = screener.left_with(at, site, start)
    return np.inf if left is None else float(left @ left)
