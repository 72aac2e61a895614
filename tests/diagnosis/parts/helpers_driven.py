"""Joint logs of the proof's driven arm, short, with planted physics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from spacerobot.proof.driven.campaign import drawn, write_study
from spacerobot.proof.engine.missing import Missing
from spacerobot.recordings.study import Study, load_study


def driven_study(folder: Path, *hidden: Missing, seed: int = 4) -> Study:
    """Two logs of an arm with this in its joints."""
    whole = drawn(np.random.default_rng(seed))
    campaign = replace(whole, tracks=dict(list(whole.tracks.items())[-2:]), hidden=hidden)
    write_study(folder, campaign, campaign.logs())
    return load_study(folder)
