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

SHARE = 0.03
"""Of the largest force in the contact, as which a further force is typical, wherever it acts."""

MARGIN = 0.05
"""Share of the recorded range that a curve reaches beyond it on either side: a better fit moves a little further."""

ROUGHNESS = 0.2
"""Where the search for a curve's roughness begins, in units of its size."""

ANNEALED = ((30.0, 10), (8.0, 10), (2.5, 10), (1.0, 10), (1.0, 10))
"""Factors on the sensors' noise, and steps, of one fit after the other: what is believed holds at first, or a fit that
lacks the law has bent every value before the curve has found its shape. The roughness is estimated anew after each.
"""

FINISH = ((1.0, 40), (1.0, 40), (1.0, 40))
"""And of the kind that is taken: a drag that stops its target needs a hundred steps."""

SETTLED = 1.25
"""Factor by which the roughness may still change when it counts as found."""


FORGETTING = (0.0, 10.0, 30.0)
"""Rates [1/s] at which what is remembered fades, from which its fit begins: the best of them goes on."""

STIFF = 0.1
"""Share of the port's spring as which what remembers begins: a spring that fades, or does not."""


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
        """Of the curve, shape (cells + 3,), in the unit of its size."""
        values = self.fit.values()
        return np.array([values[self.site.key(p.name)] for p in self.site.effect.parameters])[: self.shape.cells + 3]

    def covariance(self) -> np.ndarray:
        """Of the coefficients, shape (cells + 3, cells + 3)."""
        assert self.fit.covariance is not None  # fits of curves go on until it is known
        keys = self.fit.hypothesis.keys
        own = [keys.index(self.site.key(p.name)) for p in self.site.effect.parameters][: self.shape.cells + 3]
        return np.asarray(self.shape.size**2 * self.fit.covariance[np.ix_(own, own)])

    def determined(self) -> float:
        """How many of the coefficients the readings determine, beside what is believed of how smooth the curve is."""
        own = self.shape.cells + 3
        prior = np.asarray(self.site.effect.precision)[:own, :own] / self.shape.size**2
        return float(own - np.trace(self.covariance() @ prior))


def visited(workshop: Workshop, fit: Fit, port: str) -> dict[Variable, tuple[float, float]]:
    """Ranges of a port's displacement and rate in the simulated trials, of what it remembers and of what presses.

    Of the contact while the surfaces touch.
    """
    seen: dict[Variable, list[np.ndarray]] = {"d": [], "v": [], "z": [], "N": []}
    for trial in workshop.trials:
        mechanism = workshop.model.trial_mechanism(fit.hypothesis, fit.z, trial)
        run = workshop.model.predict(mechanism, trial, fit.trials[trial.id].initial).run
        times = np.unique(np.concatenate([b.time for b in trial.blocks]))
        taken = run.sample(times)
        place, rate = run.port(port, taken.position), run.port(port, taken.velocity)
        if port == "contact":
            place, rate = np.append(0.0, place[place > 0.0]), np.append(0.0, rate[place > 0.0])
        seen["d"].append(place)
        seen["v"].append(rate)
        seen["N"].append(np.append(0.0, run.contact_force(taken)))
        seen["z"].append(taken.memory[:, -1:].ravel() if taken.memory.size else np.zeros(1))
    return {of: (float(min(x.min() for x in all_)), float(max(x.max() for x in all_))) for of, all_ in seen.items()}


def fit_curve(workshop: Workshop, beside: Fit, port: str, kind: Kind, of: Variable) -> Curve | None:
    """Fit a curve of one kind at a port beside what a fit has found already; None where it cannot be simulated.

    Args:
        workshop: of the trials to fit.
        beside: whose effects stay: the baseline's, or named ones.
        port: where.
        kind, of: a force, friction or memory; of displacement, rate or what is remembered.
    """
    seen = visited(workshop, beside, port)
    spring = workshop.model.base["contact.stiffness" if port == "contact" else "wrist.stiffness"]
    reach, press = (max(abs(x) for x in seen[of]) for of in ("d", "N"))
    size = STIFF * spring if kind == "memory" else SHARE * press
    low, high = (-STIFF * spring * reach, STIFF * spring * reach) if of == "z" else seen[of]
    margin = MARGIN * max(high - low, 1e-9)
    shape = Shape(kind, of, low - margin, high + margin, CELLS, ROUGHNESS, size)
    rates = FORGETTING if kind == "memory" else (0.0,)
    warm = {k: v for k, v in beside.values().items() if "@" in k}
    begun = [_Begun(shape, port, {**warm, **_start(shape, port, rate)}) for rate in rates]
    return _fitted_through(workshop, beside, begun, ANNEALED)


