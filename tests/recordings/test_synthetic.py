"""Synthetic studies hold what was planted, and nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.residuals import residuals
from spacerobot.recordings.synthetic import synthetic_study
from spacerobot.support.errors import InputError, NotFoundError


def worst(folder: Path, planted: list) -> float:
    study = synthetic_study(folder, [(9.0, 0.1)], planted)
    found = forward_model(study).simulate(study.trials[0])
    return residuals([next(c for c in found.channels if c.channel == "target.x")]).rms_sigmas


def test_with_nothing_planted_the_baseline_fits_to_the_noise(tmp_path: Path) -> None:
    # the baseline starts from a fitted line, whose own error grows along the trial
    assert worst(tmp_path / "bare", []) < 4.0


def test_what_is_planted_shows(tmp_path: Path) -> None:
    drag = ("quadratic_drag", "target", {"coefficient_Ns2_m2": 8.0})
    assert worst(tmp_path / "drag", [drag]) > 8.0


def test_the_same_seed_makes_the_same_files(tmp_path: Path) -> None:
    texts = []
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        synthetic_study(tmp_path / name, [(9.0, 0.1)], seed=seed)
        texts.append((tmp_path / name / "01_mocap.csv").read_text())
    assert texts[0] == texts[1] != texts[2]
    assert np.loadtxt(tmp_path / "a" / "01_force.csv", delimiter=",", skiprows=1).shape[1] == 2


def test_nothing_is_overwritten_and_nonsense_is_refused(tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("x")
    with pytest.raises(InputError, match="not empty"):
        synthetic_study(tmp_path / "full", [(9.0, 0.1)])
    with pytest.raises(InputError, match="positive"):
        synthetic_study(tmp_path / "new", [(9.0, -0.1)])
    with pytest.raises(NotFoundError):
        synthetic_study(tmp_path / "new", [(9.0, 0.1)], [("no_such", "wrist", {})])
    assert not (tmp_path / "new").exists()
