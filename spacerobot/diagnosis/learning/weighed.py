"""A curve fitted to a part: its roughness, and with it the noise, are found from what the fit leaves over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.noise import squares_of
from spacerobot.diagnosis.learning.curves import SETTLED, Begun, Curve, evidence, first_shape, fitted, rougher
from spacerobot.diagnosis.learning.periods import period
from spacerobot.diagnosis.learning.roughness import likeliest
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.learned import Kind, Shape, Variable
from spacerobot.support.errors import SimulationError

ROUNDS, STEPS = 8, 8
"""Fits one after the other, each of so many steps at most: a force is linear in its curve."""

FAR = 3.0
"""Factor on the roughness from which on another one is another solution: what is nearer the next fits find."""

WAVES = 12
"""Cells of one period."""

HEARD = 1.1
"""Factor by which the noise may still change when it counts as found."""


@dataclass(frozen=True)
class Law:
    """A kind of law at a port."""

    where: str
    kind: Kind
    of: Variable
    turns: bool = False
    """Whether what moves there is an angle."""


def shape_for(bench: Bench, beside: Fit, law: Law) -> Shape | None:
    """What a curve of such a law looks like before it is fitted; None where nothing could repeat."""
    if law.of != "q":
        return first_shape(bench, beside, law.where, law.kind, law.of)
    length = period(bench, beside, law.where, law.turns)
    if length is None:
        return None
    whole = first_shape(bench, beside, law.where, law.kind, "d")
    return replace(whole, of="q", low=whole.low, high=whole.low + length, cells=WAVES)


def begun(shape: Shape, where: str, beside: Fit) -> Begun:
    """A curve of nothing beside a fit, where that ended."""
    return Begun(shape, where, beside.values(), beside.initials())


def settled(bench: Bench, sites: Sequence[Site], start: Begun, *, listen: bool = True) -> Curve | None:
    """A curve beside effects, as rough as it shows itself; None where it cannot be simulated.

    What a smooth curve cannot follow is noise to it, and under so much noise it stays smooth: where another roughness
    is likelier by far, it is found once more from there.

    Args:
        bench: of the trials; its weights are from then on what the curve asks for.
        sites: the effects.
        start: from where it begins.
        listen: whether the weights are found too; those of the bench as it is where not.
    """
    found = _settled(bench, sites, start, listen=listen)
    if found is None or not listen:
        return found
    weights = dict(bench.weights)
    try:
        factor = likeliest(bench.trials, found, bench.fitter().rows_at(found.fit)).factor
    except (SimulationError, np.linalg.LinAlgError):
        return found
    if 1.0 / FAR < factor < FAR:
        return found
    likely = _likelihood(bench, found)
    other = _settled(bench, sites, start.after(found, found.shape.rougher(factor)), listen=True)
    if other is not None and _likelihood(bench, other) > likely:
        return other
    bench.weights = weights
    return found


def _likelihood(bench: Bench, curve: Curve) -> float:
    """Log marginal likelihood of a curve and of the noise that the weights stand for, up to what all curves share."""
    counts = {c: n for c, (_, n) in squares_of(curve.fit.residuals(), bench.trials).items()}
    return curve.evidence - sum(n * float(np.log(bench.weights.get(c, 1.0))) for c, n in counts.items())


def _settled(bench: Bench, sites: Sequence[Site], start: Begun, *, listen: bool) -> Curve | None:
    """The same from one roughness on.

    A force is linear in its curve: the derivatives of the first fit serve for all but the last one.
    """
    rows: Mapping[str, np.ndarray] | None = None
    try:
        for _ in range(ROUNDS):
            fitter = bench.fitter()
            now = fitted(fitter, bench, sites, start, STEPS, rows)
            if now.fit.covariance is None:
                return None
            rows = fitter.rows_at(now.fit) if rows is None else rows
            factor, before = rougher(now), dict(bench.weights)
            if listen:
                bench.weigh(now.fit)
                rows = {t.id: rows[t.id] * _by(t, before, bench.weights)[:, None] for t in bench.trials}
            start = start.after(now, now.shape.rougher(factor))
            heard = (bench.weights.get(c, 1.0) / before.get(c, 1.0) for c in bench.weights)
            if max(factor, 1.0 / factor) < SETTLED and all(1.0 / HEARD < x < HEARD for x in heard):
                break
        last = fitted(bench.fitter(), bench, sites, start, STEPS)
    except (SimulationError, np.linalg.LinAlgError):
        return None
    return None if last.fit.covariance is None else last


def _by(trial: TrialData, before: Mapping[str, float], after: Mapping[str, float]) -> np.ndarray:
    """What a trial's weighted readings are multiplied by where weights change, shape (S,)."""
    return np.concatenate(
        [np.full(b.time.size, before.get(c, 1.0) / after.get(c, 1.0)) for b in trial.blocks for c in b.channels]
    )


def curve_of(shape: Shape, site: Site, fit: Fit) -> Curve:
    """A fit that holds a curve, as one."""
    return Curve(shape, site, fit, evidence(fit))


def misfit(bench: Bench, fit: Fit) -> float:
    """-2 log likelihood of noise whose level nobody knows, up to a constant: over channels, n log(mean square)."""
    sums = squares_of(fit.residuals(), bench.trials)
    return float(sum(count * np.log(max(square / max(count, 1), 1e-300)) for square, count in sums.values()))
