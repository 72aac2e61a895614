"""One long record cut into trials by `each` and `step`: every kind of machine takes the windows as trials."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.overlay import overlay
from spacerobot.recordings.study import load_study
from tests.overlay.studies import axis_study
from tests.overlay.test_free_body import study as body_study

WINDOWS = 'each = [1, 3]\nid = "{n}"\nwindow = [0.0, 1.9995]\nstep = 2.0\nlog = "log.csv"\n'


@pytest.mark.parametrize(("make", "within"), [(axis_study, 2e-5), (body_study, 3e-3)])
def test_each_window_is_a_trial_of_its_own(tmp_path: Path, make, within: float) -> None:  # type: ignore[no-untyped-def]
    folder = make(tmp_path / "mine")
    file = folder / "study.toml"
    file.write_text(file.read_text().partition("[[trials]]")[0] + "[[trials]]\n" + WINDOWS)
    made = overlay(load_study(folder))
    assert [t.id for t in made.trials] == ["1", "2", "3"]
    for n, trial in enumerate(made.trials):
        for channel in trial.channels:
            assert 2.0 * n <= channel.time[0] <= channel.time[-1] <= 2.0 * n + 2.0
            assert float(np.abs(channel.residual).max()) < within, channel.channel
