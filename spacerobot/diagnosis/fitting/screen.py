"""First scores of all effects, by their sensitivities at the best fit so far; nothing is refitted here.

An effect at its start values moves every residual by some d. What of d the free parameters cannot imitate, projected
on what is left of the residual, says how much chi-squared would fall; and how small an effect would still be seen.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, State
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import effect_starts, full_starts, informed_starts, moments, sized
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.support.errors import InputError, SimulationError

FAINT = 0.1
"""Share of an effect's start value at which its sensitivities are taken."""


@dataclass(frozen=True, eq=False)
class Screened:
    """One effect at one start, scored.

    The column, kept of each site's best start, is weighted, masked and freed of what the fit can imitate.
    """

    site: Site
    start: Mapping[str, float]
    column: np.ndarray  # (S + P,) over all trials' readings, then over the free parameters' priors
    gain: float  # predicted fall of the cost
    amplitude: float  # multiple of the column at which it would come
    norm: float  # |column|^2


@dataclass(frozen=True, eq=False)
class Screen:
    """All scores at one fit."""

    fit: Fit
    scored: tuple[Screened, ...]  # best first, one per site and start
    residual: np.ndarray  # (S + P,) weighted and masked, freed of what the fit can imitate

    def best(self) -> dict[tuple[str, str], Screened]:
        """The best start of each site, best first."""
        out: dict[tuple[str, str], Screened] = {}
        for item in self.scored:
            out.setdefault(item.site.label, item)
        return out

    def pairs(self) -> list[tuple[float, Screened, Screened]]:
        """Every pair of sites at their best starts with the predicted fall of the cost, best first."""
        singles = list(self.best().values())
        if len(singles) < 2:
            return []
        columns = np.stack([s.column for s in singles])
        gram = columns @ columns.T
        right = columns @ self.residual
        out = []
        for i in range(len(singles)):
            for j in range(i):
                block = gram[np.ix_([i, j], [i, j])]
                b = right[[i, j]]
                det = block[0, 0] * block[1, 1] - block[0, 1] ** 2
                if det <= 1e-6 * block[0, 0] * block[1, 1]:
                    gain = max(singles[i].gain, singles[j].gain)
                else:
                    gain = float(b @ np.linalg.solve(block, b))
                out.append((gain, singles[i], singles[j]))
        return sorted(out, key=lambda p: -p[0])


@dataclass(frozen=True, eq=False)
class At:
    """The fit at which effects are scored, and what it leaves over."""

    fit: Fit
    state: State
    project: Projector
    residual: np.ndarray  # (S + P,) freed of what the fit can imitate

    def change(self, moved: State) -> np.ndarray:
        """By what another state's readings differ, shape (S + P,), freed of what the fit can imitate."""
        stack = self.project.stack
        return self.project.free(stack(moved.raw) - stack(self.state.raw), np.zeros_like(self.fit.z))


