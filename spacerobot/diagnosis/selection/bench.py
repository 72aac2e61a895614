"""One model at work: fitted, weighed by what it leaves, tried on unseen trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fit_store import Kept, of_fit
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import floor_of, reweighted, rms_of
from spacerobot.diagnosis.fitting.screen import FAINT, Screener, faint
from spacerobot.diagnosis.fitting.starts import fit_near
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.held_out import MOST, HeldOut, folds, predict_held_out
from spacerobot.diagnosis.selection.nameable import plausible
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.support.errors import SimulationError

STEPS = 15
"""Gauss-Newton steps of a fit."""

FINE = 1.0 / 30.0
"""Weights of a search expect a residual this small a part of the baseline's: what a good model may well leave."""


Row = tuple[tuple[str, str], dict[str, float], float]
"""A promise as a store holds it."""


@dataclass(frozen=True, eq=False)
class Promise:
    """One effect more than a fitted model has, before it is fitted itself."""

    site: Site
    start: Mapping[str, float]
    cost: float  # that it would come down to


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

    def promises(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        """What each further effect promises, by its sensitivities at a fit."""
        by = {s.label: s for s in sites}
        about = [*sorted(by), *self._weights()]
        found = self.kept.values(
            "promises", fit, about, lambda: [_as_row(p) for p in self._screened(fit, sites)], list[Row]
        )
        return [Promise(by[label], start, cost) for label, start, cost in found]

    def _screened(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        screen = Screener(self.fitter(), self.model.believed).screen(fit, sites)
        total = max(float(screen.residual @ screen.residual), 1e-300)  # its weights are robust ones: shares carry over
        out = []
        for item in screen.best().values():
            share = float(np.clip(FAINT * item.amplitude, -1.0, 1.0)) if item.gain > 0.0 else FAINT
            share = share if abs(share) > 0.02 else float(np.copysign(0.02, share))
            cost = fit.cost * max(1.0 - item.gain / total, 0.0)
            out.append(Promise(item.site, faint(item.site, item.start, share), cost))
        return out

    def fitted(self, near: Fit, promise: Promise) -> Fit | None:
        """A promise fitted; None where it cannot be, or where the fit is no physics."""
        return self.fitted_as(near, (*near.hypothesis.sites, promise.site), promise.start)

    def fitted_as(self, near: Fit, sites: Sequence[Site], start: Mapping[str, float]) -> Fit | None:
        """These effects fitted, beginning at another fit where they share parameters with it; None as above."""
        fitter, believed = self.fitter(), self.model.believed

        def compute() -> Fit | None:
            try:
                return fit_near(fitter, believed, sites, near, start, max_iterations=STEPS)
            except SimulationError:
                return None

        about = ["near", *of_fit(near), sorted(start.items()), *self._weights()]
        fit = self.kept.fit(hypothesis(believed, sites, start), fitter, about, compute)
        return fit if fit is not None and plausible(sites, fit.values(), self.model.size_at) else None

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
    return promise.site.label, dict(promise.start), promise.cost
