"""Detection limits of a part: the size from which its own decision names an effect in 95 of 100 campaigns like this.

What the decision asks for (`model_choice.py`, `forward_selection.py`) is no single threshold: readings of unseen
trials must be predicted better by an effect size and throughout, rivals worse by one, and the interval must show it.
So it is asked itself, of DRAWN campaigns with the effect in them, to first order: an effect moves the residuals by a
column freed of what the free parameters imitate, at full size in the end; each fold finds the size from the other
trials, as every rival does; noise takes part by its inner products with these columns. Where no noise is stated the
weights are those of what the part leaves over, by which a draw counts independent samples.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.fitting.fitted import NORMAL_95
from spacerobot.diagnosis.fitting.starts import sized
from spacerobot.diagnosis.selection.candidate import tried
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.limits import LARGEST, NEAR, Column, Label, Limit, Limits
from spacerobot.diagnosis.selection.model_choice import Told, groups, slack
from spacerobot.diagnosis.selection.nested_laws import chance_edge
from spacerobot.diagnosis.terms.candidates import refines
from spacerobot.diagnosis.terms.data import ends_of
from spacerobot.diagnosis.terms.decision import TIE, TWICE

DRAWN = 400
"""Campaigns: 5 % of them are known to 1.1 %."""

POWER = 0.95
"""Share of the campaigns in which the effect is named at its limit."""

RIVALS = 8
"""Rivals that a size is tried against: those that imitate most of it."""

GROWTH = 1.2
"""Factor by which sizes are tried until one is named, before it is looked for between the last two."""

PASSES = 4
"""How often a column is taken again at the size that was found."""


class PartLimits(Limits):
    """Detection limits beside a part's chosen model.

    Args:
        growth: of the part.
    """

    def __init__(self, growth: Growth) -> None:
        bench = growth.bench
        super().__init__(bench.fitter(), bench.model.believed, growth.after.fit, 1.0)
        trials = [t for t in bench.trials for _ in t.channels]  # whose channels the cuts are
        every, held = [t.id for t in bench.trials], tried(growth.after)
        self.cuts = [slice(int(a), int(b)) for a, b in itertools.pairwise(ends_of(bench.trials))]
        fold = np.array([[t.id in out for _, out in bench.left_out] for t in trials], dtype=float)
        self.training = 1.0 - fold @ fold.T  # (K, K) what the fold of each is fitted to
        self.group = groups(trials)
        counted, residual = (np.concatenate([some[name] for name in every]) for some in (held.counted, held.residual))
        self.readings = np.array([max(int(counted[cut].sum()), 1) for cut in self.cuts], dtype=float)
        self.left = np.array([float(residual[cut] @ residual[cut]) for cut in self.cuts])
        self.before = float(np.sqrt(tried(growth.before).mean_square))
        # what stated noise does not exclude is told, see `nested_laws.py`
        self.bounded = bool(bench.model.expected({}))
        self.known = {s.label: s for s in bench.model.sites()}
        self.looks = len(growth.sites)  # of which a choice is the best

    @cached_property
    def noise(self) -> np.ndarray:
        """Standard normal, always the same, shape (DRAWN, K, 1 + RIVALS)."""
        return np.random.default_rng(0).standard_normal((DRAWN, len(self.cuts), 1 + RIVALS))

    def _limit(self, item: Column, columns: Sequence[Column], units: np.ndarray) -> Limit:
        parameter = item.site.effect.strength
        count = len(item.site.effect.parameters)
        rivals = [c for c in columns if c.site.label != item.site.label and len(c.site.effect.parameters) <= count]
        column, size, faintest = item.column / item.share, 0.0, 0.0
        instead: Label | None = None
        for _ in range(PASSES):
            size, instead = self._size(item, column, rivals)
            if math.isinf(size):
                return Limit(item.site, parameter, None, _placed(instead))
            size = faintest = max(size, faintest)  # of faint and full-size sensitivities, the smaller counts
            change = self._change(item.site, sized(item.site, item.start, size))
            if change is None:
                return Limit(item.site, parameter, None)
            before, column = column, self.project.free(change, np.zeros_like(self.fit.z)) / size
            if abs(math.log(max(float(column @ column), 1e-300) / float(before @ before))) < 2.0 * NEAR:
                break
        value = sized(item.site, item.start, size)[item.site.key(parameter.name)]
        smallest = value if math.isinf(parameter.null) else abs(value - parameter.null)
        return Limit(item.site, parameter, smallest, _placed(instead))

    def _size(self, item: Column, column: np.ndarray, rivals: Sequence[Column]) -> tuple[float, Label | None]:
        """The size, in units of the start, from which the effect is named; and the rival that asks most there."""
        norm = math.sqrt(float(column @ column))
        if norm == 0.0:  # at this size the free parameters do all of it
            return math.inf, None
        drawn = _Drawn(self, item, column, rivals)
        low, high = 0.0, 1.0 / norm
        if self.bounded:
            high = max(high, self._told_from_general(item))
        while not drawn.is_named(high):
            low, high = high, GROWTH * high
            if high > LARGEST:
                return math.inf, drawn.rival(low)
        while low > 0.0 and math.log(high / low) > NEAR:
            middle = math.sqrt(low * high)
            low, high = (low, middle) if drawn.is_named(middle) else (middle, high)
        return high, drawn.rival(low)

    def _told_from_general(self, item: Column) -> float:
        """The size from which a general effect's two levels are known not to be one twice the other."""
        start = item.start
        for site in self.known.values():
            if site.where != item.site.where or not refines(site.effect.name, item.site.effect.name):
                continue
            keys = [site.key(p.name) for p in site.effect.parameters]
            if len(keys) != 2 or len({p.unit for p in site.effect.parameters}) > 1:
                continue
            level = item.share * start[item.site.key(item.site.effect.strength.name)]
            moved = [self._moved(site, {k: level if k == key else 0.0 for k in keys}) for key in keys]
            if any(m is None for m in moved):
                continue
            both = np.stack([m for m in moved if m is not None])
            apart = np.array([1.0, -1.0])
            deviation = math.sqrt(max(float(apart @ np.linalg.pinv(both @ both.T) @ apart), 0.0)) * item.share
            return 2.0 * NORMAL_95 * deviation / TWICE  # the difference itself scatters as much as its interval reaches
        return 0.0


