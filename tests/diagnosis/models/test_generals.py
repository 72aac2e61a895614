"""Friction of two levels beside friction of one: what stated noise excludes, and what it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")

from spacerobot.diagnosis.models.bench import Bench
from spacerobot.diagnosis.models.choose import models_for
from spacerobot.diagnosis.models.generals import not_excluded
from spacerobot.proof.driven.campaign import drawn, write_study
from spacerobot.proof.engine.missing import Missing
from spacerobot.recordings.study import load_study

JOINT = "S1"


def beside_coulomb(folder: Path, plus: float, minus: float) -> list[tuple[tuple[str, str], ...]]:
    """Labels of what is not excluded beside Coulomb friction, of a joint whose friction has these levels [N m]."""
    whole = drawn(np.random.default_rng(4))
    item = Missing("asymmetric_friction", f"joint.{JOINT}", {"force_plus_Nm": plus, "force_minus_Nm": minus})
    campaign = replace(whole, tracks=dict(list(whole.tracks.items())[-2:]), hidden=(item,))
    write_study(folder, campaign, campaign.logs())
    (model,) = [m for m in models_for(load_study(folder)) if m.name == JOINT]
    bench, known = Bench(model), {s.label: s for s in model.sites()}
    start = bench.baseline()
    bench.sharpen(start)
    fit = bench.fitted_as(bench.again(start), [known["coulomb_friction", f"joint.{JOINT}"]], {})
    assert fit is not None
    bench.weigh(fit)
    return [f.hypothesis.label for f in not_excluded(bench, bench.again(fit), known)]


def test_one_level_excludes_two_and_two_do_not_exclude_one(tmp_path: Path) -> None:
    two = (("asymmetric_friction", f"joint.{JOINT}"),)
    assert two not in beside_coulomb(tmp_path / "one", 0.3, 0.3)
    assert two in beside_coulomb(tmp_path / "two", 0.33, 0.27)


def test_two_levels_are_left_open_where_hardly_any_friction_is(tmp_path: Path) -> None:
    (general,) = beside_coulomb(tmp_path, 0.02, 0.02)
    assert general == (("asymmetric_friction", f"joint.{JOINT}"),)
