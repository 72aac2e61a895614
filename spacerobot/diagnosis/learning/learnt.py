"""A law that was learned, of whatever machine: its curve, its formula, and how it predicts."""

from __future__ import annotations

from dataclasses import dataclass

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.learning.describe import Described
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.terms.hypothesis import Site


@dataclass(frozen=True, eq=False)
class Learnt:
    """A law that was learned.

    Attributes:
        curve: the most probable one.
        lead: log of its odds over the next other kind or port.
        held: how well trials are predicted by it that it was not fitted to; by the formulas, as what was selected.
        told: its formula, where one says as much.
        form: the fit with the formula in the curve's place.
    """

    curve: Curve
    lead: float
    held: Unseen | None
    told: Described | None = None
    form: Fit | None = None

    @property
    def trusted(self) -> bool:
        """Whether it predicts trials that it has not seen better than the baseline does."""
        return self.held is not None and self.held.check().passed

    @property
    def site(self) -> Site:
        """The law at its port, as `fit` has it."""
        return next(s for s in self.fit.hypothesis.sites if s.effect.learned)

    @property
    def fit(self) -> Fit:
        """With the formula where there is one: beyond what was visited it goes on, the curve does not."""
        return self.form or self.curve.fit
