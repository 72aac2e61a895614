"""A part's detection limit is where its own decision turns: named at it in 95 of 100 campaigns, and hardly before."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers_sliding import sliding

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.study import Study

CATALOGUE = ("viscous_drag", "quadratic_drag", "coulomb_friction", "scale", "bias", "time_offset")


def said(study: Study) -> dict[str, Any]:
    return dict(diagnose(study, jobs=1, without=[n for n in all_effects() if n not in CATALOGUE]).verdict)


def limits(verdict: Mapping[str, Any]) -> dict[str, float]:
    return {d["effect"]: d["smallest"] for d in verdict["detectable"] if d["where"] == "target"}


def named(folder: Path, effect: str, size: float, campaigns: int, **options: Any) -> int:
    """In how many campaigns the effect, and nothing else, is named."""
    verdicts = [said(sliding(folder / str(k), effect, size, seed=k, **options)) for k in range(campaigns)]
    return sum(v["verdict"] == "named" and [e["effect"] for e in v["effects"]] == [effect] for v in verdicts)


@pytest.mark.slow
def test_a_limit_is_where_the_decision_turns(tmp_path: Path) -> None:
    limit = limits(said(sliding(tmp_path / "nothing", seed=1001)))["coulomb_friction"]
    assert named(tmp_path, "coulomb_friction", 2.0 * limit, 4) == 4
    assert named(tmp_path, "coulomb_friction", 0.25 * limit, 3) == 0  # where a likelihood ratio alone would see it


@pytest.mark.slow
def test_limits_follow_the_noise(tmp_path: Path) -> None:
    """An effect size is asked for: twice the noise hides twice as much, whether it is stated or not."""
    found = [
        limits(said(sliding(tmp_path / f"{noise}{stated}", seed=3, noise=noise, stated=stated)))
        for noise in (0.002, 0.004)
        for stated in (True, False)
    ]
    for label in ("coulomb_friction", "viscous_drag"):
        quiet, own, loud, _ = (np.float64(f[label]) for f in found)
        assert loud == pytest.approx(2.0 * quiet, rel=0.25)
        assert own == pytest.approx(quiet, rel=0.25)


@pytest.mark.slow
@pytest.mark.parametrize("stated", [True, False])
def test_limits_are_kept(tmp_path: Path, stated: bool) -> None:
    """Of 40 campaigns of each of two effects."""
    found = limits(said(sliding(tmp_path / "nothing", seed=1001, stated=stated)))
    share = {}
    for factor in (0.5, 1.0, 2.0):
        counts = [
            named(tmp_path / f"{label}{factor}", label, factor * found[label], 40, stated=stated)
            for label in ("coulomb_friction", "viscous_drag")
        ]
        share[factor] = sum(counts) / 80.0
    assert share[0.5] < 0.85 <= share[1.0]
    assert share[2.0] >= 0.95  # a second effect by chance, in 3 of 100 at any size: 116 of 120 with three effects
