"""Detection limits: the size from which the decision itself names an effect, in 95 of 100 campaigns like this one.

The effect is put into the fitted model, faint at first, at full size in the end: what of that no free parameter can
imitate is the noncentrality lambda of its likelihood ratio, of the two the less: friction promises more while it is
faint, and contacts add at full size what a refit would take away. Named it is where three things hold (`judge.py`):

- chi-squared falls by EARN and the price of its parameters. The fall is (sqrt(lambda) + n)^2, n of unit variance.
- so it does against a baseline whose believed values, where the effect moves them beyond belief, are set free.
- every rival, one effect or two together, stays MARGIN behind, its price counted. Of what the effect does to the
  recordings a rival imitates the part along its own columns; the rest is mu, and the lead mu + 2 sqrt(mu) n.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import binary_erosion

from spacerobot.diagnosis.fitting.fitted import NORMAL_95, Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.screen import FAINT, Projector, Screener, faint, starts_of
from spacerobot.diagnosis.fitting.starts import sized
from spacerobot.diagnosis.terms.candidates import contains, means
from spacerobot.diagnosis.terms.decision import EARN, HELD_OFF, MARGIN, MOVED, PENALTY
from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.effect import Parameter

Label = tuple[str, str]

ALONG = 0.999
"""Cosine beyond which two effects do the same, so that the pair is no more than either."""

STEPS = 10
NEAR = 0.03
"""A size is looked for in so many steps, until it is known to so much in its logarithm: a twentieth of its own scatter
from campaign to campaign."""

STRIDE = 4.0
"""Factor by which a step changes the size at most: an onset that goes as a square root, or a stop that is not reached
yet, promises more than it holds."""

SCATTER = 1.0
"""Stated sigmas by which a believed value may come out further from what is believed than without noise, at most."""

BESIDE = 2
"""Samples beside an onset, which a fit masks, that no limit is built on: what they show is the moment of touch, each
trial's own. A fit moves it over them, one after the other, and a derivative takes that for information."""

LARGEST = 1e3
"""Multiple of an effect's start beyond which no size is looked for."""


def must_earn(price: float, first: bool) -> float:
    """Noncentrality at which an effect earns its place.

    Of the 5 % that may be missed, half fall short of this, half have a rival that comes too near (`must_lead`).

    Args:
        price: of its parameters.
        first: whether it would be the first effect; a further one leads over what it stands beside.
    """
    return (math.sqrt(max((EARN if first else MARGIN) + price, 0.0)) + NORMAL_95) ** 2


def must_lead(dearer: float) -> float:
    """Noncentrality that a rival must leave over, to stay behind by what tells two sets apart.

    Args:
        dearer: by how much the effect's parameters cost more than the rival's.
    """
    return float(_must_lead(np.asarray(dearer)))


def _must_lead(dearer: np.ndarray) -> np.ndarray:
    """The same of many, any shape."""
    root = NORMAL_95**2 + MARGIN + dearer
    return np.where(root > 0.0, np.square(NORMAL_95 + np.sqrt(np.maximum(root, 0.0))), 0.0)


@dataclass(frozen=True, eq=False)
class Column:
    """What an effect, at one of its starts and faint, does that no free parameter can imitate."""

    site: Site
    start: Mapping[str, float]
    share: float  # of the start, at which it was taken
    column: np.ndarray  # (S + P,)
    norm: float

    @property
    def steep(self) -> float:
        """Noncentrality at its start, were it to grow from where it was taken as the square of its size."""
        return self.norm / self.share**2

    @property
    def price(self) -> float:
        """Of its parameters."""
        return PENALTY * (len(self.site.effect.parameters) + bool(self.site.trials))


@dataclass(frozen=True)
class Limit:
    """The smallest size of an effect that would have been named.

    Attributes:
        site: the effect at its place.
        parameter: its strength.
        smallest: from nothing; of a strength that is null at infinity, the value itself. None where no size would do.
        instead: the effects, one or two together, that it would not be told from, where the limit comes from that.
    """

    site: Site
    parameter: Parameter
    smallest: float | None
    instead: tuple[tuple[str, str], ...] = ()


