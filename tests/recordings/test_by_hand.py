"""A target that somebody pushes and catches within the recording: it is free in a window, which the draft proposes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, rig

from spacerobot.recordings.draft import draft

PUSH, DRIFT, CAUGHT = 0.4, 1.0, 0.2
"""How long a hand pushes, how long before the hit it lets go, and how long it takes to stop the target [s]."""


def handled(speed: float, *, pushed: bool, caught: bool) -> tuple[np.ndarray, ...]:
    """Times s, target m, slider m, force N: `rig`'s hit at 1 s after the push ends, with what came before and after."""
    t, x, s, f = rig(speed)
    rng = np.random.default_rng(1)
    step, parts = t[1], [(t, x, s, f)]
    if pushed:
        before = np.arange(-2.0, -step / 2, step)
        rate = speed * 0.5 * (1.0 - np.cos(np.pi * np.clip((before + PUSH) / PUSH, 0.0, 1.0)))
        place = -speed - np.cumsum(rate[::-1])[::-1] * step
        parts.insert(0, (before, place, np.zeros(before.size), np.zeros(before.size)))
    if caught:
        after = t[-1] + step * np.arange(1, 200)
        rate = -1.5 * speed * 0.5 * (1.0 + np.cos(np.pi * np.clip((after - t[-1] - 0.5) / CAUGHT, 0.0, 1.0)))
        place = -1.5 * speed * (t[-1] - 1.0 - np.pi / 8) + np.cumsum(rate) * step
        parts.append((after, place, np.zeros(after.size), np.zeros(after.size)))
    time, *values = (np.concatenate(own) for own in zip(*parts, strict=True))
    new = np.ones(time.size, dtype=bool)
    new[parts[0][0].size if pushed else 0 :][: t.size] = False
    noise = [np.where(new, rng.normal(0.0, sigma, time.size), 0.0) for sigma in (1e-4, 1e-4, 0.2)]
    return time + 3.0, *(v + e for v, e in zip(values, noise, strict=True))


@pytest.mark.parametrize(("pushed", "caught"), [(True, False), (False, True), (True, True), (False, False)])
def test_a_window_leaves_the_hand_out(tmp_path: Path, pushed: bool, caught: bool) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        rows = np.transpose(handled(speed, pushed=pushed, caught=caught))
        np.savetxt(
            tmp_path / f"run{n}.csv", rows, delimiter=",", header="t,target,slider,force", comments="", fmt="%.7f"
        )
    made = draft(tmp_path)
    windows = [t.window for t in made.trials]
    if not (pushed or caught):
        assert windows == [None] * len(SPEEDS)
        assert not any(t.question for t in made.trials)
        return
    assert sum("hand" in (t.question or "") for t in made.trials) == 1
    for window in windows:
        assert window is not None
        first, last = window
        assert 2.9 < first < 3.4 if pushed else first <= 3.0
        assert 4.6 < last < 5.55 if caught else last >= 4.98