def _placed(rival: Label | None) -> tuple[Label, ...]:
    return () if rival is None else (rival,)


class _Drawn:
    """Campaigns with an effect in them, and what the decision makes of them.

    B campaigns, K channels of trials, R rivals.
    """

    def __init__(self, limits: PartLimits, item: Column, column: np.ndarray, rivals: Sequence[Column]) -> None:
        self.limits, self.item = limits, item
        unit = column / math.sqrt(float(column @ column))
        alike = sorted(rivals, key=lambda c: -abs(float(c.column @ unit)) / math.sqrt(c.norm))[:RIVALS]
        self.rivals = alike
        every = np.stack([column, *(c.column for c in alike)])
        gram = np.stack([every[:, cut] @ every[:, cut].T for cut in limits.cuts])  # (K, 1 + R, 1 + R)
        values, vectors = np.linalg.eigh(gram)
        root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        self.seen = np.einsum("kij,bkj->bki", root, limits.noise[:, :, : every.shape[0]])  # noise along the columns
        self.gram = gram
        trained = np.einsum("kl,lij->kij", limits.training, gram)
        heard = np.einsum("kl,bli->bki", limits.training, self.seen)
        self.trained, self.heard = trained, heard
        count = len(item.site.effect.parameters)
        self.least = chance_edge(count, limits.looks) if limits.bounded else NORMAL_95**2
        self.sides = np.array([item.site.effect.two_sided, *(c.site.effect.two_sided for c in alike)])

    def _fitted(self, of: int, size: float) -> np.ndarray:
        """How much of a column the folds find in the other trials, shape (B, K); nothing where these do not feel it."""
        own = self.trained[:, of, of]
        felt = own > 1e-9 * max(float(own.max()), 1e-300)
        found = (size * self.trained[:, of, 0] + self.heard[:, :, of]) / np.where(felt, own, 1.0)
        found = np.where(felt, found, 0.0)
        return found if self.sides[of] else np.maximum(found, 0.0)

    def _left(self, of: int, share: np.ndarray, size: float) -> np.ndarray:
        """Sum of squares that a model leaves over which takes so much of its column, shape (B, K)."""
        truth = self.limits.left + 2.0 * size * self.seen[:, :, 0] + size**2 * self.gram[:, 0, 0]
        own = share**2 * self.gram[:, of, of] - 2.0 * share * (size * self.gram[:, of, 0] + self.seen[:, :, of])
        return np.asarray(np.maximum(truth + own, 1e-300))

    def _told(self, one: tuple[int, np.ndarray], other: tuple[int, np.ndarray], size: float) -> Told:
        (i, a), (j, b) = one, other
        apart = a**2 * self.gram[:, i, i] - 2.0 * a * b * self.gram[:, i, j] + b**2 * self.gram[:, j, j]
        n = self.limits.readings
        return Told(self._left(i, a, size) / n, self._left(j, b, size) / n, np.maximum(apart, 0.0) / n, n)

    def _paid(self, size: float) -> np.ndarray:
        """In which campaigns the effect is worth naming and shown, shape (B,)."""
        mine = self._fitted(0, size)
        told = self._told((0, mine), (0, np.zeros_like(mine)), size)
        if self.limits.fit.hypothesis.sites:
            paid = told.rms(told.other) > slack(told.rms(told.one), np.array(self.limits.before))
        else:
            paid = told.better(self.limits.group)
        norm = float(self.gram[:, 0, 0].sum())
        found = (size * norm + self.seen[:, :, 0].sum(axis=1)) / math.sqrt(norm)
        return np.asarray(paid & (found**2 > self.least))

    def _apart(self, size: float) -> Iterator[np.ndarray]:
        """In which campaigns the effect is told from each rival, shape (B,)."""
        ours = (0, self._fitted(0, size))
        for r, rival in enumerate(self.rivals, 1):
            versus = self._told((r, self._fitted(r, size)), ours, size)
            if len(rival.site.effect.parameters) < len(self.item.site.effect.parameters):
                yield versus.rms(versus.one) > slack(versus.rms(versus.other), np.array(self.limits.before))
            else:
                yield versus.ratio >= 1.0 + TIE

    def is_named(self, size: float) -> bool:
        """Whether an effect of this size is named in as many of the campaigns as a limit asks for."""
        named = self._paid(size)
        for apart in self._apart(size):
            if np.mean(named) < POWER:
                break
            named = named & apart
        return bool(np.mean(named) >= POWER)

    def rival(self, size: float) -> Label | None:
        """The rival that it is most often not told from at this size; None where something else asks more."""
        if not self.rivals:
            return None
        alike = [float(np.mean(~apart)) for apart in self._apart(size)]
        worst = int(np.argmax(alike))
        return self.rivals[worst].site.label if alike[worst] > np.mean(~self._paid(size)) else None