class _Rivals:
    """What would imitate an effect, one other or two together, each by what it does along its own columns.

    Args:
        item: the effect.
        columns: (R,), of all effects that may stand in its place.
        units: (R, S + P), their directions.
        cosines: (R, R), between them.
    """

    def __init__(self, item: Column, columns: Sequence[Column], units: np.ndarray, cosines: np.ndarray) -> None:
        self.columns, self.units = columns, units
        self.one_sided = np.array([not c.site.effect.two_sided for c in columns], dtype=bool)
        price = np.array([c.price for c in columns])
        self.leads = _must_lead(item.price - price)
        labels = {c.site.label: n for n, c in enumerate(columns)}
        label = np.array([labels[c.site.label] for c in columns], dtype=int)
        i, j = np.triu_indices(len(columns), 1)
        ask = _must_lead(item.price - price[i] - price[j])
        cosine = cosines[i, j]
        keep = (label[i] != label[j]) & (ask > 0.0) & (np.abs(cosine) < ALONG)
        self.i, self.j, self.ask, self.cosine = i[keep], j[keep], ask[keep], cosine[keep]

    def least(self, column: np.ndarray, inflation: float) -> tuple[float, tuple[Label, ...]]:
        """How many times the size is what the nearest rival asks for, and that rival; infinite if none asks."""
        if not len(self.columns):
            return math.inf, ()
        norm = float(column @ column)
        along = self.units @ column
        taken = np.square(np.where(self.one_sided, np.maximum(along, 0.0), along))
        one = self._lead(norm - taken, self.leads, inflation)
        a, b = along[self.i], along[self.j]
        left = 1.0 - np.square(self.cosine)
        x, y = (a - self.cosine * b) / left, (b - self.cosine * a) / left
        # with a sign that it may not have, one of the two is no help to the other
        fits = ~((self.one_sided[self.i] & (x < 0.0)) | (self.one_sided[self.j] & (y < 0.0)))
        both = np.where(fits, a * x + b * y, 0.0)
        two = self._lead(norm - both, self.ask, inflation)
        k, m = int(np.argmin(one)), int(np.argmin(two)) if len(two) else -1
        if m >= 0 and two[m] < one[k]:
            return float(two[m]), tuple(self.columns[n].site.label for n in (self.i[m], self.j[m]))
        return float(one[k]), (self.columns[k].site.label,)

    def _lead(self, left: np.ndarray, asked: np.ndarray, inflation: float) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.sqrt(np.maximum(left, 0.0) / inflation / asked)
        return np.where(asked > 0.0, found, np.inf)


