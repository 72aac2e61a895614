"""The sixteen campaigns load, each as its study says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.recordings.study import load_study

pytestmark = pytest.mark.campaigns
TOP = recordings_folder()
CAMPAIGNS = sorted(p.parent for p in TOP.glob("*/study.toml")) if TOP else []


@pytest.mark.parametrize("folder", CAMPAIGNS, ids=[p.name for p in CAMPAIGNS])
def test_campaign_loads(folder: Path) -> None:
    study = load_study(folder)
    assert study.baseline.robot == "pa10_wrist"
    assert len(study.conditions()) in (3, 4)
    for recording in study.recordings().values():
        assert {"target.x", "wrist.x", "contact.force"} <= set(recording)
        assert recording.notes == ()
        assert recording["target.x"].rate == pytest.approx(120, rel=1e-3)
        assert recording["contact.force"].rate == pytest.approx(1000, rel=1e-3)
        for series in recording.values():
            assert series.valid.all()
            assert (np.diff(series.time) > 0).all()
            assert series.sigma_stated


def test_all_are_here() -> None:
    if not CAMPAIGNS:
        pytest.skip("the campaigns are not here: set SPACEROBOT_DATA")
    assert len(CAMPAIGNS) == 16
