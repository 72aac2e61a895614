"""What else may be missing: whole sets that predict alike, or the best rivals of what is said."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TypeVar

import numpy as np

from spacerobot.diagnosis.answer.record import Alternative, placed
from spacerobot.diagnosis.answer.verdict import RIVALS
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS

T = TypeVar("T")

SETS = 32
"""Sets that an ambiguous verdict lists: those first in which fewest parts have another explanation than the best."""


def alternatives(parts: Sequence[Part], verdict: str) -> list[Alternative]:
    """Where ambiguous, the sets that predict alike, the favourite first; else the best rivals of each part.

    A set says all that may be missing: where one part is ambiguous, each of its explanations stands beside what is
    named of the others.
    """
    if verdict != AMBIGUOUS:
        out = []
        for part in parts:
            sites = part.fit.hypothesis.label
            others = [c for c in part.growth.considered if c.sites and c.label != sites]
            out += [_alternative([(part, c)]) for c in others[: max(1, RIVALS // len(parts))]]
        return out
    choices = [[(p, c) for c in (p.chosen, *p.rivals)] for p in parts]
    ordered = itertools.chain.from_iterable(sets(choices, others) for others in range(len(parts) + 1))
    return [_alternative(s) for s in itertools.islice(ordered, SETS)]


def sets(choices: Sequence[Sequence[T]], others: int) -> Iterator[tuple[T, ...]]:
    """One of each of the choices, of so many of them another than the first; in the order of a product.

    One at a time: over many parts there are more than could be listed, or held.
    """
    if not 0 <= others <= sum(len(c) > 1 for c in choices):
        return
    if not choices:
        yield ()
        return
    for place, one in enumerate(choices[0]):
        for rest in sets(choices[1:], others - (place > 0)):
            yield (one, *rest)


def _alternative(chosen: Sequence[tuple[Part, Candidate]]) -> Alternative:
    """One set over the parts. Its score is 2 ln of the held-out rms over the best one's, summed over them."""
    scores = [_score(part, one) for part, one in chosen]
    return Alternative(
        effects=[p for _, one in chosen for p in placed(one.label)],
        parameters={
            k: v
            for part, one in chosen
            for k, v in one.fit.values().items()
            if "@" in k or (one is part.growth.by_values and k in one.fit.hypothesis.freed)
        },
        score=sum(scores) if np.isfinite(scores).all() else None,
        part=", ".join(part.name for part, _ in chosen),
    )


def _score(part: Part, one: Candidate) -> float:
    tried = {c.label: c.error for c in part.growth.considered}
    # what was met after the search has been tried under the chosen one's own weights
    error = tried.get(one.label, one.error / part.growth.after.error * tried[part.growth.after.label])
    return 2.0 * math.log(error / part.growth.considered[0].error) if np.isfinite(error) else math.inf
