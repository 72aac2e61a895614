"""A slow sensor in a fast log: what a log says twice is read once, and what repeats itself honestly stays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.recordings.held import fresh, held_for
from spacerobot.recordings.study import load_study


def motion(rows: int, seed: int = 1) -> np.ndarray:
    """A track that no two readings of are alike, shape (T,)."""
    random = np.random.default_rng(seed)
    return np.cumsum(random.standard_normal(rows)) * 1e-3


@given(rows=st.integers(2, 12), first=st.integers(0, 11), seed=st.integers(0, 9))
def test_of_each_held_reading_the_first_is_left(rows: int, first: int, seed: int) -> None:
    """Wherever in a hold the log begins."""
    read = motion(60, seed)
    log = np.repeat(read, rows)[first % rows :]
    assert held_for(log) == rows
    kept = log[fresh(log, rows)]
    np.testing.assert_array_equal(kept, read[1:] if first % rows else read)


@pytest.mark.parametrize("digits", [18, 5, 4])
@pytest.mark.parametrize("ratio", [2.4, 8.33])
def test_rates_that_do_not_divide(ratio: float, digits: int) -> None:
    """A camera at 120 Hz in a log at 1 kHz stands for 8 rows, then for 9; its log may write few digits."""
    read = np.round(motion(200), digits)
    log = read[np.floor(np.arange(int(190 * ratio)) / ratio).astype(int)]
    kept = log[fresh(log, held_for(log))]
    assert len(kept) == pytest.approx(190, abs=2)  # of two that are alike the second may be taken for the first's
    changed = [v[np.concatenate(([True], np.diff(v) != 0.0))] for v in (kept, read[:190])]
    np.testing.assert_array_equal(*changed)


def test_a_body_at_rest_under_a_held_camera_keeps_its_readings() -> None:
    """It says the same thing again, at its own rate."""
    read = np.concatenate([motion(60), np.full(30, 0.25)])
    log = np.repeat(read, 2)
    np.testing.assert_array_equal(log[fresh(log, held_for(log))], read)


@pytest.mark.parametrize(
    "log",
    [
        motion(300),
        np.round(np.sin(np.linspace(0.0, 9.0, 2000)), 2),
        np.round(np.linspace(0.0, 1.0, 1001), 2),
        np.where(np.arange(400) % 7 == 0, np.nan, motion(400)),
        np.zeros(50),
    ],
    ids=["a sensor", "an encoder", "an encoder at an even pace", "gaps", "at rest"],
)
def test_what_is_not_held_stays(log: np.ndarray) -> None:
    """An encoder repeats itself where it is slow, for as long as it is."""
    assert held_for(log) == 1
    assert fresh(log, 1).all()


def test_a_trial_says_it_and_commands_stay(tmp_path: Path) -> None:
    """The body's readings count once, with their noise; the force holds until it changes."""
    random = np.random.default_rng(4)
    read = 0.05 * np.arange(120) * 0.2 + 1e-4 * random.standard_normal(120)
    time = 0.1 * np.arange(240)
    force = np.repeat([0.0, 0.3], 120)
    rows = [f"{t:.1f},{x!r},{f!r}" for t, x, f in zip(time, np.repeat(read, 2).tolist(), force.tolist(), strict=True)]
    (tmp_path / "run.csv").write_text("\n".join(["t,x,f", *rows]) + "\n")
    (tmp_path / "study.toml").write_text(
        """format = 1
title = "a body"
[baseline]
base = "free"
[baseline.body]
mass = 12.0
[streams.log]
time = "t"
[streams.log.channels]
x = { is = "body.position.x" }
f = { is = "body.force.x", use = "input" }
[[trials]]
id = "run"
log = "run.csv"
"""
    )
    study = load_study(tmp_path)
    recording = study.recording(study.trials[0])
    place, push = recording["body.position.x"], recording["body.force.x"]
    np.testing.assert_array_equal(place.value, read)
    np.testing.assert_allclose(place.time, time[::2])
    assert place.sigma == pytest.approx(1e-4, rel=0.3)
    assert len(push) == time.size
    assert any("body.position.x" in note and "2 rows" in note for note in recording.notes)
