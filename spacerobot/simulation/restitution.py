"""Restitution of a run, three ways that differ where the hand moves, and how long the contact lasted."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.theory.restitution import measured

POINT_NOTE = (
    "restitution at the contact point may exceed 1: the point on the wrist is the slider's tip, which its spring "
    "drives back at the separation; the energy balance is that of target and hand"
)
"""What a reader must know where target and tip part faster than they met."""


@dataclass(frozen=True)
class Speeds:
    """Along the approach at one moment [m/s].

    Attributes:
        hand, target: of the hand and of the target's centre of mass.
        closing: rate of the penetration, at the contact point.
    """

    hand: float
    target: float
    closing: float


@dataclass(frozen=True)
class Restitution:
    """How a target came back.

    Attributes:
        target: of the target alone, in the frame in which the hand was at rest: -(v_t' - v_h)/(v_t - v_h).
        hand: target against hand, -(v_t' - v_h')/(v_t - v_h); Eq. 17 of Uyama et al. (2012).
        point: at the contact point, rate of separation over rate of approach.
        first_touch: [s]; NaN if they never touched.
        last_separation: [s]; NaN if they touch at the end.
        contact_time: first touch to last separation [s].
        contact_time_summed: time in which the contact carried force [s].
        touches: how often.

    The numbers after are those at the last separation; all are NaN where there is none.
    """

    target: float
    hand: float
    point: float
    first_touch: float
    last_separation: float
    contact_time: float
    contact_time_summed: float
    touches: int


def restitution_of(
    intervals: list[tuple[float, float]], end: float, before: Speeds | None, after: Speeds | None
) -> Restitution:
    """Restitution from the contact's intervals and the speeds at their ends.

    Args:
        intervals: (touch, release) in order [s].
        end: of the run [s]; an interval that lasts until then is no separation.
        before: at the first touch, None without one.
        after: at the last separation, None without one.
    """
    if not intervals or before is None:
        return Restitution(*(math.nan,) * 6, 0.0, 0)
    first, last = intervals[0][0], intervals[-1][1]
    summed = sum(b - a for a, b in intervals)
    if last >= end or after is None:
        return Restitution(*(math.nan,) * 3, first, math.nan, math.nan, summed, len(intervals))
    nan = math.nan
    three = (
        measured(
            (before.hand, before.target - before.closing, before.target),
            (after.hand, after.target - after.closing, after.target),
        )
        if before.closing > 0.0 and before.target > before.hand
        else None
    )
    target, hand, point = (three.target, three.hand, three.point) if three else (nan, nan, nan)
    return Restitution(target, hand, point, first, last, last - first, summed, len(intervals))
