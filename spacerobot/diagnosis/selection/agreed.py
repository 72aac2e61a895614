"""What most of several synthetic copies say: no single draw of noise takes an answer back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

COPIES = 3
"""Copies that decide where the first one fails a check."""


def agreed(tried: Callable[[int], Sequence[dict[str, Any]]]) -> tuple[dict[str, Any], ...]:
    """The checks on a first copy; where one of them fails, what most of three copies say.

    Args:
        tried: number of a copy to its checks, by "name".
    """
    first = tried(0)
    if all(c["passed"] for c in first):
        return tuple(first)
    found: dict[str, list[dict[str, Any]]] = {}
    for checks in (first, *(tried(copy) for copy in range(1, COPIES))):
        for check in checks:
            found.setdefault(check["name"], []).append(check)
    return tuple(_most(own) for own in found.values())


def _most(checks: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The check as most copies have it, in the words of one of these."""
    bad = sum(not c["passed"] for c in checks)
    shown = next(c for c in checks if c["passed"] == (2 * bad < len(checks)))
    return {**shown, "detail": f"{shown['detail']} ({bad} of {len(checks)} copies failed)" if bad else shown["detail"]}


def why_not(checks: Iterable[Mapping[str, Any]]) -> list[str]:
    """A line for each check that failed: which, and its figures."""
    return [f"{c['name']}: {c.get('detail') or 'failed'}" for c in checks if not c["passed"]]
