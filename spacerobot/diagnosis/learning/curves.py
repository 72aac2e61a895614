"""A curve fitted at a port beside everything else that is free, as smooth as the data want it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.effects.learned import Kind, LearnedLaw, Shape, Variable
from spacerobot.support.errors import SimulationError

CELLS = 29
"""Cells of a curve: 32 coefficients. With 12 the true law lies outside the band of its error for want of room."""

MARGIN = 0.05
"""Share of the recorded range that a curve reaches beyond it on either side: a better fit moves a little further."""

ROUGHNESS = 0.2
"""Where the search for a curve's roughness begins, in units of its size: nearly straight, so that nothing is trapped."""

ANNEALED = (30.0, 8.0, 2.5, 1.0, 1.0, 1.0)
"""Factors on the sensors' noise, one fit after the other: what is believed holds at first, or a fit that lacks the law
has bent every value before the curve has found its shape. The roughness is estimated anew after each.
"""

STEPS = 10
"""Of each of these fits."""

SETTLED = 1.25
"""Factor by which the roughness may still change when it counts as found."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A fitted curve.

    Attributes:
        shape: all of it that is not fitted.
        site: where it stands.
        fit: the whole fit.
        evidence: log marginal likelihood by Laplace's method, up to what all curves of a study share.
    """

    shape: Shape
    site: Site
    fit: Fit
    evidence: float

    def coefficients(self) -> np.ndarray:
        """Of the curve, shape (cells + 3,) [N]."""
        values = self.fit.values()
        return np.array([values[self.site.key(p.name)] for p in self.site.effect.parameters])

    def covariance(self) -> np.ndarray:
        """Of the coefficients, shape (cells + 3, cells + 3) [N^2]."""
        assert self.fit.covariance is not None  # fits of curves go on until it is known
        keys = self.fit.hypothesis.keys
        own = [keys.index(self.site.key(p.name)) for p in self.site.effect.parameters]
        return np.asarray(self.shape.size**2 * self.fit.covariance[np.ix_(own, own)])


def visited(workshop: Workshop, fit: Fit, port: str, of: Variable) -> tuple[float, float]:
    """Range of a port's displacement or rate in the simulated trials, with a margin."""
    low, high = np.inf, -np.inf
    for trial in workshop.trials:
        mechanism = workshop.model.trial_mechanism(fit.hypothesis, fit.z, trial)
        run = workshop.model.predict(mechanism, trial, fit.trials[trial.id].initial).run
        times = np.unique(np.concatenate([b.time for b in trial.blocks]))
        position, rate = run.states(times)
        seen = run.port(port, position if of == "d" else rate)
        low, high = min(low, float(seen.min())), max(high, float(seen.max()))
    margin = MARGIN * max(high - low, 1e-9)
    return low - margin, high + margin


def fit_curve(
    workshop: Workshop, beside: Fit, port: str, kind: Kind, of: Variable, size: float, *, bar: float = np.inf
) -> Curve | None:
    """Fit a curve of one kind at a port beside what a fit has found already; None where it cannot be simulated.

    Args:
        workshop: of the trials to fit.
        beside: where it begins: the baseline, or effects that stay.
        port: where.
        kind, of: force or friction, of displacement or rate.
        size: typical force [N].
        bar: cost above which, after the first round, it is given up.
    """
    low, high = visited(workshop, beside, port, of)
    shape = Shape(kind, of, low, high, CELLS, ROUGHNESS, size)
    warm = {k: v for k, v in beside.values().items() if "@" in k}
    initials = None
    found: Curve | None = None
    for noise in ANNEALED:
        fitter = Fitter(workshop.model, [louder(t, noise) for t in workshop.trials])
        try:
            now = _fitted(fitter, workshop, beside, shape, port, warm, initials)
        except SimulationError:
            return found
        factor = _rougher(now)
        if noise > 1.0:
            factor = max(factor, 1.0)  # what loud noise hides is not smooth
        if noise == 1.0:
            if found is None or now.evidence > found.evidence:
                found = now
            if now.fit.cost > bar or max(factor, 1.0 / factor) < SETTLED:
                break
        shape = shape.rougher(factor)
        site = Site(LearnedLaw(shape), port)
        inside = zip(site.effect.parameters, now.coefficients().tolist(), strict=True)
        warm = dict(now.fit.values()) | {site.key(p.name): x for p, x in inside}
        initials = now.fit.initials()
    return found


def _fitted(
    fitter: Fitter,
    workshop: Workshop,
    beside: Fit,
    shape: Shape,
    port: str,
    warm: Mapping[str, float],
    initials: Mapping[str, np.ndarray] | None,
) -> Curve:
    site = Site(LearnedLaw(shape), port)
    made = hypothesis(workshop.model.believed, [*beside.hypothesis.sites, site], warm)
    fit = fitter.fit(made, warm=warm, initials=initials, max_iterations=STEPS, robust=False)
    return Curve(shape, site, fit, evidence(fit))


def louder(trial: TrialData, factor: float) -> TrialData:
    """The trial as sensors of so many times the noise would have it."""
    return replace(trial, blocks=tuple(replace(b, weight=b.weight / factor) for b in trial.blocks))


def evidence(fit: Fit) -> float:
    """Log marginal likelihood by Laplace's method: cost and volume, in units in which priors have variance one.

    What has no prior is alike in all that are compared, and its unit with it.
    """
    assert fit.covariance is not None
    volume = np.linalg.slogdet(fit.covariance)[1]
    stated = sum(np.linalg.slogdet(s.effect.precision)[1] for s in fit.hypothesis.sites if s.effect.learned)
    return float(-0.5 * fit.cost + 0.5 * (volume + stated))


def _rougher(curve: Curve) -> float:
    """Factor on the roughness: the bends' mean square over what their prior leaves determined (Fellner and Schall)."""
    shape = curve.shape
    bends = shape.bends()
    found = bends @ curve.coefficients() / (shape.size * shape.roughness)
    unsure = np.einsum("bi,ij,bj->", bends, curve.covariance(), bends) / (shape.size * shape.roughness) ** 2
    return float(np.sqrt(np.clip(found @ found / max(len(bends) - unsure, 1e-3), 1e-4, 1e4)))


def kinds() -> Sequence[tuple[Kind, Variable]]:
    """What is tried at a port, the plainer first."""
    return (("force", "v"), ("force", "d"), ("friction", "d"), ("friction", "v"))
