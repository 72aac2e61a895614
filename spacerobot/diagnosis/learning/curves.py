"""A curve fitted at a port beside everything else that is free, as smooth as the data want it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.learning.ground import Ground, visited
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.effects.learned import Kind, LearnedLaw, Shape, Variable
from spacerobot.support.errors import SimulationError

CELLS = 29
"""Cells of a curve: 32 coefficients. With 12 the true law lies outside the band of its error for want of room."""

FEW_CELLS = 12
"""Of a curve under loud noise, which shows no more: what it costs tells the kinds apart in half the simulations."""

BEYOND = 0.05
"""Share of the recorded range that a curve reaches beyond it on either side: a better fit moves a little further."""

ROUGHNESS = 0.03
"""Where the search for a curve's roughness begins, in units of its size: a curve that begins smooth bends where the
readings ask for it; one that begins rough makes up for its own errors, by a contact that begins later, and stays there.
"""

LOUD = ((1000.0, 6), (100.0, 6), (30.0, 6), (8.0, 6), (2.5, 10))
"""Factors on the sensors' noise, and steps, of one fit after the other: what is believed holds at first, or a fit that
lacks the law has bent every value before the curve has found its shape. Where a body floats freely, a curve that shows
at once leaps beyond where it acts linearly. The roughness is estimated anew after each.
"""

BEGIN = ((1.0, 10), (1.0, 10))
"""And at the noise as it is."""

FINISH = ((1.0, 40), (1.0, 40), (1.0, 40))
"""And of the kind that is taken: a drag that stops its target needs a hundred steps."""

SETTLED = 1.25
"""Factor by which the roughness may still change when it counts as found."""


FORGETTING = (0.0, 10.0, 30.0)
"""Rates [1/s] at which what is remembered fades, from which its fit begins: the best of them goes on."""


FAILED = (SimulationError, np.linalg.LinAlgError)
"""What ends a fit of a curve that cannot be simulated, or that nothing determines."""


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
        """Of the curve, shape (K,), in the unit of its size."""
        values = self.fit.values()
        return np.array([values[self.site.key(p.name)] for p in self.site.effect.parameters])[: self.shape.count]

    def covariance(self) -> np.ndarray:
        """Of the coefficients, shape (K, K)."""
        assert self.fit.covariance is not None  # fits of curves go on until it is known
        keys = self.fit.hypothesis.keys
        own = [keys.index(self.site.key(p.name)) for p in self.site.effect.parameters][: self.shape.count]
        return np.asarray(self.shape.size**2 * self.fit.covariance[np.ix_(own, own)])

    def determined(self) -> float:
        """How many of the coefficients the readings determine, beside what is believed of how smooth the curve is."""
        own = self.shape.count
        prior = np.asarray(self.site.effect.precision)[:own, :own] / self.shape.size**2
        return float(own - np.trace(self.covariance() @ prior))


@dataclass(frozen=True, eq=False)
class Begun:
    """From where a curve is fitted: its shape, and values of everything that is free."""

    shape: Shape
    port: str
    warm: Mapping[str, float]
    initials: Mapping[str, np.ndarray] | None = None

    def after(self, curve: Curve, new: Shape) -> Begun:
        """From where another fit of the curve, in a new shape, begins."""
        site = Site(LearnedLaw(new), self.port)
        inside = {site.key(p.name): x for p, x in zip(site.effect.parameters, _carried(curve, new), strict=True)}
        return Begun(new, self.port, {**curve.fit.values(), **inside}, curve.fit.initials())


@dataclass(frozen=True, eq=False)
class Sketch:
    """A curve as louder sensors would have it.

    Attributes:
        begun: from where its fit at the noise as it is begins.
        cost: of the last fit.
        noise: factor on the sensors' noise in that.
    """

    begun: Begun
    cost: float
    noise: float

    def least(self, bent: float) -> float:
        """What it costs at the noise as it is, at least, where its priors take up no more than `bent`.

        There it costs c + p, of readings and priors; so it would under noise n, c / n^2 + p, which is no less than what
        the fit under that noise found.
        """
        return self.noise**2 * self.cost - (self.noise**2 - 1.0) * bent


def from_where_it_is(curve: Curve) -> Begun:
    """Where a curve is fitted again."""
    return Begun(curve.shape, curve.site.where, curve.fit.values(), curve.fit.initials())


def sketch(ground: Ground, beside: Fit, port: str, kind: Kind, of: Variable) -> Sketch | None:
    """A curve of one kind at a port as louder sensors would have it; None where it cannot be simulated.

    Args:
        ground: of the trials to fit.
        beside: whose effects stay: the baseline's, or named ones.
        port: where.
        kind, of: a force, friction or memory; of displacement, rate or what is remembered.
    """
    shape = first_shape(ground, beside, port, kind, of).divided(FEW_CELLS)
    rates = FORGETTING if kind == "memory" else (0.0,)
    warm = {k: v for k, v in beside.values().items() if "@" in k}
    begun = [Begun(shape, port, {**warm, **_start(shape, port, rate)}) for rate in rates]
    try:
        *_, (last, _, then) = _one_after_another(ground, beside, begun, LOUD)
    except FAILED:
        return None
    return Sketch(then.after(last, then.shape.divided(CELLS)), last.fit.cost, LOUD[-1][0])


def fit_curve(ground: Ground, beside: Fit, sketched: Sketch) -> Curve | None:
    """The curve at the noise as it is; None where it cannot be simulated."""
    return _best(ground, beside, sketched.begun, BEGIN, rough=True)


def first_shape(ground: Ground, beside: Fit, port: str, kind: Kind, of: Variable) -> Shape:
    """Of a curve over the range that was visited, before its roughness is known."""
    seen = visited(ground, beside, port)
    push, stiff = ground.model.typical_law(port, seen)
    if of == "z":
        reach = stiff * max(abs(x) for x in seen["d"])
        seen = {of: (-reach, reach)}
    return Shape(kind, of, *_range(port, of, seen), CELLS, ROUGHNESS, stiff if kind == "memory" else push)


def _range(port: str, of: Variable, seen: Mapping[Variable, tuple[float, float]]) -> tuple[float, float]:
    """Of a curve over what was visited, with its margin."""
    low, high = seen[of]
    if of == "z":  # an odd law: what is remembered one way is known the other way
        high = max(-low, high, 1e-6)
        low = -high
    margin = BEYOND * max(high - low, 1e-9)
    return 0.0 if (port, of) == ("contact", "d") else low - margin, high + margin  # no force where nothing is pressed


def finished(ground: Ground, curve: Curve, beside: Fit, begun: Begun | None = None) -> Curve:
    """The same curve fitted to its end, from where it stands or another start, or itself where that ends no better.

    Among all kinds a few steps are enough to tell which it is.
    """
    ended = _best(ground, beside, begun or from_where_it_is(curve), FINISH)
    return curve if ended is None or ended.evidence < curve.evidence else ended


def _one_after_another(
    ground: Ground, beside: Fit, begun: Sequence[Begun], rounds: Sequence[tuple[float, int]], rough: bool = False
) -> Iterator[tuple[Curve, float, Begun]]:
    """Fits, the roughness anew after each: the curve, the factor on its roughness, and from where the next one begins.

    Args:
        ground: of the trials to fit.
        beside: whose effects stay.
        begun: from where the first fit begins; the best of several goes on.
        rounds: a factor on the sensors' noise and steps, of each fit.
        rough: whether differences to one side are enough; where the noise is louder, old ones are.

    Raises:
        SimulationError: a fit's start cannot be simulated.
    """
    for noise, steps in rounds:
        fitter = Fitter(ground.model, [louder(t, noise) for t in ground.trials])
        sites, stage = beside.hypothesis.sites, noise > 1.0
        tried = [(fitted(fitter, ground, sites, one, steps, stage=stage, rough=rough), one) for one in begun]
        now, at = min(tried, key=lambda both: both[0].fit.cost)
        factor = rougher(now) if noise == 1.0 else max(rougher(now), 1.0)  # what loud noise hides is not smooth
        new = at.shape.rougher(factor).over(*_range(at.port, at.shape.of, visited(ground, now.fit, at.port)))
        begun = [at.after(now, new)]
        yield now, factor, begun[0]


def _best(
    ground: Ground, beside: Fit, begun: Begun, rounds: Sequence[tuple[float, int]], rough: bool = False
) -> Curve | None:
    """The most probable of the fits at the noise as it is, until the roughness is found; None without any."""
    found: Curve | None = None
    try:
        for now, factor, _ in _one_after_another(ground, beside, [begun], rounds, rough):
            if found is None or now.evidence > found.evidence:
                found = now
            if now.fit.converged and max(factor, 1.0 / factor) < SETTLED:
                break
    except FAILED:
        pass
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
    others = [values[old.site.key(p.name)] for p in old.site.effect.parameters][old.shape.count :]
    inside = np.interp(new.places, old.shape.places, old.coefficients())
    return [*inside.tolist(), *others]


def fitted(
    fitter: Fitter,
    ground: Ground,
    beside: Sequence[Site],
    begun: Begun,
    steps: int,
    rows: Mapping[str, np.ndarray] | None = None,
    stage: bool = False,
    rough: bool = False,
) -> Curve:
    """One fit of a curve beside effects, from where it is begun, in so many steps at most.

    With derivatives that are known already, `rows`, or where it is but a stage on the way, it may end on old ones;
    where it may be rough, on differences to one side.

    Raises:
        SimulationError: the start cannot be simulated.
    """
    site = Site(LearnedLaw(begun.shape), begun.port)
    made = hypothesis(ground.model.believed, [*beside, site], begun.warm)
    fit = fitter.fit(
        made,
        warm=begun.warm,
        initials=begun.initials,
        max_iterations=steps,
        robust=False,
        rows=rows,
        loose=stage or rows is not None,
        one_sided=rough,
    )
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


def rougher(curve: Curve) -> float:
    """Factor on the roughness: the bends' mean square over what their prior leaves determined (Fellner and Schall)."""
    shape = curve.shape
    bends = shape.bends()
    found = bends @ curve.coefficients() / (shape.size * shape.roughness)
    unsure = np.einsum("bi,ij,bj->", bends, curve.covariance(), bends) / (shape.size * shape.roughness) ** 2
    return float(np.sqrt(np.clip(found @ found / max(len(bends) - unsure, 1e-3), 1e-4, 1e4)))
