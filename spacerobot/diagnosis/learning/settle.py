"""The last word on a wrist rig: a decision that holds before its own checks, or a law that was learned instead."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.learning.learn import as_learned, learn
from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.checks import nested, synthetic, widened
from spacerobot.diagnosis.selection.confirm import confirm
from spacerobot.diagnosis.selection.decide import Decided, conclude
from spacerobot.diagnosis.selection.intervals import with_intervals
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.rig_fold import hold_out
from spacerobot.diagnosis.selection.search_state import Report
from spacerobot.diagnosis.terms.decision import CROWD, MARGIN
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, NAMED, NOT_TRUSTED, UNKNOWN


@dataclass(frozen=True, eq=False)
class Settled:
    """What is said in the end.

    Attributes:
        judgement: with all that its checks led to.
        held: how well trials kept aside are predicted; None where there are too few.
        checks: of the chosen fit.
        profiled: intervals by parameters' keys, widened where a synthetic copy missed by more.
        decided: what it rests on.
        learnt: the law that was learned; None where what is said is the catalogue's.
    """

    judgement: Judgement
    held: Unseen | None
    checks: tuple[Check, ...]
    profiled: Mapping[str, tuple[float, float]]
    decided: Decided
    learnt: Learnt | None = None


def settle(pool: Pool, decided: Decided, profiled: Mapping[str, tuple[float, float]], report: Report) -> Settled:
    """Learn a law where the catalogue has none, and where what it offers does not predict unseen trials.

    Args:
        pool: of all trials.
        decided: what the search led to.
        profiled: its intervals, by key.
        report: told of progress.
    """
    tried, best = room_for_a_law(decided.judgement), decided.found.best
    learnt = learn(pool, decided.found, report) if tried else None
    if learnt is None and decided.found.best.cost < best.cost - MARGIN:  # the law led to what the search had missed
        decided, profiled = with_intervals(pool, conclude(pool, decided.found, report))
    if learnt is None:
        checked = _checked(pool, decided, profiled, report)
        if not tried and checked.judgement.verdict == NOT_TRUSTED and checked.held and not checked.held.check().passed:
            learnt = learn(pool, decided.found, report)
        if learnt is None:
            return checked
    return Settled(as_learned(decided.judgement, learnt), learnt.held, (), {}, decided, learnt)


def room_for_a_law(said: Judgement) -> bool:
    """Whether what is said may be one law that has no name: nothing of the catalogue, or a crowd of its effects.

    What is wrong with a sensor is no part of a crowd: no law of the machine takes its place.
    """
    count = sum(s.effect.kind != "sensor" for s in said.chosen.hypothesis.sites)
    return said.verdict == UNKNOWN or (
        said.verdict in (NAMED, AMBIGUOUS) and count >= CROWD - (said.verdict == AMBIGUOUS)
    )


def _checked(pool: Pool, decided: Decided, profiled: Mapping[str, tuple[float, float]], report: Report) -> Settled:
    """The decision after its own checks."""
    first, found = decided.judgement, decided.found
    checks = [nested([found.baseline, *found.fits.values()], first.chosen)]
    named, ends = first.verdict == NAMED, dict(profiled)
    # begun together, asked for below
    copied = pool.aside(synthetic, first.chosen, first.lead) if named else None
    whole = pool.aside(confirm, first.chosen) if named else None
    unseen = hold_out(pool, first, [s.label for s in found.singles])
    report("predicting held-out conditions", 0, 1)
    held = unseen()
    if held is not None and named:
        checks.append(held.check())
    if copied is not None and whole is not None:
        report("checking on a synthetic copy", 0, 1)
        checks += copied()
        for check in checks:
            for key, missed in check.missed.items():
                ends[key] = widened(first.chosen, key, ends[key], missed)
        report("simulating with the whole robot", 0, 1)
        checks.append(whole())
    return Settled(decided.but_for([c.name for c in checks if not c.passed]), held, tuple(checks), ends, decided)
