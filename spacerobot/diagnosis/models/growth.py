"""What a search from a baseline to the simplest model that predicts as well as any has found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Label
from spacerobot.diagnosis.models.bench import Bench
from spacerobot.diagnosis.models.candidate import Candidate
from spacerobot.diagnosis.models.worth import WORTH_OF_REST

CLEAR = 3.0
"""Standard errors by which a body's own value differs from nothing, where several grow together."""


@dataclass(frozen=True, eq=False)
class Growth:
    """What was found.

    Attributes:
        benches: the models, with their trials under the weights that the chosen model asks for.
        before: the baseline.
        after: the chosen candidate; the baseline where nothing pays.
        rivals: candidates of no more parameters, in no more effects, that predict as well; and those with a general
            effect for a special case that stated noise does not exclude.
        considered: every candidate that was tried on unseen trials, best first.
        screened: cost that each set of effects promised, by its sensitivities, whether fitted then or not.
    """

    benches: tuple[Bench, ...]
    before: Candidate
    after: Candidate
    rivals: tuple[Candidate, ...]
    considered: tuple[Candidate, ...]
    screened: tuple[tuple[Label, float], ...]

    @property
    def considered_baseline(self) -> Candidate:
        """The baseline under the weights of the search, as the candidates beside it."""
        return next(c for c in self.considered if not c.sites)

    def rms(self, which: int = 0) -> tuple[dict[str, float], dict[str, float]]:
        """Held-out rms of one model by channel, in the channels' units: of the baseline and as chosen."""
        trials = self.benches[which].trials
        return self.before.held_out[which].rms(trials), self.after.held_out[which].rms(trials)

    def needs(self, which: int = 0) -> bool:
        """Whether this model itself predicts unseen trials better as chosen than as believed."""
        before, after = (np.sqrt(c.held_out[which].mean_square) for c in (self.before, self.after))
        fit = self.after.fits[which]
        effects = [i for i, f in enumerate(fit.hypothesis.free) if f.kind == "effect"]
        if not effects or fit.covariance is None or not after < (1.0 - WORTH_OF_REST) * before:
            return False
        null = np.array([fit.hypothesis.free[i].z(_null(fit, i)) for i in effects])
        sigma = np.sqrt(np.maximum(np.diag(fit.covariance)[effects], 0.0))
        apart = np.abs(fit.z[effects] - null)
        return bool((apart > CLEAR * sigma)[apart > 0.0].any())


def _null(fit: Fit, index: int) -> float:
    """The value of an effect's parameter at which it does nothing."""
    key = fit.hypothesis.free[index].key
    for site in fit.hypothesis.sites:
        for parameter in site.effect.parameters:
            if site.key(parameter.name) == key:
                return parameter.null if np.isfinite(parameter.null) else parameter.upper
    raise AssertionError(key)
