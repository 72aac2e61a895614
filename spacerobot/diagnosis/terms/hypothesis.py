"""A hypothesis: the baseline with some effects in it, and which numbers are free."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.terms import parameters
from spacerobot.diagnosis.terms.parameters import Free
from spacerobot.effects.effect import Effect
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.trend import NUMBER, SUFFIX
from spacerobot.recordings.values import least_of, may_be_nothing
from spacerobot.support.errors import InputError, SimulationError

Label = tuple[tuple[str, str], ...]
"""((effect, where), ...), sorted: what a hypothesis is called."""


LOOSE = 30.0
"""Factor on a believed value's sigma that sets it free, or on what is believed to be zero."""

ANYTHING = 5.0
"""And its own relative deviation then, if that is more: what is given up at a price counts for nothing more. A damper
that stands for a guide's friction as well is several times what is stated of it.
"""


ROUNDING = 1e-9
"""Least eigenvalue of a matrix of correlations that is more than rounding leaves of its inverse."""


@dataclass(frozen=True)
class Site:
    """An effect at a place, its numbers free.

    Attributes:
        effect, where: what and where.
        trials: the only trials in which it acts; all if empty.
    """

    effect: Effect
    where: str
    trials: tuple[str, ...] = ()

    @property
    def label(self) -> tuple[str, str]:
        """(effect, where)."""
        return self.effect.name, self.where

    def key(self, parameter: str) -> str:
        """Key of one of its parameters among the free ones."""
        return f"{self.effect.name}@{self.where}.{parameter}"

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Its parameters by name, of values by key."""
        return {p.name: values[self.key(p.name)] for p in self.effect.parameters}


def label_of(sites: Iterable[Site]) -> Label:
    """What a set of sites is called, in whatever order they stand."""
    return tuple(sorted(s.label for s in sites))


@dataclass(frozen=True)
class Believed:
    """What a study says of its values, as fits need it.

    Attributes:
        values: baseline values by dotted name, without the trials' overrides.
        sigma: relative deviations by dotted name.
        scatter: relative deviations between conditions.
        conditions: names of the conditions.
        unknown: values that are not stated, with a plausible centre each.
        absorbing: constants whose job is to absorb left-out physics.
        freed: values of which what is stated counts for next to nothing.
        clocks: "SENSOR.clock" of each sensor on a clock that no other shares: each trial's own start, or the clock's
            offset, stands for its lateness.
        unheld: of the absorbing ones, those that nothing holds -> the least that each may be.
        absolute: values that are believed to be zero -> standard deviation [their own unit].
        within: of these, those that are no further from it than this, whatever a fit would gain [their own unit].
        zeros: channels whose zero is known no better than this standard deviation [the channel's unit]; and of
            "CHANNEL|COLUMN" the factor of a column in one (`machines/doubted.py`).
    """

    values: Mapping[str, float]
    sigma: Mapping[str, float]
    scatter: Mapping[str, float]
    conditions: tuple[str, ...]
    unknown: Mapping[str, float] = field(default_factory=dict)
    absorbing: tuple[str, ...] = ()
    freed: tuple[str, ...] = ()
    clocks: tuple[str, ...] = ()
    unheld: Mapping[str, float] = field(default_factory=dict)
    zeros: Mapping[str, float] = field(default_factory=dict)
    absolute: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, float] = field(default_factory=dict)

    def let_go(self, name: str) -> float:
        """Share of its pull towards what is stated that a value keeps when it is set free."""
        return (_held(LOOSE * self.sigma[name]) if name in self.sigma else 1.0) / LOOSE

    @property
    def fitted(self) -> tuple[str, ...]:
        """Names of what is free in every hypothesis and may stand for an effect."""
        return (*self.sigma, *self.absolute, *self.unheld, *self.clocks)

    def free_of(self, names: Sequence[str]) -> Believed:
        """The same with these values set free of what is stated of them."""
        if not names:
            return self
        sigma, absolute = (
            {k: v * (LOOSE if k in names else 1.0) for k, v in stated.items()} for stated in (self.sigma, self.absolute)
        )
        return replace(self, sigma=sigma, absolute=absolute, freed=tuple(names))


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """Baseline plus sites, with its free parameters in order.

    Attributes:
        sites: effects at their places.
        free: the parameters.
        removed: baseline values that the effects make meaningless.
        freed: believed values of which what is stated counts for next to nothing.
        known: inverse covariance of z, shape (G, G), in the place of what is believed, where other trials told it.
    """

    sites: tuple[Site, ...]
    free: tuple[Free, ...]
    removed: tuple[str, ...] = ()
    freed: tuple[str, ...] = ()
    known: np.ndarray | None = None

    @property
    def label(self) -> Label:
        """Which effects where, sorted."""
        return label_of(self.sites)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the free parameters."""
        return tuple(f.key for f in self.free)

    @property
    def only(self) -> tuple[tuple[tuple[str, str], tuple[str, ...]], ...]:
        """Effects and places that act in some trials alone, and which."""
        return tuple((s.label, s.trials) for s in self.sites if s.trials)

    def acting(self, trial: str) -> tuple[Site, ...]:
        """The sites whose effects act in a trial."""
        return tuple(s for s in self.sites if not s.trials or trial in s.trials)

    @functools.cached_property
    def changes(self) -> bool:
        """Whether an effect is another in every trial."""
        return any(s.effect.name.endswith(SUFFIX) for s in self.sites)

    @functools.cached_property
    def scattered(self) -> bool:
        """Whether a value is another in every condition."""
        return any(f.kind == "scatter" for f in self.free)

    def idle(self, trial: str) -> frozenset[str]:
        """Keys of effects' parameters that mean nothing in a trial."""
        return frozenset(
            s.key(p.name) for s in self.sites if s.trials and trial not in s.trials for p in s.effect.parameters
        )

    def sigmas(self, z: np.ndarray) -> dict[str, float]:
        """How far the believed values are from what is stated of them, in stated sigmas."""
        pairs = zip(self.free, z, strict=True)
        return {f.key: float(x) * (LOOSE if f.key in self.freed else 1.0) for f, x in pairs if f.kind == "believed"}

    def values(self, z: np.ndarray) -> dict[str, float]:
        """Physical values of the free parameters."""
        return {f.key: f.value(float(x)) for f, x in zip(self.free, z, strict=True)}

    def trial_values(
        self, z: np.ndarray, base: Mapping[str, float], condition: str, overrides: Mapping[str, float]
    ) -> dict[str, float]:
        """All rig values of one trial: believed, overridden, moved by the free parameters.

        A believed value that a trial overrides (a target mass) is moved by the same relative amount in every trial:
        its deviation is one for the whole study. A condition's own change is a share of what is stated, so that the
        two add: what readings know of their sum to a part in a million leaves a straight valley, no bent one.
        """
        stated = {**base, **overrides}
        values = dict(stated)
        for f, x in zip(self.free, z, strict=True):
            if f.kind == "believed":
                if f.centre:
                    values[f.key] = values.get(f.key, f.centre) * f.value(float(x)) / f.centre
                else:
                    values[f.key] = values.get(f.key, 0.0) + f.value(float(x))
            elif f.kind in ("unknown", "absorbing"):
                values[f.key] = f.value(float(x))
        for f, x in zip(self.free, z, strict=True):
            if f.kind == "scatter":
                where, name = f.key.split("|", 1)
                if where == condition:
                    values[name] += (f.value(float(x)) - 1.0) * stated.get(name, values[name])
        for name in self.removed:
            values[name] = 0.0
        return values

    def edit(self, mechanism: Mechanism, free: Mapping[str, float], trial: str, number: int = 0) -> Mechanism:
        """The mechanism with every site's effect in it that acts in a trial.

        Args:
            mechanism: of the baseline.
            free: values of the free parameters.
            trial: which.
            number: of the trial in the study, from 0: some effects change from one to the next.

        Raises:
            SimulationError: no body could be like that (more mass taken away than there is); a fit steps back from it.
        """
        try:
            for site in self.acting(trial):
                inside = site.own(free)
                if site.effect.name.endswith(SUFFIX):
                    inside[NUMBER] = float(number)
                mechanism = site.effect.edit(mechanism, site.where, inside)
        except InputError as error:
            raise SimulationError(str(error)) from None
        return mechanism

    @functools.cached_property
    def precision(self) -> np.ndarray:
        """Inverse covariance of what is believed of z, shape (G, G); what is held at a value has no part in it."""
        if self.known is not None:
            return self.known
        out = np.diag([f.prior for f in self.free])
        for site in self.sites:
            block = site.effect.precision
            index = [self.keys.index(site.key(p.name)) for p in site.effect.parameters] if block is not None else []
            if index and all(self.free[i].lower < self.free[i].upper for i in index):
                out[np.ix_(index, index)] = block
        return out

    def about(self, z: np.ndarray, covariance: np.ndarray) -> Hypothesis:
        """The same, its parameters counted from z, shape (G,), and known with this covariance, shape (G, G).

        Raises:
            LinAlgError: the covariance is none, or of parameters that are one but for rounding.
        """
        free = tuple(replace(f, about=f.about + float(x)) for f, x in zip(self.free, z, strict=True))
        with np.errstate(divide="ignore", invalid="ignore"):
            own = np.sqrt(np.diag(covariance))
            alike = covariance / np.outer(own, own)
        if not (np.isfinite(alike).all() and np.linalg.eigvalsh(0.5 * (alike + alike.T))[0] > ROUNDING):
            raise np.linalg.LinAlgError("no covariance that can be told from rounding")
        known = np.linalg.inv(alike) / np.outer(own, own)
        return replace(self, free=free, known=0.5 * (known + known.T))

    def start(self, warm: Mapping[str, float] | None = None) -> np.ndarray:
        """First z: the centre of each, or the value of the same key in `warm`."""
        warm = warm or {}
        z = np.array([f.z(warm[f.key]) if f.key in warm else 0.0 for f in self.free])
        low, high = self.bounds()
        return np.asarray(np.clip(z, low, high))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds in z, shape (len(free),) each."""
        pairs = [f.bounds for f in self.free]
        return np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])


def _held(sigma: float) -> float:
    """Pull on a value that was set free, of this relative deviation then, as a share of what one deviation has."""
    return min(sigma / ANYTHING, 1.0)


def hypothesis(believed: Believed, sites: Sequence[Site], starts: Mapping[str, float] | None = None) -> Hypothesis:
    """The hypothesis that these effects are there.

    Args:
        believed: what the study says.
        sites: the effects; none for the baseline.
        starts: start values of effect parameters by key; the first of each parameter's own where absent.
    """
    starts = starts or {}
    replaced = {name for s in sites for name in s.effect.replaced(s.where)}
    removed = tuple(n for s in sites for n in s.effect.removes if n in believed.values or n in believed.unknown)
    free: list[Free] = []
    for name, sigma in believed.sigma.items():
        value = believed.values.get(name)
        if name in believed.absorbing and name in replaced and value is not None:
            free.append(parameters.absorbing(name, value, sigma))
        else:
            prior = _held(sigma) ** 2 if name in believed.freed else 1.0
            to_nothing = name in believed.freed and may_be_nothing(name)
            free.append(parameters.believed(name, value, sigma, prior, to_nothing=to_nothing))
    for name, sigma in believed.absolute.items():
        most = believed.within.get(name, math.inf)
        free.append(parameters.around_zero(name, sigma, max(least_of(name), -most), most))
    free += [parameters.absorbing(n, believed.values[n], lower=least) for n, least in believed.unheld.items()]
    free += [parameters.zero(channel, sigma) for channel, sigma in believed.zeros.items()]
    free += [parameters.unknown(n, c) for n, c in believed.unknown.items() if n not in removed]
    for condition in believed.conditions if len(believed.conditions) > 1 else ():
        free += [parameters.scatter(condition, n, s) for n, s in believed.scatter.items()]
    for site in sites:
        for parameter in site.effect.parameters:
            start = starts.get(site.key(parameter.name), parameter.starts[0])
            free.append(parameters.of_effect(site.effect.name, site.where, parameter, start))
    return Hypothesis(tuple(sites), tuple(free), removed, believed.freed)
