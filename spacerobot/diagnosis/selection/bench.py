"""One model at work: fitted, weighed by what it leaves, tried on unseen trials."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.fitting.fit_store import Kept, of_fit
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import common_level, floor_of, levels_of, reweighted, rms_of
from spacerobot.diagnosis.fitting.screen import FAINT, At, Screened, Screener, faint
from spacerobot.diagnosis.fitting.starts import fit_near
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.held_out import MOST, HeldOut, folds, predict_held_out
from spacerobot.diagnosis.selection.nameable import implausible, reached
from spacerobot.diagnosis.selection.swinging import starts
from spacerobot.diagnosis.terms.data import TrialData, ends_of
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.support.errors import SimulationError

STEPS = 15
"""Gauss-Newton steps of a fit."""

FINE = 1.0 / 30.0
"""Weights of a search expect a residual this small a part of the baseline's: what a good model may well leave."""


Row = tuple[tuple[str, str], dict[str, float], float]
"""A promise as a store holds it."""

FEW_STEPS = 6
"""Of a fit that only shows what an effect may come to."""

BEGUN, FIRST = 2, 2
"""Starts of such an effect from which these steps are taken, those that are best after so many first steps."""

PROMISING = 40
"""Pairs of effects that are kept for the search to choose among, those that promise most."""

TRACE = 0.002
"""Least share of a start at which a fit begins."""


@dataclass(frozen=True, eq=False)
class Promise:
    """One effect more than a fitted model has, before it is fitted itself."""

    site: Site
    start: Mapping[str, float]
    left: float  # what it would leave over, see `Bench.left`


