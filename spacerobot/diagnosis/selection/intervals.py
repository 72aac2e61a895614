"""What a decision states with intervals, and what these take back: an effect that they do not show is not named.

A 95 % interval holds every value to which the cost rises by no more than chance and what was granted explain: 3.84
times the noise's own inflation for this parameter (`colour.py`), and, for how an effect acts whose law only stands for
a richer one, a small share of all it explains, which such a law's own defect may cost (`penalty.STAND_IN`).
"""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.diagnosis.fitting.colour import inflations
from spacerobot.diagnosis.fitting.fitted import Fit, interval
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.profile import LEVEL_95, Profile, profile
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.decide import Decided
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.nameable import not_shown
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.decision import STAND_IN
from spacerobot.diagnosis.terms.kinds import NAMED, SETTLED

BETTER = 1.0
"""Fall of the cost from which a minimum that a profile met takes the place of the fit: the level of an interval's ends
is 3.84, so that less moves them by an eighth of their distance at most."""

AGAIN = 3
"""Times that this may happen."""


def with_intervals(pool: Pool, decided: Decided) -> tuple[Decided, dict[str, tuple[float, float]]]:
    """A decision whose named effects are shown by their intervals, and the 95 % intervals of what it states."""
    moves = 0
    while True:  # each turn takes one set of a finite number back, or finds a better minimum
        said = decided.judgement
        chosen = said.chosen
        count_as_one = pool.aside(_inflations, chosen)() if stated(said) else {}
        for key in stated(said):
            count_as_one[key] += granted(decided.found, chosen, key) / LEVEL_95
        tasks = {key: pool.aside(_profiled, chosen, key, count_as_one[key]) for key in stated(said)}
        profiles = {key: profiled() for key, profiled in tasks.items()}
        better = _better(pool, chosen, profiles) if moves < AGAIN else None
        if better is not None:
            decided, moves = decided.improved(pool.workshop, better), moves + 1
            continue
        profiled = {key: p.ends for key, p in profiles.items()}
        why = _not_shown(said, profiled)
        if not why:
            return decided, profiled
        decided = decided.withdrawing(pool.workshop, why)


def curved(workshop: Workshop, decided: Decided) -> Decided:
    """As `with_intervals`, by the curvature of the fits instead of their profiles: no further fit is asked for."""
    while True:
        chosen, inflation = decided.judgement.chosen, decided.inflation
        if chosen.covariance is None:
            return decided
        why = _not_shown(decided.judgement, by_curvature(chosen, inflation))
        if not why:
            return decided
        decided = decided.withdrawing(workshop, why)


def by_curvature(fit: Fit, inflation: float) -> dict[str, tuple[float, float]]:
    """95 % intervals of the effects' parameters by the curvature of their fit, by key."""
    keys = [f.key for f in fit.hypothesis.free if f.kind == "effect"]
    return {key: interval(fit, key, inflation)[1] for key in keys}


def stated(judgement: Judgement) -> list[str]:
    """Keys of what the verdict gives intervals of: the values that moved, and the named effects' parameters."""
    if judgement.verdict not in SETTLED:
        return []
    free = judgement.chosen.hypothesis.free
    return [
        *(k for k in judgement.moved if k in judgement.chosen.hypothesis.keys),
        *(f.key for f in free if f.kind == "effect" and judgement.verdict == NAMED),
    ]


def granted(found: Found, chosen: Fit, key: str) -> float:
    """Rise of the cost that is no evidence against a value, for the law is known to be a stand-in.

    Only of a shape (how an effect acts) whose effect stands for something richer: what the modes of an arm add up to at
    rest, its stiffness, is no single mode's.
    """
    for site in chosen.hypothesis.sites:
        if site.effect.stands_for and any(p.shape and site.key(p.name) == key for p in site.effect.parameters):
            label = chosen.hypothesis.label
            parts = [f for f in found.fits.values() if contains(label, f.hypothesis.label)]
            without = [f for f in parts if site.label not in f.hypothesis.label]
            return STAND_IN * max(min(f.cost for f in (found.baseline, *without)) - chosen.cost, 0.0)
    return 0.0


def _better(pool: Pool, chosen: Fit, profiles: Mapping[str, Profile]) -> Fit | None:
    """The set at a better minimum that its own profiles have met; None where there is none."""
    met = [p.lowest for p in profiles.values() if p.lowest is not None]
    lowest = min(met, key=lambda f: f.cost, default=chosen)
    if lowest.cost > chosen.cost - BETTER:
        return None
    made = chosen.hypothesis
    task = Task(made.label, lowest.values(), lowest.initials(), only=made.only, freed=made.freed)
    fit = pool.here(task)
    return fit if fit is not None and fit.cost < chosen.cost - BETTER else None


def _not_shown(judgement: Judgement, intervals: Mapping[str, tuple[float, float]]) -> str:
    if judgement.verdict != NAMED:
        return ""
    values = judgement.chosen.values()
    return next((why for s in judgement.chosen.hypothesis.sites if (why := not_shown(s, values, intervals))), "")


def _inflations(workshop: Workshop, chosen: Fit) -> dict[str, float]:
    return inflations(workshop.fitter(), chosen)


def _profiled(workshop: Workshop, chosen: Fit, key: str, inflation: float) -> Profile:
    return profile(workshop.fitter(), chosen, key, inflation)
