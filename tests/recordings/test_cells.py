"""Drafts of files that hold several trials: cell arrays of matrices."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.io import savemat

from spacerobot.recordings.draft import draft
from spacerobot.recordings.recording import load_trial
from spacerobot.recordings.study import load_study

COUNT = 600


def _cells(*trials: np.ndarray) -> np.ndarray:
    made = np.empty((len(trials), 1), dtype=object)
    made[:, 0] = trials
    return made


def _swing(n: int) -> np.ndarray:
    time = np.arange(COUNT) / 200.0
    return np.array([np.cos(3.0 * time + n), -3.0 * np.sin(3.0 * time + n)])


def _clock() -> np.ndarray:
    return (np.arange(COUNT) / 200.0)[:, None]


def test_each_matrix_of_a_cell_array_is_a_trial_at_the_rate_of_its_clock(tmp_path: Path) -> None:
    train = [_swing(n) for n in range(3)]
    check = [_swing(n) for n in range(3, 5)]
    clocks = {"Time_a": _cells(*[_clock()] * 3), "Time_b": _cells(*[_clock()] * 2)}
    savemat(tmp_path / "swing.mat", {**clocks, "Y_a": _cells(*train), "Y_b": _cells(*check), "dt": 0.005})
    made = draft(tmp_path, None)
    assert len(made.trials) == 5
    asked = made.text().count("by what it does, not by its name: is it?")
    assert asked == 2, "a letter of its own says no more than that this is some output"
    (tmp_path / "study.toml").write_text(made.text(), encoding="utf-8")
    study = load_study(tmp_path)
    for trial, wanted in zip(study.trials, [*train, *check], strict=True):
        found = load_trial(study.streams, study.root, trial)
        for i, series in enumerate(found.values()):
            np.testing.assert_array_equal(series.value, wanted[i])
            np.testing.assert_allclose(np.diff(series.time), 0.005)


def test_as_many_forces_as_positions_are_of_the_same_trials(tmp_path: Path) -> None:
    force = [np.vstack([s, s.sum(axis=0)]) for s in map(_swing, range(2))]
    savemat(tmp_path / "a.mat", {"pos": _cells(*map(_swing, range(2))), "t": _cells(_clock(), _clock())})
    savemat(tmp_path / "b.mat", {"force": _cells(*force), "t": _cells(_clock(), _clock())})
    made = draft(tmp_path, None)
    assert [len(t.files) for t in made.trials] == [2, 2]
    assert {f.variable for t in made.trials for f in t.files.values()} == {"pos[0]", "pos[1]", "force[0]", "force[1]"}


def test_a_single_matrix_is_one_trial_with_its_own_names(tmp_path: Path) -> None:
    savemat(tmp_path / "one.mat", {"t": _clock(), "x": _swing(0)[0]})
    made = draft(tmp_path, None)
    assert [f.variable for t in made.trials for f in t.files.values()] == [None]