class Limits:
    """Detection limits at a fit.

    Args:
        fitter: of the trials.
        believed: what the study says of its values.
        fit: what an effect would be beside.
        inflation: of the noise.
    """

    _between: tuple[np.ndarray, np.ndarray] | None = None

    def __init__(self, fitter: Fitter, believed: Believed, fit: Fit, inflation: float) -> None:
        self.screener = Screener(fitter, believed)
        self.fitter, self.believed, self.fit, self.inflation = fitter, believed, fit, inflation
        state = self.screener.state_of(fit)
        # one mask for all, derivatives included: a sample masked in one of two only would count as information
        self.state = replace(state, keep={k: _away(keep) for k, keep in state.keep.items()})
        self.project = Projector(fitter, fit, self.state, robust=False)
        self._loose: dict[tuple[str, ...], Projector] = {}

    def of(self, sites: Sequence[Site]) -> list[Limit]:
        """Limits of these effects, each beside the fit's own; those the fit holds, in any form, are left out."""
        label = self.fit.hypothesis.label
        sites = [s for s in sites if not any(_akin(s.label, one) for one in label)]
        columns = [c for s in sites for c in self._columns(s)]
        units = np.array([c.column / math.sqrt(c.norm) for c in columns])
        best: dict[tuple[str, str], Column] = {}
        for c in columns:
            if c.site.label not in best or c.steep > best[c.site.label].steep:
                best[c.site.label] = c
        return [self._limit(c, columns, units) for _, c in sorted(best.items())]

    def _cosines(self, units: np.ndarray) -> np.ndarray:
        """Between all directions, shape (R, R); found once for all limits."""
        if self._between is None or self._between[0] is not units:
            self._between = units, units @ units.T
        return self._between[1]

    def _columns(self, site: Site) -> list[Column]:
        share = 1.0 if site.effect.removes else FAINT
        out = []
        for start in starts_of(site, self.fitter.trials):
            column = self._moved(site, {**start, **faint(site, start)})
            if column is not None and means([site.label], start):
                norm = float(column @ column)
                if norm > 1e-12:
                    out.append(Column(site, start, share, column, norm))
        return out

    def _moved(self, site: Site, values: Mapping[str, float]) -> np.ndarray | None:
        """What an effect at these values does to the recordings beyond what any free parameter can, shape (S + P,)."""
        change = self._change(site, values)
        return None if change is None else self.project.free(change, np.zeros_like(self.fit.z))

    def _change(self, site: Site, values: Mapping[str, float]) -> np.ndarray | None:
        """What it does to the recordings, shape (S,)."""
        moved = self.screener.with_effect(self.fit, self.state, site, values)
        if moved is None:
            return None
        return self.project.stack({k: raw - self.state.raw[k] for k, raw in moved.raw.items()})

    def _wrong_instead(self, change: np.ndarray, price: float) -> float:
        """How many times the size is what it must be beside a baseline whose values are wrong; infinite if none is."""
        shift = self.project.shift(change)
        held_off = self.fit.contradictions(shift)
        out = tuple(
            f.key
            for f, s in zip(self.fit.hypothesis.free, shift, strict=True)
            if f.kind == "believed" and (abs(s) > MOVED - SCATTER or abs(held_off.get(f.key, 0.0)) > HELD_OFF - SCATTER)
        )
        if not out or self.fit.hypothesis.sites:
            return math.inf
        if out not in self._loose:
            self._loose[out] = Projector(self.fitter, self.fit, self.state, robust=False, loose=out)
        left = self._loose[out].free(change, np.zeros_like(self.fit.z))
        return math.sqrt(float(left @ left) / self.inflation / must_earn(price - PENALTY * len(out), True))

    def _limit(self, item: Column, columns: Sequence[Column], units: np.ndarray) -> Limit:
        parameter = item.site.effect.strength
        others = [
            k
            for k, c in enumerate(columns)
            if c.site.label != item.site.label
            and (not _akin(c.site.label, item.site.label) or contains([item.site.label], [c.site.label]))
        ]
        rivals = _Rivals(
            item, [columns[k] for k in others], units[others], self._cosines(units)[np.ix_(others, others)]
        )
        earn = must_earn(item.price, not self.fit.hypothesis.sites)

        def enough(column: np.ndarray) -> tuple[float, tuple[Label, ...]]:
            """How many times the size is what it must be, and the rival that asks most."""
            found = math.sqrt(float(column @ column) / self.inflation / earn)
            asked, rival = rivals.least(column, self.inflation)
            return (asked, rival) if asked < found else (found, ())

        linear, _ = enough(item.column)
        instead: tuple[Label, ...] = ()
        rival: tuple[Label, ...] = ()
        share, low, high = item.share / max(linear, 1e-12), 0.0, math.inf
        for _ in range(STEPS):
            share = min(share, LARGEST)
            change = self._change(item.site, sized(item.site, item.start, share))
            found, rival = 0.0, ()
            if change is not None:
                found, rival = enough(self.project.free(change, np.zeros_like(self.fit.z)))
                found = min(found, self._wrong_instead(change, item.price), linear * share / item.share)
            if found >= 1.0:
                high, instead = share, rival
            else:
                low = share
            if (found >= 1.0 and math.log(found) < NEAR) or low >= LARGEST or math.log(high / max(low, 1e-9)) < NEAR:
                break
            wanted = share * min(max(1.005 / max(found, 1e-9), 1.0 / STRIDE), STRIDE)
            share = wanted if low < wanted < high else math.sqrt(low * high) if low > 0.0 else 0.5 * high
        if math.isinf(high):
            return Limit(item.site, parameter, None, rival)
        value = sized(item.site, item.start, high)[item.site.key(parameter.name)]
        smallest = value if math.isinf(parameter.null) else abs(value - parameter.null)
        return Limit(item.site, parameter, smallest, instead)


def _away(keep: np.ndarray) -> np.ndarray:
    """Samples that count and lie BESIDE samples away from any that does not, shape (S,)."""
    return np.asarray(binary_erosion(keep, np.ones(2 * BESIDE + 1, dtype=bool), border_value=1))


def _akin(one: tuple[str, str], other: tuple[str, str]) -> bool:
    """Whether one effect is the other, or holds it as a special case."""
    return one == other or contains([one], [other]) or contains([other], [one])
