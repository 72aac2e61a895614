"""What a search from a baseline to the simplest model that predicts as well as any has found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.terms.hypothesis import Label, Site


@dataclass(frozen=True, eq=False)
class Growth:
    """What was found.

    Attributes:
        bench: the model, with its trials under the weights that the chosen candidate asks for.
        before: the baseline.
        after: the chosen candidate; the baseline where nothing pays.
        rivals: candidates of no more parameters, in no more effects, that predict as well; and those with a general
            effect for a special case that stated noise does not exclude.
        considered: every candidate that was tried on unseen trials, best first.
        screened: share that each set of effects promised to leave over, by its sensitivities, fitted then or not.
        refused: choices that did not stand, by their labels, with the reason.
        sites: every effect at every place that was considered.
        weights: by channel, what the model's own weights are divided by where candidates are considered.
    """

    bench: Bench
    before: Candidate
    after: Candidate
    rivals: tuple[Candidate, ...]
    considered: tuple[Candidate, ...]
    screened: tuple[tuple[Label, float], ...]
    refused: Mapping[Label, str] = field(default_factory=dict)
    sites: tuple[Site, ...] = ()
    weights: Mapping[str, float] = field(default_factory=dict)

    @property
    def by_values(self) -> Candidate | None:
        """Of the rivals the one that has wrong values in the place of an effect of the chosen set; None without it."""
        label = set(self.after.label)
        return next((c for c in self.rivals if c.fit.hypothesis.freed and set(c.label) < label), None)

    @property
    def considered_baseline(self) -> Candidate:
        """The baseline under the weights of the search, as the candidates beside it."""
        return next(c for c in self.considered if not c.sites)

    def size_of(self, label: Label) -> int:
        """Parameters that a set of effects brings along."""
        return sum(len(s.effect.parameters) for s in self.sites if s.label in label)

    def rms(self) -> tuple[dict[str, float], dict[str, float]]:
        """Held-out rms by channel, in the channels' units: of the baseline and as chosen."""
        before, after = (c.held_out.rms(self.bench.trials) for c in (self.before, self.after) if c.held_out)
        return before, after
