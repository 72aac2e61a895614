"""How rough a curve is, and how loud its readings, by marginal likelihood, as far as the curve acts linearly.

What a smooth curve cannot follow counts as noise to it, and under so much noise it stays smooth: a search that finds
the one after the other, from the smooth side, ends there or takes long to leave. So all roughnesses are looked at, each
with the noise that it leaves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.noise import split
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.terms.data import TrialData

GRID = tuple(float(x) for x in 10.0 ** np.arange(-2.0, 1.26, 0.25))
"""Roughnesses that are looked at, in units of a curve's size; between them Fellner and Schall's rule finds it."""

TINY = 1e-150
"""Mean square that is as good as nothing, and has a logarithm."""

HEARINGS = 5
"""How often the noise is found again at each of them."""


@dataclass(frozen=True)
class Likeliest:
    """What the readings say of a curve.

    Attributes:
        factor: on its roughness.
        level: by channel, rms of what it leaves in units of the present noise.
    """

    factor: float
    level: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class _Sums:
    """Of a trial's channel: J'J, J'r, r'r and how many readings, under the present weights."""

    channel: str
    square: np.ndarray
    right: np.ndarray
    left: float
    count: int

    def after(self, step: np.ndarray) -> float:
        """Sum of squares after a step."""
        return float(max(self.left + 2.0 * self.right @ step + step @ self.square @ step, 0.0))


def likeliest(trials: Sequence[TrialData], curve: Curve, rows: Mapping[str, np.ndarray]) -> Likeliest:
    """The roughness of the largest marginal likelihood, noise of unknown level in each channel.

    Args:
        trials: under their present weights.
        curve: a fit of it.
        rows: derivatives there, by trial, shape (S, P) each.
    """
    fit, shape = curve.fit, curve.shape
    sums = [_sums(t, fit.trials[t.id].residual, rows[t.id]) for t in trials]
    every = [one for own in sums for one in own]
    counts = {c: sum(o.count for o in every if o.channel == c) for c in dict.fromkeys(o.channel for o in every)}
    at = np.array([fit.hypothesis.keys.index(curve.site.key(p.name)) for p in curve.site.effect.parameters])
    found: list[tuple[float, float, dict[str, float]]] = []
    for roughness in GRID:
        block, prior = replace(shape, roughness=roughness).precision(), fit.hypothesis.precision.copy()
        prior[np.ix_(at, at)] = block
        level = dict.fromkeys(counts, 1.0)
        for _ in range(HEARINGS):
            system = _system(sums, level, prior, fit.z)
            steps = _steps(system)
            left = dict.fromkeys(counts, 0.0)
            for own, step in zip(sums, steps, strict=True):
                for one in own:
                    left[one.channel] += one.after(step)
            level = {c: float(np.sqrt(max(left[c] / n, TINY))) for c, n in counts.items()}
        z = fit.z + steps[0][: fit.z.size]
        cost = sum(2.0 * n * np.log(level[c]) for c, n in counts.items()) + z @ prior @ z
        inner = sum(float(np.linalg.slogdet(a)[1]) for a, _, _ in system.own)
        volume = float(np.linalg.slogdet(block)[1]) - float(np.linalg.slogdet(system.reduced)[1]) - inner
        found.append((0.5 * (volume - float(cost)), roughness, level))
    _, best, likely = max(found, key=lambda one: one[0])
    return Likeliest(best / shape.roughness, likely)


def _sums(trial: TrialData, residual: np.ndarray, rows: np.ndarray) -> list[_Sums]:
    """By channel of a trial; readings that do not count have a residual of exactly nothing and are no reading."""
    out = []
    index = split(np.arange(residual.size), trial)
    for channel, at in index.items():
        r, j = residual[at], np.where(residual[at, None] != 0.0, rows[at], 0.0)
        out.append(_Sums(channel, j.T @ j, j.T @ r, float(r @ r), int(np.count_nonzero(r))))
    return [one for one in out if one.count]


def _system(sums: Sequence[Sequence[_Sums]], level: Mapping[str, float], prior: np.ndarray, z: np.ndarray) -> Normal:
    """Normal equations with channels' noise at a level."""
    squares, rights = [], []
    for own in sums:
        squares.append(sum((one.square / level[one.channel] ** 2 for one in own), np.zeros(())))
        rights.append(sum((one.right / level[one.channel] ** 2 for one in own), np.zeros(())))
    return Normal.of_sums(squares, rights, z, prior)


def _steps(system: Normal) -> list[np.ndarray]:
    """The undamped step of what is global and each trial's own, shape (P,) each."""
    dz = -np.linalg.lstsq(system.reduced, system.gradient, rcond=1e-13)[0]
    return [np.append(dz, -np.linalg.solve(inner, tail + cross @ dz)) for inner, cross, tail in system.own]
