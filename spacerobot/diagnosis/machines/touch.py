"""When something touched an arm: the moment at which its torque balance is first shaken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PAST = 1.0
"""Time [s] before a moment that says how much the balance is shaken anyway."""

BLIND = 0.05
"""Time [s] right before a moment that does not count among its past."""

SLOW = 0.05
"""Time [s] whose mean is taken off: what is slower is no shock."""

AHEAD = 0.01
"""Length [s] of the stretch that is compared with the past."""

LOUD = 50.0
"""A shock has at least so many times the past's mean square, in one joint at least."""

SHARE = 0.2
"""Stretches with this share of the loudest one's ratio belong to shocks as well."""

EPISODE = 1.0
"""All of them lie within this time [s]; else the balance is shaken again and again, by the machine itself."""


@dataclass(frozen=True)
class Moment:
    """A moment [s] on its trial's clock, with the interval that it lies in."""

    time: float
    low: float
    high: float


def first_shock(time: np.ndarray, residual: np.ndarray, smear: float = 0.0) -> Moment | None:
    """The moment at which a balance that was quiet is first shaken; None where it never is, or all the time.

    Args:
        time: shape (T,) [s], even.
        residual: of each joint's balance, shape (T, J) [N m or N].
        smear: half the width [s] of the filter that the residual went through.
    """
    step = float(np.median(np.diff(time)))
    past, blind, slow, ahead = (max(1, round(x / step)) for x in (PAST, BLIND, SLOW, AHEAD))
    if time.size < past + blind + ahead + slow:
        return None
    fast = residual - _trailing(residual, slow)
    square = fast**2
    loud = _trailing(square, ahead)[past + blind + ahead :]  # of the stretch that ends at a moment
    quiet = _trailing(square, past)[past : past + loud.shape[0]]  # of the past that ends BLIND before it begins
    ends = time[past + blind + ahead :]
    ratio = (loud / np.maximum(quiet, 1e-300)).max(axis=1)
    most = float(ratio.max())
    clear = np.flatnonzero(ratio > SHARE * most)
    if most < LOUD or ends[clear[-1]] - ends[clear[0]] > EPISODE:
        return None
    end = float(ends[clear[0]])
    low, high = end - AHEAD - smear, end + smear
    return Moment(0.5 * (low + high), low, high)


def _trailing(value: np.ndarray, count: int) -> np.ndarray:
    """Mean of each sample's `count` predecessors, shape as `value`; of fewer at the start."""
    total = np.cumsum(np.vstack([np.zeros((1, value.shape[1])), value]), axis=0)
    index = np.arange(value.shape[0])
    first = np.maximum(index - count, 0)
    return np.asarray((total[index] - total[first]) / np.maximum(index - first, 1)[:, None])
