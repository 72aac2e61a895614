"""What is known of a learned law: the sum with what it trades with, and a band that holds it everywhere at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.learning.curves import BEYOND, Curve
from spacerobot.effects.learned import Kind, Variable

POINTS = 41
"""Of the table."""

DRAWS = 4000
LEVEL = 0.95

TRADES = {
    ("wrist", "force", "v"): ("wrist.damping", "wrist.equivalent_damping"),
    ("wrist", "force", "d"): ("wrist.stiffness",),
    ("contact", "force", "v"): ("contact.damping",),
    ("contact", "force", "d"): ("contact.stiffness",),
    ("target", "force", "v"): ("body.damping",),
    ("target.yaw", "force", "v"): ("body.yaw_damping",),
}
"""Believed values that a law of a port's rate or displacement can be traded for: only the sum is known."""


def traded_with(where: str, kind: Kind, of: Variable) -> tuple[str, ...]:
    """Names of the believed values that a law at a port can be traded for."""
    if where.startswith("joint.") and kind == "force" and of in ("d", "v"):
        return (f"{where}.{'stiffness' if of == 'd' else 'damping'}",)
    return TRADES.get((where, kind, of), ())


@dataclass(frozen=True, eq=False)
class Band:
    """A table of the law and of the total force, over the range that the recordings visited. T points.

    Attributes:
        x: displacement [m], rate [m/s], or what is remembered [N], shape (T,).
        law: the curve alone, shape (T,) [N], [N/m] of what remembers.
        total: with what it trades with, shape (T,).
        low, high: that hold the total everywhere at once in 95 of 100 cases, shape (T,) each.
        with_: values that the total holds.
    """

    x: np.ndarray
    law: np.ndarray
    total: np.ndarray
    low: np.ndarray
    high: np.ndarray
    with_: tuple[str, ...]


def band(curve: Curve) -> Band:
    """Of a fitted curve, from its covariance."""
    shape, fit = curve.shape, curve.fit
    # the margin beyond what was visited; what repeats is known all around
    width = 0.0 if shape.of == "q" else (shape.high - shape.low) * BEYOND / (1.0 + 2.0 * BEYOND)
    x = np.linspace(shape.low + width, shape.high - width, POINTS)
    rows = shape.rows(x)
    law = rows @ curve.coefficients()
    names = traded_with(curve.site.where, shape.kind, shape.of)
    keys, values = fit.hypothesis.keys, fit.values()
    design = np.zeros((POINTS, len(keys)))
    own = [keys.index(curve.site.key(p.name)) for p in curve.site.effect.parameters][: shape.count]
    design[:, own] = rows * shape.size
    total = law.copy()
    traded = tuple(n for n in names if n in values)
    for name in traded:
        total += values[name] * x
        free = fit.hypothesis.free[keys.index(name)]
        design[:, keys.index(name)] = x * free.slope(float(fit.z[keys.index(name)]))
    assert fit.covariance is not None
    covariance = design @ fit.covariance @ design.T
    sigma = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    size, vectors = np.linalg.eigh(covariance / np.outer(sigma, sigma))
    draws = np.random.default_rng(0).standard_normal((DRAWS, POINTS)) @ (vectors * np.sqrt(np.maximum(size, 0.0))).T
    factor = float(np.quantile(np.abs(draws).max(axis=1), LEVEL))
    return Band(x, law, total, total - factor * sigma, total + factor * sigma, traded)
