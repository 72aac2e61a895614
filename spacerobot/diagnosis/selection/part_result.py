"""One part of a study after its search: a joint, a body, a sensor, with what it lacks and how sure that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import expit

from spacerobot.diagnosis.fitting.approach import lag1
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.noise import counted_by_channel, levels_of, squares_of
from spacerobot.diagnosis.locate.located import Located, Row
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.sizes import spread
from spacerobot.diagnosis.selection.candidate import Candidate, tried
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.selection.judge import moved, sure_of_values
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.limits import Limit
from spacerobot.diagnosis.selection.model_choice import agreeing, ratio, surely
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.selection.stretches import Knock
from spacerobot.diagnosis.terms.candidates import by_name
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import (
    DOUBT,
    GOOD_PART,
    LOCATED,
    LOUD,
    QUIET,
    REWORDED,
    SIGNIFICANT,
    STRIKING,
    TIE,
)
from spacerobot.diagnosis.terms.kinds import (
    AMBIGUOUS,
    NAMED,
    NOT_TRUSTED,
    NOTHING_MISSING,
    UNKNOWN,
    WRONG_PARAMETER,
    Kind,
)


@dataclass(frozen=True)
class NotLearned:
    """Why no law was learned.

    Attributes:
        why: in words.
        refuted: whether laws were tried, and none says anything of unseen trials.
        beats: whether one that is not believed predicts unseen trials clearly better all the same than what is named.
    """

    why: str
    refuted: bool = False
    beats: bool = False


@dataclass(frozen=True, eq=False)
class Part:
    """One model of a study and the search it took part in.

    Attributes:
        growth: the search.
        located: its balances; None where it has none of its own.
        checks: of the fit itself.
        unseen: what was decided and predicted without each trial; None before that was asked.
        knocks: that struck it in single trials.
        uncut: where knocks were found, the search before the trials were cut there; a law may be what they are.
        not_learned: where nothing of the catalogue explains it, why no law was learned either.
        limits: of each effect at each place, how small it could be and still be named.
    """

    growth: Growth
    located: Located | None = None
    checks: tuple[Check, ...] = field(default=())
    unseen: Unseen | None = None
    knocks: tuple[Knock, ...] = ()
    uncut: Growth | None = None
    not_learned: NotLearned | None = None
    limits: tuple[Limit, ...] = ()

    @property
    def model(self) -> Machine:
        """What was fitted."""
        return self.growth.bench.model

    @property
    def name(self) -> str:
        """Of the model."""
        return self.model.name

    @property
    def trials(self) -> tuple[TrialData, ...]:
        """Under the weights that the chosen model asks for."""
        return self.growth.bench.trials

    @property
    def chosen(self) -> Candidate:
        """The growth's choice; the baseline where nothing pays."""
        return self.growth.after

    @property
    def fit(self) -> Fit:
        """Of the chosen candidate."""
        return self.chosen.fit

    @property
    def before(self) -> HeldOut:
        """The baseline on unseen trials."""
        return tried(self.growth.before) if self.unseen is None else self.unseen.before

    @property
    def after(self) -> HeldOut:
        """The chosen candidate on unseen trials."""
        return tried(self.chosen) if self.unseen is None else self.unseen.after

    @property
    def turning(self) -> frozenset[str]:
        """Places whose displacement is an angle."""
        trial = self.trials[0]
        mechanism = self.model.trial_mechanism(self.fit.hypothesis, self.fit.z, trial)
        return frozenset(p for p in mechanism.ports if mechanism.angular(p))

    @property
    def rivals(self) -> tuple[Candidate, ...]:
        """Candidates that predict as well as the chosen one."""
        return self.growth.rivals if self.chosen is not self.growth.before else ()

    @property
    def in_all(self) -> set[tuple[str, str]]:
        """What the choice and every set that predicts as well have, by the names that a verdict gives."""
        return set.intersection(*(set(by_name(c.label)) for c in (self.chosen, *self.rivals)))

    @property
    def moved(self) -> tuple[str, ...]:
        """Believed values beyond three of their sigmas."""
        return moved(self.fit)

    @property
    def shown(self) -> bool:
        """Whether what the chosen model leaves of some channel goes on from one reading to the next."""
        residuals = {t.id: self.fit.trials[t.id].residual for t in self.trials}
        found = [lag1(some) for some in counted_by_channel(residuals, self.trials).values()]
        return any(lag > SIGNIFICANT / max(count, 1) ** 0.5 for lag, count in found)

    @property
    def striking(self) -> tuple[Row, ...]:
        """Patterns in its balances that are significant and large.

        Where the readings themselves are predicted balances decide nothing: what leaves the readings white is no more
        than their noise.
        """
        rows = self.located.rows if self.located is not None else ()
        found = tuple(r for r in rows if r.p < LOCATED and r.share > STRIKING)
        return found if found and (self.shown or not self.model.predicts_readings) else ()

    @property
    def borne_out(self) -> bool:
        """Whether what strikes in its balances may be a force.

        Where the readings themselves are predicted, a pattern that no force bears out on unseen trials, neither of the
        catalogue nor learned, is none: a controller that makes up for what disturbs it pushes in step with that.
        """
        if not self.striking:
            return False
        if self.not_learned is None or not (self.not_learned.refuted and self.model.predicts_readings):
            return True
        plain = self.growth.considered_baseline
        return any(surely(c, plain, self.trials) for c in self.growth.considered if c.sites)

    @property
    def loudness(self) -> dict[str, float]:
        """By channel, rms of what the chosen model leaves over the noise that is stated; empty where none is."""
        left = levels_of(self.fit.residuals(), self.trials)
        return {c: left[c] / noise for c, noise in self.model.expected(self.fit.values()).items()}

    @property
    def unexplained(self) -> bool:
        """Whether what is left goes on and is much more than its logs scatter; of a balance, a good part of it too."""
        left = levels_of(self.fit.residuals(), self.trials)
        quiet = self.model.logged(self.fit.values())
        part = 0.0 if self.model.predicts_readings else GOOD_PART
        return self.shown and any(
            left[c] > max(QUIET * noise, part * spread(self.trials, c)) for c, noise in quiet.items()
        )

    def louder(self, times: float) -> bool:
        """Whether so many times the noise that is stated is left, and goes on: no other noise, but a motion."""
        return self.shown and any(x > times for x in self.growth.bench.loudness(self.fit).values())

    @property
    def verdict(self) -> Kind:
        """As in verdict.json, of this part alone."""
        if self.model.not_measured or not all(c.passed for c in self.checks):
            return NOT_TRUSTED
        if any(x > LOUD for x in self.loudness.values()):
            return UNKNOWN
        if self.fit.hypothesis.sites:
            beaten = self.not_learned is not None and self.not_learned.beats
            if beaten or self.louder(QUIET):  # the name is not the physics
                return UNKNOWN
            return AMBIGUOUS if self.rivals else NAMED
        if self.knocks:  # pushes make up for much; what they leave must not be a force that nobody knows
            return UNKNOWN if self.unexplained else NAMED
        if self.borne_out or self.unexplained or self.louder(LOUD):
            return UNKNOWN
        return WRONG_PARAMETER if self.moved else NOTHING_MISSING

    @property
    def confidence(self) -> float:
        """Between 0 and 1: how clear the lead over rivals is, and in how many of the unseen pieces it holds."""
        sites = self.fit.hypothesis.sites
        if not sites:
            base = self.growth.considered_baseline
            lead = min((ratio(c, base) for c in self.growth.considered if c.sites), default=np.inf) - 1.0 + TIE
            clear = 1.0 - DOUBT * np.exp(-max(lead, 0.0) / TIE)
            return float(np.clip(clear * sure_of_values(self.fit), DOUBT, 0.99))
        if (values := self.growth.by_values) is not None:
            return float(np.clip(expit(0.5 * (score(values.fit) - score(self.fit))), 0.05, 0.99))
        own = next(c for c in self.growth.considered if c.label == self.growth.after.label)
        every = [(c, ratio(c, own)) for c in self.growth.considered]
        said = [set(by_name(w.label)) for w in self._wordings(own, every)]  # in whatever form
        others = [(c, x) for c, x in every if not any(names <= set(by_name(c.label)) for names in said)]
        leads = [x - 1.0 for c, x in others if not (c.simplicity > own.simplicity and abs(x - 1.0) < TIE)]
        clear = 1.0 - DOUBT * np.exp(-max(min(leads, default=np.inf), 0.0) / TIE)
        share = agreeing(self.chosen, self.growth.before)
        return float(np.clip(clear * share, 0.05, 0.99))

    @staticmethod
    def _wordings(own: Candidate, every: Sequence[tuple[Candidate, float]]) -> list[Candidate]:
        """The choice, and it said with more effects: friction of two levels is friction of one and a constant push."""
        longer = [
            c for c, x in every if c.size == own.size and len(c.sites) > len(own.sites) and abs(x - 1.0) <= REWORDED
        ]
        return [own, *longer]

    @property
    def selected(self) -> HeldOut:
        """What each fold has itself chosen, on unseen trials."""
        return self.after if self.unseen is None else self.unseen.selected

    def errors(self) -> dict[str, tuple[float, float, float, int]]:
        """By channel: sums of squares of what is held out before, after and as selected [SI squared], and readings."""
        both = [t for t in self.trials if t.id in self.before.residual and t.id in self.after.residual]
        told = [squares_of(h.residual, both, self.after.counted) for h in (self.before, self.after, self.selected)]
        return {c: (told[0][c][0], told[1][c][0], *told[2][c]) for c in told[0]}


def balance(part: Part, name: str, parts: Sequence[Part]) -> str:
    """Name of a balance; where another part calls one of its own alike, with the part's name."""
    others = [r.balance for p in parts if p is not part and p.located is not None for r in p.located.rows]
    return f"{part.name}: {name}" if name in others else name
