"""Which streams share a clock, by when they ran and by when each saw the target and the wrist meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.recordings.drafting.approach import CLEAR, Rest, Track, crest
from spacerobot.recordings.drafting.groups import Trial
from spacerobot.recordings.drafting.tracks import span


def meet(trials: Sequence[Trial], stream: str, other: str) -> bool:
    """Whether the two ran at the same time by their own clocks, in most trials that have both."""
    both = [t for t in trials if stream in t.files and other in t.files]
    if stream == other or not both:
        return True
    overlaps = 0
    for trial in both:
        a, b = span(trial.files[stream]), span(trial.files[other])
        if a is None or b is None:
            return True
        overlaps += min(a[1], b[1]) - max(a[0], b[0]) > 0.25 * min(a[1] - a[0], b[1] - b[0])
    return overlaps >= len(both) / 2


def runs_apart(trials: Sequence[Trial], stream: str, other: str) -> str:
    """Why `stream` has a clock of its own beside `other`'s, by their times alone; "" where they run together."""
    if not meet(trials, stream, other):
        for trial in trials:
            mine, theirs = (span(trial.files[s]) if s in trial.files else None for s in (stream, other))
            if mine is not None and theirs is not None:
                return f"it begins at {mine[0]:.10g} s where {other} begins at {theirs[0]:.10g} s"
    return ""


def turned(target: Track, wrist: Track, still: Rest) -> float | None:
    """How much later the target turns back than the wrist it pushes, s; None where either is not seen to.

    The two turn at one time, whatever their clocks say.

    Args:
        target: readings that grow along the travel.
        wrist: readings of the same length unit and direction.
        still: the wrist's rest.
    """
    pushed = wrist.value - still.zero
    height = float(pushed.max(initial=0.0))
    if not height > 2 * CLEAR * still.sigma:
        return None
    mine, theirs = crest(Track(wrist.time, pushed), height), crest(target, height)
    return theirs - mine if mine is not None and theirs is not None else None


def out_of_step(
    trials: Sequence[Trial], pulses: Mapping[str, Rest], wrists: Mapping[str, Rest], speeds: Mapping[str, float]
) -> str:
    """Why the force's clock is not the wrist's: its pulse comes at another time than the wrist's first movement.

    Args:
        trials: the trials.
        pulses: trial -> the force's rest.
        wrists: trial -> the wrist's rest.
        speeds: trial -> how fast the target comes, in the wrist's unit per second; 0 where unknown.
    """
    shared = [t.id for t in trials if t.id in pulses and t.id in wrists]
    apart: list[float] = []
    for name in shared:
        force, wrist = pulses[name].leaves, wrists[name].leaves
        # The wrist shows itself only once it is CLEAR sigmas off its rest, and each by its next sample.
        late = CLEAR * wrists[name].sigma / speeds[name] if speeds.get(name, 0.0) > 0 else 0.1
        late += wrists[name].step + pulses[name].step
        if force is not None and wrist is not None and not -3 * late < force - wrist < 3 * late:
            apart.append(force)
    if len(apart) <= len(shared) / 2 or not shared:
        return ""
    seen = [r.leaves for r in wrists.values() if r.leaves is not None]
    pulse = f"the pulse is at {np.min(apart):.3g} to {np.max(apart):.3g} s here"
    return f"{pulse}, the wrist moves at {np.min(seen):.3g} to {np.max(seen):.3g} s by the cameras' clock"
