"""Trials whose label names another target than the one that was there, found by its momentum before anything is fitted.

The impulse of the contact force is the target's mass times the change of its velocity, whatever wrist and contact do.
What every trial has alike (a force sensor's scale, drag) cancels: one is odd beside the others, and moves as another of
the study's targets does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData

MASS = "target.mass"
FORCE, TRACK = "contact.force", "target.x"

PRESSED = 6.0
"""Standard deviations of the force sensor from which it is in contact."""

BESIDE = 0.02
"""Seconds that a sensor's filter or delay may smear a contact by."""

LOOK = 0.3
"""Seconds of free motion, at most, from which a velocity is read."""

FEWEST = 8
"""Readings that a velocity is read from, at least."""

ODD = 6.0
"""Standard deviations, by the spread of all trials, from which a trial is odd: one of a thousand campaigns has one."""

CLOSE = 0.03
"""Relative difference within which a mass is another target's."""

LEFT = 4
"""Trials that must be left."""


@dataclass(frozen=True)
class Mislabelled:
    """A trial whose stated mass is not what moved.

    Attributes:
        trial: its id.
        stated: mass on its label [kg].
        shown: mass that its momentum shows, the other trials taken as right [kg].
        like: the other target's mass that this is [kg].
    """

    trial: str
    stated: float
    shown: float
    like: float


def mislabelled(trials: Sequence[TrialData]) -> list[Mislabelled]:
    """Trials that were labelled as another target's.

    Args:
        trials: of a wrist rig, without what is no reading.
    """
    stated = {t.id: t.overrides[MASS] for t in trials if MASS in t.overrides}
    shown = {t.id: mass for t in trials if t.id in stated and (mass := _shown(t)) is not None}
    if len(shown) < LEFT + 1 or len(set(stated.values())) < 2:
        return []
    ratio = {t: np.log(mass / stated[t]) for t, mass in shown.items()}
    usual = float(np.median(list(ratio.values())))
    spread = 1.4826 * float(np.median(np.abs(np.array(list(ratio.values())) - usual)))
    found = []
    for trial, own in ratio.items():
        if abs(own - usual) > max(ODD * spread, 2.0 * CLOSE):
            mass = float(stated[trial] * np.exp(own - usual))
            near = min(set(stated.values()) - {stated[trial]}, key=lambda m: abs(np.log(mass / m)))
            if abs(np.log(mass / near)) < max(CLOSE, 2.0 * spread):
                found.append(Mislabelled(trial, stated[trial], mass, near))
    return found if len(shown) - len(found) >= max(LEFT, 2 * len(found)) else []


def rightly_labelled(trials: Sequence[TrialData]) -> tuple[TrialData, ...]:
    """The trials without those that were labelled as another target's."""
    out = {m.trial for m in mislabelled(trials)}
    return tuple(t for t in trials if t.id not in out)


def _shown(trial: TrialData) -> float | None:
    """The target's mass by its first contact's impulse [kg]; None where force or free motion was not recorded."""
    if not {FORCE, TRACK} <= set(trial.channels):
        return None
    time, force, weight = trial.channel(FORCE)
    if time.size < 2 * FEWEST:
        return None
    sigma = 1.0 / float(np.median(weight))
    pressed = np.flatnonzero(force > PRESSED * sigma)
    if pressed.size < 3 or time[pressed[0]] - time[0] < BESIDE:
        return None
    apart = np.flatnonzero(np.diff(time[pressed]) > 2.0 * BESIDE)
    last = pressed[apart[0]] if apart.size else pressed[-1]
    begin, end = float(time[pressed[0]]), float(time[last])
    again = float(time[pressed[apart[0] + 1]]) if apart.size else float(time[-1])
    zero = float(np.mean(force[time < begin - BESIDE])) if (time < begin - BESIDE).sum() >= FEWEST else 0.0
    rows = (time > begin - BESIDE) & (time < end + BESIDE)
    steps = np.diff(time[rows])
    if steps.size < 2 or steps.max() > 2.5 * np.median(steps):
        return None  # clipped, lost or too slow for a touch: not all of the impulse is there
    impulse = float(np.trapezoid(force[rows] - zero, time[rows]))
    at, place, _ = trial.channel(TRACK)
    before = (at < begin - BESIDE) & (at > begin - LOOK)
    after = (at > end + BESIDE) & (at < min(end + LOOK, again - BESIDE))
    if before.sum() < FEWEST or after.sum() < FEWEST:
        return None
    speeds = [float(np.polyfit(at[rows] - at[rows].mean(), place[rows], 1)[0]) for rows in (before, after)]
    change = speeds[0] - speeds[1]
    return impulse / change if impulse > 0.0 and change > 0.0 else None