class Screener:
    """Scores effects at a fit."""

    def __init__(self, fitter: Fitter, believed: Believed, *, plain: bool = False) -> None:
        """With `plain` every reading counts, those of trials that do not fit yet too, and no probe of an effect is
        larger than what is left to explain: rollouts of a machine that swings are far from linear in what damps it.
        """
        self.fitter = fitter
        self.believed = believed
        self.plain = plain

    def screen(self, fit: Fit, sites: Sequence[Site]) -> Screen:
        """Scores of adding each site to the fit's own hypothesis."""
        return self.screen_at(self.at(fit, robust=not self.plain), sites)

    def screen_at(self, at: At, sites: Sequence[Site]) -> Screen:
        """The same at a fit that stands."""
        scored = []
        for site in sites:
            starts = starts_of(site, self.fitter.trials)
            items = [self._score(at, site, start) for start in starts]
            if self.plain:
                items.append(self._jointly(at, site, starts[0]))
            found = sorted((i for i in items if i is not None), key=lambda s: -s.gain)
            scored += found[:1] + [replace(i, column=np.zeros(0)) for i in found[1:]]
        scored.sort(key=lambda s: -s.gain)
        return Screen(at.fit, tuple(scored), at.residual)

    def screen_full(self, fit: Fit, sites: Sequence[Site]) -> Screen:
        """The same at full sizes: of each effect the start and size after which least would be left over.

        A line that is slack, or friction that brings a body to rest, hardly moves a recording while it is faint, and
        not in proportion. Only what the free parameters do about it is still taken to be in proportion.
        """
        at = self.at(fit, robust=False)
        residual = at.residual
        least = float(residual @ residual)
        scored = []
        for site in sites:
            found = []
            for start in full_starts(site, self.fitter.trials):
                left = self.left_with(at, site, start)
                if left is not None:
                    norm = float(np.square(left - residual).sum())
                    found.append(Screened(site, start, np.zeros(0), least - float(left @ left), 1.0, norm))
            scored += sorted(found, key=lambda s: -s.gain)[:1]
        scored.sort(key=lambda s: -s.gain)
        return Screen(fit, tuple(scored), residual)

    def left_with(self, at: At, site: Site, start: Mapping[str, float]) -> np.ndarray | None:
        """What an effect at a start would leave over, shape (S + P,); None where it cannot be simulated."""
        moved = self.with_effect(at.fit, at.state, site, start)
        return None if moved is None else at.project.free(at.project.stack(moved.raw), at.fit.z)

    def at(self, fit: Fit, *, robust: bool) -> At:
        """A fit to score at; with `robust` channels of trials that do not fit yet weigh less."""
        state = self.state_of(fit)
        project = Projector(self.fitter, fit, state, robust=robust)
        return At(fit, state, project, project.free(project.stack(state.raw), fit.z))

    def state_of(self, fit: Fit) -> State:
        """The state of a finished fit."""
        state = self.fitter.state(fit.hypothesis, fit.z, fit.initials())
        if state is None:
            raise SimulationError("a finished fit can no longer be simulated")
        return state

    def with_effect(self, fit: Fit, state: State, site: Site, start: Mapping[str, float]) -> State | None:
        """The fit's state with an effect added to it; None where that cannot be simulated."""
        made = hypothesis(self.believed, (*fit.hypothesis.sites, site), start)
        try:
            return self.fitter.state(made, made.start({**fit.values(), **start}), state.own)
        except InputError:
            return None

    def _score(self, at: At, site: Site, start: Mapping[str, float]) -> Screened | None:
        column, residual = self._column(at, site, start, FAINT), at.residual
        if column is None:
            return None
        norm = float(column @ column)
        part = float(np.sqrt((residual @ residual) / max(norm, 1e-300)))
        if self.plain and part < 1.0 and not site.effect.removes:
            smaller = self._column(at, site, start, part * FAINT)
            if smaller is not None:
                column = smaller / part
                norm = float(column @ column)
        if norm < 1e-12:
            return Screened(site, start, column, 0.0, 0.0, norm)
        amplitude = -float(column @ residual) / norm
        if amplitude < 0.0 and not site.effect.two_sided:
            return Screened(site, start, column, 0.0, amplitude, norm)
        return Screened(site, start, column, amplitude**2 * norm, amplitude, norm)

    def _jointly(self, at: At, site: Site, start: Mapping[str, float]) -> Screened | None:
        """An effect of several strengths, each as large as it pays best beside the others; None of any other effect.

        A hose that pulls towards a far point is no multiple of one that hangs at the origin.
        """
        from scipy.optimize import lsq_linear

        strengths = [p for p in site.effect.parameters if not p.shape]
        if len(strengths) < 2 or site.effect.removes or any(p.log or p.null for p in strengths):
            return None
        sizes = {key: start[key] or 1.0 for p in strengths for key in [site.key(p.name)]}
        nothing, columns = dict.fromkeys(sizes, 0.0), []
        for key, size in sizes.items():
            column = self._column(at, site, {**start, **nothing, key: size}, FAINT)
            if column is None:
                return None
            columns.append(column)
        matrix, residual = np.stack(columns, axis=1), at.residual
        lower = [-np.inf if p.lower < 0.0 else 0.0 for p in strengths]
        times = lsq_linear(matrix, -residual, bounds=(lower, np.inf)).x
        column = matrix @ times
        norm = float(column @ column)
        gain = float(residual @ residual - np.square(residual + column).sum())
        best = {**start, **{k: float(a) * size for (k, size), a in zip(sizes.items(), times, strict=True)}}
        return Screened(site, best, column, gain, 1.0, norm) if norm >= 1e-12 else None

    def _column(self, at: At, site: Site, start: Mapping[str, float], share: float) -> np.ndarray | None:
        """What a share of an effect at a start moves, shape (S + P,); None where that cannot be simulated."""
        moved = self.with_effect(at.fit, at.state, site, {**start, **faint(site, start, share)})
        return None if moved is None else at.change(moved)


def starts_of(site: Site, trials: Sequence[TrialData]) -> list[dict[str, float]]:
    """Every start at which an effect is screened."""
    return [*effect_starts([site]), *informed_starts(site, trials), *moments(site, trials)]


