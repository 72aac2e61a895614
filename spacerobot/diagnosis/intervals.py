"""What a decision states with intervals, and what these take back: an effect that they do not show is not named."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.diagnosis.decide import Decided
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.judge import NAMED, Judgement
from spacerobot.diagnosis.pool import Pool
from spacerobot.diagnosis.profile import profile_interval
from spacerobot.diagnosis.shown import not_shown
from spacerobot.diagnosis.workshop import Workshop


def with_intervals(pool: Pool, decided: Decided) -> tuple[Decided, dict[str, tuple[float, float]]]:
    """A decision whose named effects are shown by their intervals, and the 95 % intervals of what it states, by key."""
    while True:  # each turn takes one set of a finite number back
        said = decided.judgement
        chosen, inflation = said.chosen, decided.inflation
        tasks = {key: pool.aside(_profiled, chosen, key, inflation) for key in stated(said)}
        profiled = {key: interval() for key, interval in tasks.items()}
        why = _not_shown(said, profiled)
        if not why:
            return decided, profiled
        decided = decided.withdrawing(pool.workshop, why)


def stated(judgement: Judgement) -> list[str]:
    """Keys of what the verdict gives intervals of: the values that moved, and the named effects' parameters."""
    free = judgement.chosen.hypothesis.free
    return [
        *(k for k in judgement.moved if k in judgement.chosen.hypothesis.keys),
        *(f.key for f in free if f.kind == "effect" and judgement.verdict == NAMED),
    ]


def _not_shown(judgement: Judgement, intervals: Mapping[str, tuple[float, float]]) -> str:
    if judgement.verdict != NAMED:
        return ""
    values = judgement.chosen.values()
    return next((why for s in judgement.chosen.hypothesis.sites if (why := not_shown(s, values, intervals))), "")


def _profiled(workshop: Workshop, chosen: Fit, key: str, inflation: float) -> tuple[float, float]:
    return profile_interval(workshop.fitter(), chosen, key, inflation)
