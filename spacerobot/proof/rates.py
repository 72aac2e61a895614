"""Rates with their uncertainty, and the tables and curves that are made of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import beta, binom

Record = Mapping[str, Any]
"""One scored campaign."""


@dataclass(frozen=True)
class Rate:
    """So many of so many, with the Clopper-Pearson interval at 95 %."""

    hits: int
    total: int

    @property
    def value(self) -> float:
        """Share; NaN of nothing."""
        return self.hits / self.total if self.total else math.nan

    @property
    def low(self) -> float:
        """Lower bound."""
        return float(beta.ppf(0.025, self.hits, self.total - self.hits + 1)) if self.hits else 0.0

    @property
    def high(self) -> float:
        """Upper bound."""
        return float(beta.ppf(0.975, self.hits + 1, self.total - self.hits)) if self.hits < self.total else 1.0

    def __str__(self) -> str:
        if not self.total:
            return "-"
        return f"{100 * self.value:.1f} % ({self.hits} of {self.total}; {100 * self.low:.1f} to {100 * self.high:.1f})"


def median_interval(values: Sequence[float]) -> tuple[float, float]:
    """Bounds of the median at 95 %, by order statistics; infinite where the values are too few for one.

    Of n values, as many lie below the median as a fair coin shows heads (e.g. David and Nagaraja 2003, Order
    Statistics, Sec. 7.1).
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    k = int(binom.ppf(0.025, ordered.size, 0.5))
    if ordered.size == 0 or k == 0:
        return -math.inf, math.inf
    return float(ordered[k - 1]), float(ordered[-k])


def rate(records: Iterable[Record], hit: Callable[[Record], bool]) -> Rate:
    """Share of the records for which `hit` holds."""
    found = [bool(hit(r)) for r in records]
    return Rate(sum(found), len(found))


def coverage(records: Iterable[Record]) -> Rate:
    """Share of the stated intervals that hold the truth, of all whose truth is known."""
    stated = [p for r in records for p in r["parameters"] if p["low"] is not None and p["high"] is not None]
    return Rate(sum(p["low"] <= p["true"] <= p["high"] for p in stated), len(stated))


def relative_errors(records: Iterable[Record]) -> list[float]:
    """|value - truth| / |truth| of the stated values whose truth is known."""
    return [
        abs(p["value"] - p["true"]) / abs(p["true"])
        for r in records
        for p in r["parameters"]
        if p["value"] is not None and p["true"]
    ]


def power_curve(records: Sequence[Record], edges: Sequence[float]) -> list[tuple[float, Rate]]:
    """Detection against strength: (median strength, rate of the true set in what is given) for each bin."""
    out = []
    for low, high in itertools.pairwise(edges):
        inside = [r for r in records if r["strength"] is not None and low <= r["strength"] < high]
        if inside:
            middle = float(np.median([r["strength"] for r in inside]))
            out.append((middle, rate(inside, lambda r: bool(r["top"]))))
    return out


def smallest_found(records: Sequence[Record], share: float = 0.5) -> float | None:
    """Strength from which on the effect is named in at least `share` of the campaigns; None if never.

    The records are sorted by strength; the answer is the least strength above which the share holds.
    """
    known = sorted((r for r in records if r["strength"] is not None), key=lambda r: float(r["strength"]))
    hits = np.array([bool(r["top"]) for r in known], dtype=float)
    if not hits.size:
        return None
    above = np.cumsum(hits[::-1])[::-1] / np.arange(hits.size, 0, -1)
    good = np.flatnonzero(above >= share)
    if not good.size:
        return None
    first = next((i for i in range(hits.size) if (above[i:] >= share).all()), None)
    return None if first is None else float(known[first]["strength"])


def reliability(records: Sequence[Record], bins: int = 5) -> list[tuple[float, Rate]]:
    """Stated confidence against the share that was right: (mean confidence, rate) for each bin."""
    stated, said, group = _binned(records, bins)
    out = []
    for i in range(bins):
        inside = [r for r, own in zip(stated, group, strict=True) if own == i]
        if inside:
            out.append((float(np.mean(said[group == i])), rate(inside, lambda r: bool(r["top"]))))
    return out


def _binned(records: Sequence[Record], bins: int) -> tuple[list[Record], np.ndarray, np.ndarray]:
    """Records that state a confidence, what it is, shape (R,), and in which of so many equal bins, shape (R,)."""
    stated = [r for r in records if r["confidence"] is not None]
    said = np.array([float(r["confidence"]) for r in stated])
    edges = np.linspace(0.0, 1.0, bins + 1)
    return stated, said, np.clip(np.searchsorted(edges, said, side="right") - 1, 0, bins - 1)


REDRAWN = 2000
"""Bootstrap samples of the records."""


def calibration_error(records: Sequence[Record], bins: int = 5) -> tuple[float, float, float]:
    """Expected calibration error: |stated confidence - share that was right|, averaged over bins by their counts.

    Returns:
        it, and the bounds that hold it in 95 of 100 redrawn batches (percentiles, always the same draws); NaN of none.

    Naeini, Cooper, Hauskrecht (2015), AAAI, Eq. 3.
    """
    stated, said, group = _binned(records, bins)
    if not stated:
        return math.nan, math.nan, math.nan
    right = np.array([bool(r["top"]) for r in stated], dtype=float)

    def error(taken: np.ndarray) -> float:
        off = np.bincount(group[taken], weights=(said - right)[taken], minlength=bins)
        return float(np.abs(off).sum() / taken.size)

    random = np.random.default_rng(0)
    drawn = [error(random.integers(said.size, size=said.size)) for _ in range(REDRAWN)]
    low, high = np.quantile(drawn, (0.025, 0.975))
    return error(np.arange(said.size)), float(low), float(high)


def place(label: Sequence[str]) -> str:
    """An effect and its place in words; one joint is as good as another."""
    effect, where = label
    return f"{effect} at {'joint' if where.startswith('joint.') else where}"


def confusion(records: Iterable[Record]) -> dict[str, dict[str, int]]:
    """Hidden effect -> what was said -> how often; of campaigns with one hidden effect, or none."""
    table: dict[str, dict[str, int]] = {}
    for record in records:
        hidden = record["hidden"]
        if len(hidden) > 1:
            continue
        row = place(hidden[0]) if hidden else record["expected"]
        if record.get("withheld"):
            row += " (withheld)"
        favourite = record["favourite"]
        said = " + ".join(place(f) for f in favourite) if favourite else record["said"]
        table.setdefault(row, {})
        table[row][said] = table[row].get(said, 0) + 1
    return table
