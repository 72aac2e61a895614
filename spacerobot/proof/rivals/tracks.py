"""A study's trials as the rivals take them: even tracks of slider and target, and the contact force beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.study import Study

RATE = 120.0


@dataclass(frozen=True, eq=False)
class Track:
    """One trial on even times, gaps bridged. T times.

    Attributes:
        id, condition, mass: of the trial; the target's believed mass [kg].
        time: shape (T,) from 0 [s].
        target, wrist: shape (T,) [m].
        force: shape (T,) [N].
        start: position and speed of the target at time 0, from a line through its free approach.
    """

    id: str
    condition: str
    mass: float
    time: np.ndarray
    target: np.ndarray
    wrist: np.ndarray
    force: np.ndarray
    start: tuple[float, float]


def tracks_of(study: Study) -> tuple[Track, ...]:
    """Every trial of an air-bed study."""
    found = []
    for trial in study.trials:
        recording = study.recording(trial)
        t, x = recording["target.x"].good()
        time = np.arange(t[0], t[-1], 1.0 / RATE)
        early = t < t[np.flatnonzero(x > -1e-3)[0]] if (x > -1e-3).any() else np.ones(t.size, dtype=bool)
        speed, place = np.polyfit(t[early] - t[0], x[early], 1)
        force = recording["contact.force"].good()
        # the mean over a frame, not a sample of it: the force is recorded eight times as fast
        kernel = np.ones(8) / 8.0
        smooth = np.convolve(force[1], kernel, "same")
        found.append(
            Track(
                trial.id,
                study.condition(trial),
                float(study.values(trial)["target.mass"]),
                time - time[0],
                np.interp(time, t, x),
                np.interp(time, *recording["wrist.x"].good()),
                np.interp(time, force[0], smooth),
                (float(place), float(speed)),
            )
        )
    return tuple(found)


def folds(tracks: tuple[Track, ...]) -> list[tuple[tuple[Track, ...], tuple[Track, ...]]]:
    """(seen, unseen) with one condition left out in turn."""
    names = dict.fromkeys(t.condition for t in tracks)
    return [
        (tuple(t for t in tracks if t.condition != name), tuple(t for t in tracks if t.condition == name))
        for name in names
    ]