def together(screens: Sequence[Screen], sites: Sequence[Site]) -> Screen:
    """Screens of several parts of these sites at one fit as one, the same however the sites were parted."""
    order = {site.label: k for k, site in enumerate(sites)}
    scored = sorted((i for s in screens for i in s.scored), key=lambda i: (-i.gain, order[i.site.label]))
    return Screen(screens[0].fit, tuple(scored), screens[0].residual)


def faint(site: Site, start: Mapping[str, float], share: float = FAINT) -> dict[str, float]:
    """The start with its strengths cut to a share, so that the residual still moves in proportion.

    An effect whose law takes the place of the baseline's own is no small change at any strength, and starts whole.
    """
    return dict(start) if site.effect.removes else sized(site, start, share)


class Projector:
    """Takes out of a column what the free parameters can imitate.

    Priors are readings too, of the parameters themselves: what a fit has absorbed by pulling believed values shows in
    them, and an effect that would let go of these values is worth what they no longer pay.

    Args:
        fitter, fit, state: where the column starts from.
        robust: whether channels of trials that do not fit yet weigh less.
        loose: believed values that are set free of what is stated of them.
    """

    def __init__(
        self, fitter: Fitter, fit: Fit, state: State, *, robust: bool = True, loose: Collection[str] = ()
    ) -> None:
        made, known = fit.hypothesis, fitter.rows_at(fit)
        self.fitter = fitter
        self.weights = {t.id: (state.weights(t) if robust else 1.0) * state.keep[t.id] for t in fitter.trials}
        count = len(made.free)
        self.pull = np.sqrt([f.prior for f in made.free])
        self.pull *= [fitter.model.believed.let_go(f.key) if f.key in loose else 1.0 for f in made.free]
        self.global_rows = []
        self.own = []
        for trial in fitter.trials:
            rows = known[trial.id] * self.weights[trial.id][:, None]
            own, _ = np.linalg.qr(rows[:, count:])
            shared = rows[:, :count]
            self.own.append(own)
            self.global_rows.append(shared - own @ (own.T @ shared))
        normal = sum(g.T @ g for g in self.global_rows) + np.diag(self.pull**2)
        self.inverse = np.linalg.pinv(normal, rcond=1e-12, hermitian=True)

    def stack(self, raw: Mapping[str, np.ndarray]) -> np.ndarray:
        """Residuals of all trials, weighted and masked, in one vector, shape (S,)."""
        return np.concatenate([raw[t.id] * self.weights[t.id] for t in self.fitter.trials])

    def free(self, column: np.ndarray, z: np.ndarray) -> np.ndarray:
        """The part of a column that no free parameter can imitate, shape (S + P,).

        Args:
            column: of readings, shape (S,).
            z: how far the free parameters are from what is believed, shape (P,).
        """
        parts, paid = self._parts(column), self.pull * z
        step = self._step(parts, paid)
        return np.concatenate(
            [*(p - g @ step for g, p in zip(self.global_rows, parts, strict=True)), paid - self.pull * step]
        )

    def beside(self, columns: Sequence[np.ndarray]) -> np.ndarray:
        """Normal matrix of the free parameters and, behind them, of what further readings would do, (P + N, P + N).

        Args:
            columns: N of readings, shape (S,) each.
        """
        more = [np.stack(parts, axis=1) for parts in zip(*(self._parts(c) for c in columns), strict=True)]
        rows = [np.concatenate([g, m], axis=1) for g, m in zip(self.global_rows, more, strict=True)]
        pull = np.concatenate([self.pull, np.zeros(len(columns))])
        return np.asarray(sum(r.T @ r for r in rows) + np.diag(pull**2))

    def shift(self, column: np.ndarray) -> np.ndarray:
        """By how much the free parameters move to imitate a column, shape (P,)."""
        return self._step(self._parts(column), np.zeros_like(self.pull))

    def _parts(self, column: np.ndarray) -> list[np.ndarray]:
        parts, first = [], 0
        for own in self.own:
            piece = column[first : first + own.shape[0]]
            first += own.shape[0]
            parts.append(piece - own @ (own.T @ piece))
        return parts

    def _step(self, parts: Sequence[np.ndarray], paid: np.ndarray) -> np.ndarray:
        shared = sum(g.T @ p for g, p in zip(self.global_rows, parts, strict=True)) + self.pull * paid
        return np.asarray(self.inverse @ shared)