def finished(workshop: Workshop, curve: Curve, beside: Fit) -> Curve:
    """The same curve fitted to its end: among all kinds a few steps are enough to tell which it is."""
    begun = _Begun(curve.shape, curve.site.where, curve.fit.values(), curve.fit.initials())
    ended = _fitted_through(workshop, beside, [begun], FINISH)
    return curve if ended is None or ended.evidence < curve.evidence else ended


@dataclass(frozen=True, eq=False)
class _Begun:
    """From where a curve is fitted: its shape, and values of everything that is free."""

    shape: Shape
    port: str
    warm: Mapping[str, float]
    initials: Mapping[str, np.ndarray] | None = None

    def after(self, curve: Curve, new: Shape) -> _Begun:
        """From where another fit of the curve, in a new shape, begins."""
        site = Site(LearnedLaw(new), self.port)
        inside = {site.key(p.name): x for p, x in zip(site.effect.parameters, _carried(curve, new), strict=True)}
        return _Begun(new, self.port, {**curve.fit.values(), **inside}, curve.fit.initials())


def _fitted_through(
    workshop: Workshop, beside: Fit, begun: Sequence[_Begun], rounds: Sequence[tuple[float, int]]
) -> Curve | None:
    """Fits one after the other, the roughness anew after each; the best of those at the noise as it is.

    Args:
        workshop: of the trials to fit.
        beside: whose effects stay.
        begun: from where the first fit begins; the best of several goes on.
        rounds: a factor on the sensors' noise and steps, of each fit.
    """
    found: Curve | None = None
    for noise, steps in rounds:
        fitter = Fitter(workshop.model, [louder(t, noise) for t in workshop.trials])
        try:
            tried = [(_fitted(fitter, workshop, beside, one, steps), one) for one in begun]
        except SimulationError:
            return found
        now, at = min(tried, key=lambda both: both[0].fit.cost)
        factor = _rougher(now)
        if noise > 1.0:
            factor = max(factor, 1.0)  # what loud noise hides is not smooth
        else:
            if found is None or now.evidence > found.evidence:
                found = now
            if now.fit.converged and max(factor, 1.0 / factor) < SETTLED:
                break
        new = at.shape.rougher(factor)
        if new.of == "z":
            far = (1.0 + 2.0 * MARGIN) * max(max(abs(x) for x in visited(workshop, now.fit, at.port)["z"]), 1e-6)
            new = replace(new, low=-far, high=far)
        begun = [at.after(now, new)]
    return found


def _start(shape: Shape, port: str, rate: float) -> dict[str, float]:
    """Of what remembers, a spring that fades at a rate; of anything else nothing yet."""
    if shape.kind != "memory":
        return {}
    site = Site(LearnedLaw(shape), port)
    return {site.key(p.name): rate if p.name == "rate_1_s" else shape.size for p in site.effect.parameters}


def _carried(old: Curve, new: Shape) -> list[float]:
    """Parameters of the same curve in another shape."""
    values = old.fit.values()
    others = [values[old.site.key(p.name)] for p in old.site.effect.parameters][old.shape.cells + 3 :]
    inside = np.interp(new.places, old.shape.places, old.coefficients())
    return [*inside.tolist(), *others]


def _fitted(fitter: Fitter, workshop: Workshop, beside: Fit, begun: _Begun, steps: int) -> Curve:
    site = Site(LearnedLaw(begun.shape), begun.port)
    made = hypothesis(workshop.model.believed, [*beside.hypothesis.sites, site], begun.warm)
    fit = fitter.fit(made, warm=begun.warm, initials=begun.initials, max_iterations=steps, robust=False)
    return Curve(begun.shape, site, fit, evidence(fit))


def louder(trial: TrialData, factor: float) -> TrialData:
    """The trial as sensors of so many times the noise would have it."""
    return replace(trial, blocks=tuple(replace(b, weight=b.weight / factor) for b in trial.blocks))


def evidence(fit: Fit) -> float:
    """Log marginal likelihood by Laplace's method: cost and volume, in units in which priors have variance one.

    What has no prior is alike in all that are compared, and its unit with it.
    """
    assert fit.covariance is not None
    volume = np.linalg.slogdet(fit.covariance)[1]
    stated = sum(np.linalg.slogdet(block)[1] for s in fit.hypothesis.sites if (block := s.effect.precision) is not None)
    return float(-0.5 * fit.cost + 0.5 * (volume + stated))


def _rougher(curve: Curve) -> float:
    """Factor on the roughness: the bends' mean square over what their prior leaves determined (Fellner and Schall)."""
    shape = curve.shape
    bends = shape.bends()
    found = bends @ curve.coefficients() / (shape.size * shape.roughness)
    unsure = np.einsum("bi,ij,bj->", bends, curve.covariance(), bends) / (shape.size * shape.roughness) ** 2
    return float(np.sqrt(np.clip(found @ found / max(len(bends) - unsure, 1e-3), 1e-4, 1e4)))