class Bench:
    """A model, its trials under the present weights, and what is left out of them in turn."""

    def __init__(self, model: Machine, threads: int = 1, kept: Kept | None = None, most: int = MOST) -> None:
        """`kept` holds what a run that was stopped had found; candidates are tried in at most `most` folds."""
        self.model, self.threads = model, threads
        self.kept = kept or Kept(None, model.name)
        self.trials: tuple[TrialData, ...] = model.trials
        self.left_out = tuple(folds(model.trials, most))
        self._factor: dict[str, float] = {}

    def fitter(self) -> Fitter:
        """Under the present weights."""
        return Fitter(self.model, self.trials, threads=self.threads)

    def baseline(self) -> Fit:
        """The model without any effect."""
        made, fitter = hypothesis(self.model.believed, ()), self.fitter()
        fit = self.kept.fit(made, fitter, ["baseline"], lambda: fitter.fit(made, max_iterations=STEPS))
        assert fit is not None  # a baseline that cannot be fitted raises
        return fit

    def sharpen(self, fit: Fit) -> None:
        """Weights that a fit's own rms would satisfy at a small part of it, so that descents end where they should."""
        self._set({c: FINE * f for c, f in rms_of(fit.residuals(), self.trials).items()})

    def weigh(self, fit: Fit) -> None:
        """Weights from what a fit leaves over, so that chi-squared counts independent samples."""
        self._set(floor_of(fit.residuals(), self.trials))

    def _set(self, ratios: Mapping[str, float]) -> None:
        """A sensor whose noise is stated is never believed more than that."""
        factor = dict(self.weights)
        for channel, ratio in ratios.items():
            total = factor.get(channel, 1.0) * (ratio or 1.0)
            factor[channel] = max(total, 1.0) if channel in self.model.stated else total
        self.weights = factor

    @property
    def weights(self) -> Mapping[str, float]:
        """By channel, what the model's own weights are divided by."""
        return self._factor

    @weights.setter
    def weights(self, factor: Mapping[str, float]) -> None:
        self._factor = dict(factor)
        self.trials = reweighted(self.model.trials, self._factor)

    def again(self, fit: Fit) -> Fit:
        """The same hypothesis under the present weights."""
        fitter = self.fitter()
        found = self.kept.fit(
            fit.hypothesis,
            fitter,
            ["again", *of_fit(fit), *self._weights()],
            lambda: fitter.fit(
                fit.hypothesis, warm=fit.values(), initials=fit.initials(), max_iterations=STEPS, robust=False
            ),
        )
        assert found is not None
        return found

    def _weights(self) -> list[tuple[str, float]]:
        """The present weights, as part of what decides a fit."""
        return sorted(self._factor.items())

    def left(self, fit: Fit) -> float:
        """What a fit leaves over of all channels together."""
        return self._left(np.concatenate([fit.trials[t.id].residual for t in self.trials]))

    def loudness(self, fit: Fit) -> dict[str, float]:
        """By channel, rms of what a fit leaves over the noise that is stated, readings' too; empty where none is."""
        left = levels_of(fit.residuals(), self.trials)
        return {c: left[c] / noise for c, noise in self.model.stated_noise(fit.values()).items()}

    def _left(self, residual: np.ndarray) -> float:
        """The same of all trials' residuals in a row, shape (S,)."""
        counts = self._by_channel(self._valid)
        return float(counts.sum()) * common_level(self._by_channel(np.square(residual)), counts)

    @cached_property
    def _valid(self) -> np.ndarray:
        """Which of all trials' samples in a row are, shape (S,), 0 or 1; whatever they weigh."""
        return np.concatenate([t.valid for t in self.model.trials]).astype(float)

    @cached_property
    def _pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """Where each channel of each trial begins in such a row, and which channel it is."""
        trials = self.model.trials
        which = np.unique([c for t in trials for c in t.channels], return_inverse=True)[1]
        return ends_of(trials)[:-1], which

    def _by_channel(self, row: np.ndarray) -> np.ndarray:
        """Sums of all trials' samples by channel, shape (S,) to (C,)."""
        starts, which = self._pieces
        return np.bincount(which, np.add.reduceat(row, starts))

    def promises(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        """What each further effect promises, by its sensitivities at a fit."""
        by = {s.label: s for s in sites}
        about = [*sorted(by), *self._weights()]
        found = self.kept.values(
            "promises", fit, about, lambda: [_as_row(p) for p in self._screened(fit, sites)], list[Row]
        )
        return [Promise(by[label], start, left) for label, start, left in found]

    def gains(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        """Further effects, by what each would leave of a fit's cost: believed values put back count; best first."""
        best = self._screener(fit).screen(fit, sites).best().values()
        return [Promise(item.site, _begun(item, item.amplitude), fit.cost - item.gain) for item in best]

    def pairs(self, fit: Fit, sites: Sequence[Site]) -> list[tuple[Promise, Promise]]:
        """Two effects more, as they promise together, best first; each has what both leave over.

        What makes up for a constant that was fitted in their stead may be worth nothing alone: dry friction and drag
        beside a damper that had stood for both.
        """
        by = {s.label: s for s in sites}
        about = [*sorted(by), *self._weights()]
        rows = self.kept.values("pairs", fit, about, lambda: self._paired(fit, sites), list[tuple[Row, Row]])
        return [
            (Promise(by[one], start, left), Promise(by[two], beside, also))
            for (one, start, left), (two, beside, also) in rows
        ]

    def _paired(self, fit: Fit, sites: Sequence[Site]) -> list[tuple[Row, Row]]:
        screen = self._screener(fit).screen(fit, sites)
        out: list[tuple[Row, Row]] = []
        for _, one, other in screen.pairs():
            columns = np.stack([one.column, other.column])
            amplitudes = np.linalg.lstsq(columns.T, -screen.residual, rcond=1e-6)[0]
            if any(a < 0.0 and not s.site.effect.two_sided for a, s in zip(amplitudes, (one, other), strict=True)):
                continue
            left = self._left(self._readings(screen.residual + amplitudes @ columns))
            starts = [_begun(s, float(a)) for s, a in zip((one, other), amplitudes, strict=True)]
            out.append(((one.site.label, starts[0], left), (other.site.label, starts[1], left)))
        return sorted(out, key=lambda pair: pair[0][2])[:PROMISING]

    def _readings(self, column: np.ndarray) -> np.ndarray:
        """Of a screened column, without what the free parameters' priors say."""
        return column[: self._valid.size]

    def _screener(self, fit: Fit) -> Screener:
        """Every reading counts as it does in the costs and held-out errors that a promise is measured by.

        What is missing may show most in the trials that fit worst.
        """
        return Screener(self.fitter(), self.model.believed.free_of(fit.hypothesis.freed), plain=True)

    def _screened(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        screener = self._screener(fit)
        at = screener.at(fit, robust=False)
        screen = screener.screen_at(at, sites)
        out = []
        for item in screen.best().values():
            amplitude = item.amplitude if item.gain > 0.0 else 0.0
            left = self._left(self._readings(screen.residual + amplitude * item.column))
            out.append(Promise(item.site, _begun(item, amplitude or 1.0), left))
        best = {p.site.label: p for p in out}
        for one in self._tried_whole(screener, at, sites):
            if one.site.label not in best or one.left < best[one.site.label].left:
                best[one.site.label] = one
        return list(best.values())

    def _tried_whole(self, screener: Screener, at: At, sites: Sequence[Site]) -> list[Promise]:
        """Of effects that let something move by itself, what a few steps of a fit from the best of some starts come to.

        Which starts are best the first steps tell.
        """
        swinging = [s for s in sites if s.effect.swinging(1.0, 1.0, 1.0)]
        return [p for s in swinging for p in self._begun_whole(at.fit, s, starts(screener, at, s))]

    def _begun_whole(self, fit: Fit, site: Site, starts: Sequence[Mapping[str, float]]) -> list[Promise]:
        """From the best of these starts of one effect more; none where no start can be simulated."""
        fitter, believed, out = self.fitter(), self.model.believed.free_of(fit.hypothesis.freed), []
        made = (*fit.hypothesis.sites, site)
        begun: list[tuple[Fit, Mapping[str, float]]] = []
        for start in starts:
            with contextlib.suppress(SimulationError):
                begun.append((fit_near(fitter, believed, made, fit, start, max_iterations=FIRST), start))
        for first, start in sorted(begun, key=lambda one: one[0].cost)[:BEGUN]:
            with contextlib.suppress(SimulationError):
                on = fit_near(fitter, believed, made, first, {}, FEW_STEPS, hopeless=fit.cost)
                out.append(Promise(site, start, self.left(on)))
        return out

    def fitted(self, near: Fit, promise: Promise) -> Fit | None:
        """A promise fitted; None where it cannot be, or where the fit is no physics."""
        return self.fitted_as(near, (*near.hypothesis.sites, promise.site), promise.start)

    def fitted_as(self, near: Fit, sites: Sequence[Site], start: Mapping[str, float]) -> Fit | None:
        """These effects fitted, beginning at another fit where they share parameters with it; None as above."""
        fit = self.fitted_anyhow(near, sites, start)
        if fit is None or implausible(sites, fit.values(), self.model.size_at):
            return None
        return fit if reached(sites, fit.values(), self.model.visited) else None

    def freed(self, near: Fit, names: tuple[str, ...]) -> Fit | None:
        """A fit's effects fitted again with these believed values free of what is stated of them."""
        return self._fitted_beside(near, near.hypothesis.sites, {}, names)

    def fitted_anyhow(self, near: Fit, sites: Sequence[Site], start: Mapping[str, float], *said: str) -> Fit | None:
        """The same though it be no physics; None where it cannot. `said` tells sites of other bounds apart."""
        return self._fitted_beside(near, sites, start, near.hypothesis.freed, *said)

    def _fitted_beside(
        self, near: Fit, sites: Sequence[Site], start: Mapping[str, float], freed: tuple[str, ...], *said: str
    ) -> Fit | None:
        fitter, believed = self.fitter(), self.model.believed.free_of(freed)

        def compute() -> Fit | None:
            try:
                return fit_near(fitter, believed, sites, near, start, max_iterations=STEPS)
            except SimulationError:
                return None

        about = ["near", *of_fit(near), sorted(start.items()), *self._weights(), freed, *said]
        return self.kept.fit(hypothesis(believed, sites, start), fitter, about, compute)

    def tested(self, fit: Fit) -> Candidate:
        """A fit tried on unseen trials."""
        return Candidate(fit, self.held_out(fit), max(self.loudness(fit).values(), default=0.0))

    def held_out(self, fit: Fit) -> HeldOut | None:
        """How well its hypothesis predicts unseen trials; None where it cannot."""

        def compute() -> HeldOut | None:
            try:
                return predict_held_out(
                    self.model, self.trials, fit.hypothesis, fit.values(), self.left_out, fit.initials()
                )
            except SimulationError:
                return None

        return self.kept.values(
            "held",
            fit,
            self._weights(),
            compute,
            HeldOut | None,
        )


def _as_row(promise: Promise) -> Row:
    return promise.site.label, dict(promise.start), promise.left


def _begun(item: Screened, amplitude: float) -> dict[str, float]:
    """Where a fit begins: at so many times what was screened, no more than whole and no less than a trace."""
    share = float(np.clip(FAINT * amplitude, -1.0, 1.0))
    return faint(item.site, item.start, share if abs(share) > TRACE else float(np.copysign(TRACE, share)))
