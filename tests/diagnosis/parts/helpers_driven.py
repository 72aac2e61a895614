"""Joint logs of the proof's driven arm, short, with planted physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from spacerobot.proof.driven.campaign import drawn, write_study
from spacerobot.proof.engine.missing import Missing
from spacerobot.recordings.study import Study, load_study


def driven_study(folder: Path, *hidden: Missing, seed: int = 4, heavier: Mapping[str, float] | None = None) -> Study:
    """Two logs of an arm with this in its joints, and links so many times as heavy."""
    whole = drawn(np.random.default_rng(seed))
    masses = {n: m * (heavier or {}).get(n, 1.0) for n, m in whole.masses.items()}
    campaign = replace(whole, tracks=dict(list(whole.tracks.items())[-2:]), hidden=hidden, masses=masses)
    write_study(folder, campaign, campaign.logs())
    return load_study(folder)
