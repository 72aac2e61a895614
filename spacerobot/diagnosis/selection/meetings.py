"""When a body that flies met something, a floor, a wall, a hand: free flight is smooth, so its track shows it."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.terms.data import TrialData

OFTEN = 0.5
"""Share of the trials in which a body meets something where that is no accident."""

SIDE = 6
"""Readings to either side of a moment that tell whether the rate jumps there."""

JUMP = 8.0
"""Standard errors by which it does: of a thousand moments that are tried one lies beyond three of them by chance."""

BENDS = 0.5
"""And by this share of what the flight's own bend changes the rate over one side: drag changes the bend, no more."""


def meetings(model: Machine) -> dict[str, list[Moment]]:
    """By recorded trial, when a body that flies met something.

    What strikes in a few trials alone is left to be found as a knock.
    """
    if not (isinstance(model, Simulated) and model.flies):
        return {}
    found = {name: some for name, trial in model.recorded.items() if (some := _jumps(trial))}
    return found if len(found) > OFTEN * len(model.recorded) and len(found) > 1 else {}


def _jumps(trial: TrialData) -> list[Moment]:
    """Where the rate of the whole body jumps, by all its tracks of positions that are read at the same times."""
    shown = [
        (b.time[good], b.value[k][good])
        for b in trial.blocks
        for k, c in enumerate(b.channels)
        if ".position." in c and (good := b.weight[k] > 0.0).sum() > 4 * SIDE
    ]
    if not shown:
        return []
    time = shown[0][0]
    scores = [_score(x) for t, x in shown if np.array_equal(t, time)]
    score = np.max(scores, axis=0)
    step = float(np.median(np.diff(time)))
    out: list[Moment] = []
    while score.max(initial=0.0) > 1.0:
        k = int(np.argmax(score))
        at = float(time[k + SIDE])
        out.append(Moment(at, at - 1.5 * step, at + 1.5 * step))
        score[max(k - SIDE, 0) : k + SIDE + 1] = 0.0
    return sorted(out, key=lambda m: m.time)


def _score(place: np.ndarray) -> np.ndarray:
    """How far beyond both limits the rate jumps at each reading but the first and last SIDE; above 1 it does."""
    t = np.arange(-SIDE, SIDE + 1.0)
    columns = np.stack([np.ones_like(t), t, t**2, np.maximum(t, 0.0)], axis=1)
    solve = np.linalg.pinv(columns)
    windows = np.lib.stride_tricks.sliding_window_view(place, t.size)
    _, _, bend, jump = solve @ windows.T
    noise = float(np.median(np.abs(np.diff(place, 3)))) / 0.6745 / np.sqrt(20.0)  # of a third difference: 1 9 9 1
    usual = float(np.median(np.abs(bend)))
    least = max(JUMP * noise * float(np.sqrt((solve[3] ** 2).sum())), BENDS * 2.0 * usual * SIDE, 1e-300)
    return np.asarray(np.abs(jump) / least)
