"""A check of a fit that is about to be reported, and what most of several synthetic copies say.

No single draw of noise takes an answer back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

COPIES = 3
"""Copies that decide where the first one fails a check."""


@dataclass(frozen=True)
class Check:
    """What was asked of a fit.

    Attributes:
        name: of the check.
        passed: whether the fit stood it.
        detail: with its figures, in words.
        worst: of sizes that came back from a synthetic copy, the farthest off [standard errors].
        missed: key -> what a copy missed a size by, where its interval has to be as wide [the parameter's scale].
    """

    name: str
    passed: bool
    detail: str
    worst: float = 0.0
    missed: Mapping[str, float] = field(default_factory=dict)


def agreed(tried: Callable[[int], Sequence[Check]]) -> tuple[Check, ...]:
    """The checks on a first copy; where one of them fails, what most of three copies say.

    Args:
        tried: number of a copy to its checks.
    """
    first = tried(0)
    if all(c.passed for c in first):
        return tuple(first)
    found: dict[str, list[Check]] = {}
    for checks in (first, *(tried(copy) for copy in range(1, COPIES))):
        for check in checks:
            found.setdefault(check.name, []).append(check)
    return tuple(_most(own) for own in found.values())


def _most(checks: Sequence[Check]) -> Check:
    """The check as most copies have it, in the words of one of these."""
    bad = sum(not c.passed for c in checks)
    shown = next(c for c in checks if c.passed == (2 * bad < len(checks)))
    return replace(shown, detail=f"{shown.detail} ({bad} of {len(checks)} copies failed)") if bad else shown


def why_not(checks: Iterable[Check]) -> list[str]:
    """A line for each check that failed: which, and its figures."""
    return [f"{c.name}: {c.detail or 'failed'}" for c in checks if not c.passed]
