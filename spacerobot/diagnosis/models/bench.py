"""One model at work: fitted, weighed by what it leaves, tried on unseen trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.fit import Fit, Fitter
from spacerobot.diagnosis.hypothesis import Site, hypothesis
from spacerobot.diagnosis.models.held_out import HeldOut, folds, predict_held_out
from spacerobot.diagnosis.models.model import Model
from spacerobot.diagnosis.models.noise import floor_of, reweighted, rms_of
from spacerobot.diagnosis.models.plausible import plausible
from spacerobot.diagnosis.screen import FAINT, Screener, faint
from spacerobot.diagnosis.starts import fit_near
from spacerobot.support.errors import SimulationError

STEPS = 15
"""Gauss-Newton steps of a fit."""

FINE = 1.0 / 30.0
"""Weights of a search expect a residual this small a part of the baseline's: what a good model may well leave."""


@dataclass(frozen=True, eq=False)
class Promise:
    """One effect more than a fitted model has, before it is fitted itself."""

    site: Site
    start: Mapping[str, float]
    cost: float  # that it would come down to


class Bench:
    """A model, its trials under the present weights, and what is left out of them in turn."""

    def __init__(self, model: Model, threads: int = 1) -> None:
        self.model, self.threads = model, threads
        self.trials: tuple[TrialData, ...] = model.trials
        self.left_out = tuple(folds(model.trials))
        self._factor: dict[str, float] = {}

    def fitter(self) -> Fitter:
        """Under the present weights."""
        return Fitter(self.model, self.trials, threads=self.threads)  # type: ignore[arg-type]

    def baseline(self) -> Fit:
        """The model without any effect."""
        return self.fitter().fit(hypothesis(self.model.believed, ()), max_iterations=STEPS)

    def sharpen(self, fit: Fit) -> None:
        """Weights that a fit's own rms would satisfy at a small part of it, so that descents end where they should."""
        self._set({c: FINE * f for c, f in rms_of(_residuals(fit), self.trials).items()})

    def weigh(self, fit: Fit) -> None:
        """Weights from what a fit leaves over, so that chi-squared counts independent samples."""
        self._set(floor_of(_residuals(fit), self.trials))

    def _set(self, ratios: Mapping[str, float]) -> None:
        """A sensor whose noise is stated is never believed more than that."""
        for channel, ratio in ratios.items():
            total = self._factor.get(channel, 1.0) * (ratio or 1.0)
            self._factor[channel] = max(total, 1.0) if channel in self.model.stated else total
        self.trials = reweighted(self.model.trials, self._factor)

    def again(self, fit: Fit) -> Fit:
        """The same hypothesis under the present weights."""
        return self.fitter().fit(
            fit.hypothesis, warm=fit.values(), initials=fit.initials(), max_iterations=STEPS, robust=False
        )

    def promises(self, fit: Fit, sites: Sequence[Site]) -> list[Promise]:
        """What each further effect promises, by its sensitivities at a fit."""
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
        try:
            fit = fit_near(self.fitter(), self.model.believed, sites, near, start, max_iterations=STEPS)
        except SimulationError:
            return None
        return fit if plausible(sites, fit.values(), self.model.sizes) else None

    def held_out(self, fit: Fit) -> HeldOut | None:
        """How well its hypothesis predicts unseen trials; None where it cannot."""
        try:
            return predict_held_out(
                self.model, self.trials, fit.hypothesis, fit.values(), self.left_out, fit.initials()
            )
        except SimulationError:
            return None


def _residuals(fit: Fit) -> dict[str, np.ndarray]:
    return {k: t.residual for k, t in fit.trials.items()}
