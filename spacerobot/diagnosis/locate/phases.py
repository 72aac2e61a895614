"""The phases of a trial: approach, onset, compression, reversal, restitution, release, coast."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate.windows import Plateau, Splines, Windows

MOTION = "motion"
"""The one phase of a trial without contact."""

CONTACT_PHASES = ("onset", "compression", "reversal", "restitution", "release")
PHASES = ("approach", *CONTACT_PHASES, "coast")

SETTLE = 0.01
"""Seconds after the last bounce that still belong to the onset."""

TURN = 0.1
"""The reversal and the release are this share of the contact's duration, to either side and before its end."""

CLEAR = 2e-3
"""Distance [s] that test functions keep from the first touch and the last release."""

RAMP = 6.0
"""Length of a plateau's ramps in knot intervals."""

MANY_SIGMAS = 5.0


@dataclass(frozen=True)
class Touches:
    """Stretches of contact, in order: (touch, release) [s]; none where nothing touched."""

    stretches: tuple[tuple[float, float], ...]

    @property
    def first(self) -> float:
        """First touch [s]."""
        return self.stretches[0][0]

    @property
    def last(self) -> float:
        """Last release [s]."""
        return self.stretches[-1][1]

    def inside(self, times: np.ndarray, margin: float = 0.0) -> np.ndarray:
        """Whether each time lies in a stretch of contact, or within `margin` [s] of one; shape of `times`, bool."""
        out = np.zeros(times.shape, dtype=bool)
        for start, end in self.stretches:
            out |= (times >= start - margin) & (times <= end + margin)
        return out


def touches_in_force(time: np.ndarray, force: np.ndarray, sigma: np.ndarray, width: float = 3e-3) -> Touches:
    """Stretches of contact where a force reading stands clear of its noise.

    Args:
        time, force, sigma: of the reading, shape (T,).
        width: of the running mean that is compared with the noise [s].
    """
    step = float(np.median(np.diff(time)))
    n = min(max(1, round(width / step)), force.size)
    mean = np.convolve(force, np.full(n, 1.0 / n), "same")
    high = mean > MANY_SIGMAS * sigma / np.sqrt(n)
    low = mean > 2.0 * sigma / np.sqrt(n)
    stretches = []
    for start, end in _runs(low):
        if high[start:end].any() and end - start >= n:
            stretches.append((float(time[start]), float(time[end - 1])))
    return Touches(tuple(stretches))


def touches_in_penetration(time: np.ndarray, depth: np.ndarray, error: np.ndarray) -> Touches:
    """Contact where the force is not recorded: from the first to the last time that the surfaces are this close.

    Args:
        time, depth, error: penetration and its standard error, shape (T,).
    """
    close = np.flatnonzero(depth > -error)
    if close.size < 2:
        return Touches(())
    return Touches(((float(time[close[0]]), float(time[close[-1]])),))


def _runs(flags: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def phases_of(touches: Touches, turn: float | None, start: float, end: float) -> dict[str, tuple[float, float]]:
    """Phase -> (begin, end) [s], in order.

    Args:
        touches: of the trial.
        turn: when the bodies turn [s], None if unknown.
        start, end: of the trial [s].
    """
    if not touches.stretches:
        return {MOTION: (start, end)}
    first, last = touches.first, touches.last
    length = last - first
    middle = turn if turn is not None and first < turn < last else first + 0.5 * length
    bounces = [b for b, _ in touches.stretches if b < middle - TURN * length]
    settled = min(max(bounces, default=first) + SETTLE, middle - TURN * length)
    settled = max(settled, first)
    edges = [start, first, settled, middle - TURN * length, middle + TURN * length, last - TURN * length, last, end]
    for i in range(1, len(edges)):
        edges[i] = max(edges[i], edges[i - 1])
    return {name: (edges[i], edges[i + 1]) for i, name in enumerate(PHASES)}


def windows_of(touches: Touches, phases: Mapping[str, tuple[float, float]], spacing: float) -> Windows | None:
    """Test functions with knots `spacing` [s] apart, none of which bends across the first touch or the last release.

    Splines lie inside approach, contact and coast. Plateaus span onset, release and the whole contact: there the
    balance is of momentum before and after. None where the trial is too short for any.
    """
    if MOTION in phases:
        only = Splines.fitting(*phases[MOTION], spacing)
        return None if only is None else Windows((only,))
    first, last = touches.first, touches.last
    start, end = phases["approach"][0], phases["coast"][1]
    found: list[Splines | Plateau] = []
    for a, b in ((start, first - CLEAR), (first, last), (last + CLEAR, end)):
        part = Splines.fitting(a, b, spacing)
        if part is not None:
            found.append(part)
    ramp = RAMP * spacing
    settled = phases["onset"][1]
    for before, after, limit_low, limit_high in (
        (first - CLEAR, settled, start, last),
        (phases["release"][0], last + CLEAR, settled, end),
        (first - CLEAR, last + CLEAR, start, end),
    ):
        rise, fall = min(ramp, before - limit_low), min(ramp, limit_high - after)
        if after > before and min(rise, fall) >= 2.0 * spacing:
            found.append(Plateau(before - rise, before, after, after + fall))
    return Windows(tuple(found)) if found else None
