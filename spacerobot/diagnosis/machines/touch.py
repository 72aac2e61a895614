"""When something touched an arm: the moment at which its torque balance is first shaken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d
from scipy.stats import f

from spacerobot.recordings.series import estimate_noise

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

SELDOM = 2.5e-7
"""And so many in half of the joints as a stretch of Gaussian readings exceeds with this chance (five times, of ten
after a thousand; thirty-one, of a single one after a hundred, 85 after fourteen): what touches a link loads every joint
that carries it, what a joint does by itself shakes its own balance.
"""

SHARE = 0.2
"""Stretches with this share of the loudest one's ratio belong to shocks as well."""

CLEAR = 6.0
"""Times its noise that a velocity goes one way, or is rest: fewer than one in 1e8 of Gaussian readings at rest."""

STEADY = 5
"""Times SLOW that a joint goes one way, or rests, before and after a change of its own; what a blow shakes does not."""

EPISODE = 1.0
"""All of them lie within this time [s]; else the balance is shaken again and again, by the machine itself."""


@dataclass(frozen=True)
class Moment:
    """A moment [s] on its trial's clock.

    Attributes:
        time: the moment; the middle of what lasts.
        low, high: the interval that it lies in, and with it all that lasts.
        lasts: how long [s] with its 95 % interval, where that is more than a moment.
    """

    time: float
    low: float
    high: float
    lasts: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def begins(self) -> float:
        """When [s]; the moment itself of what does not last."""
        return self.time - 0.5 * self.lasts[0]

    @property
    def ends(self) -> float:
        """When [s]."""
        return self.time + 0.5 * self.lasts[0]


def first_shock(
    time: np.ndarray,
    residual: np.ndarray,
    smear: float = 0.0,
    velocity: np.ndarray | None = None,
    blurred: np.ndarray | None = None,
) -> Moment | None:
    """The moment at which a balance that was quiet is first shaken; None where it never is, or all the time.

    Args:
        time: shape (T,) [s], even.
        residual: of each joint's balance, shape (T, J) [N m or N].
        smear: half the width [s] of the filter that the residual went through.
        velocity: of each joint, shape (T, J) [rad/s or m/s]: where one turns back its friction does too, and that
            shakes its balance without a touch; where half of those that move start, stop or turn, the machine did it.
        blurred: what the filter made of a motion that is fast for it, of which the residual is free to first order,
            shape (T, J): what is no more than this is no shock.
    """
    step = float(np.median(np.diff(time)))
    past, blind, slow, ahead = (max(1, round(x / step)) for x in (PAST, BLIND, SLOW, AHEAD))
    if time.size < past + blind + ahead + slow:
        return None
    fast = residual - _trailing(residual, slow)
    square = fast**2
    counted, own = np.ones_like(square), np.zeros(time.size, dtype=bool)
    if velocity is not None:
        back, changed, moving = _changing(velocity, slow, ahead, max(1, round(smear / step)))
        counted[back] = 0.0
        own = changed.any(axis=1) & (2 * changed.sum(axis=1) >= moving.sum(axis=1))
    square *= counted
    shown = square.copy()
    if blurred is not None:  # at its most about a moment: it swings through nothing
        shown[np.abs(fast) <= maximum_filter1d(np.abs(blurred), 2 * slow + 1, axis=0)] = 0.0
    loud = _trailing(shown, ahead)[past + blind + ahead :]  # of the stretch that ends at a moment
    quiet = _trailing(square, past)[past : past + loud.shape[0]]  # of the past that ends BLIND before it begins
    ends = time[past + blind + ahead :]
    share = _trailing(counted, past)[past : past + loud.shape[0]]
    each = loud * share / np.maximum(quiet, 1e-300)
    # of a past of which few readings count
    seldom = np.asarray(f.isf(SELDOM, ahead, np.maximum(np.arange(past + 1), 1)))
    together = maximum_filter1d(each / seldom[np.rint(share * past).astype(int)], 2 * slow + 1, axis=0) > 1.0
    felt = (2 * together.sum(axis=1) >= each.shape[1]) & ~own[past + blind + ahead :]
    ratio = np.where(felt, each.max(axis=1), 0.0)
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


def _changing(velocity: np.ndarray, slow: int, ahead: int, smeared: int) -> tuple[np.ndarray, ...]:
    """Which samples of which joint are about a moment at which it turns back; or starts, stops or turns back; and about
    which it moves at all.

    Rest's noise is no motion.

    Args:
        velocity: shape (T, J).
        slow: samples to either side by which it clearly goes one way, or rests, then another.
        ahead: samples of the stretch that is compared.
        smeared: samples over which a filter made the velocity smooth, whose noise shows between such steps only.

    Returns:
        shape (T, J) each.
    """
    count = velocity.shape[0]
    back, changed, moving = (np.zeros(velocity.shape, dtype=bool) for _ in range(3))
    reach = STEADY * slow
    if count <= 2 * reach:
        return back, changed, moving
    noise = CLEAR * np.array([estimate_noise(column[::smeared]) for column in velocity.T])
    ways = np.where(np.abs(velocity) > noise, np.sign(velocity), 0.0).astype(np.int8)
    offsets = range(slow, reach + 1, slow)
    before = np.stack([ways[reach - k : count - reach - k] for k in offsets])
    after = np.stack([ways[reach + k : count - reach + k] for k in offsets])
    steady = (before == before[0]).all(axis=0) & (after == after[0]).all(axis=0)
    back[-reach:] = True  # what follows is not recorded
    back[reach:-reach] = steady & (before[0] * after[0] < 0)
    changed[reach:-reach] = steady & (before[0] != after[0])
    moving[reach:-reach] = (before != 0).any(axis=0) | (after != 0).any(axis=0)
    width = 2 * (slow + ahead + smeared) + 1
    back, changed, moving = (maximum_filter1d(x, width, axis=0) for x in (back, changed, moving))
    return back, changed, moving
