"""Friction of two levels beside friction of one: what stated noise excludes, and what it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")

from helpers_driven import driven_study

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.profile import LEVEL_95
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.nested_laws import least_alike, left_open, not_excluded
from spacerobot.proof.engine.missing import Missing

JOINT = "S1"


def beside_coulomb(folder: Path, plus: float, minus: float) -> list[Fit]:
    """What is not excluded beside Coulomb friction, of a joint whose friction has these levels [N m]."""
    item = Missing("asymmetric_friction", f"joint.{JOINT}", {"force_plus_Nm": plus, "force_minus_Nm": minus})
    (model,) = [m for m in models_for(driven_study(folder, item)) if m.name == JOINT]
    bench, known = Bench(model), {s.label: s for s in model.sites()}
    start = bench.baseline()
    bench.sharpen(start)
    fit = bench.fitted_as(bench.again(start), [known["coulomb_friction", f"joint.{JOINT}"]], {})
    assert fit is not None
    bench.weigh(fit)
    return not_excluded(bench, bench.again(fit), known)


def levels(fit: Fit) -> tuple[float, float]:
    """Friction forwards and backwards [N m]."""
    values = fit.values()
    where = f"asymmetric_friction@joint.{JOINT}"
    return values[f"{where}.force_plus_N"], values[f"{where}.force_minus_N"]


TWO = (("asymmetric_friction", f"joint.{JOINT}"),)


@pytest.mark.slow
def test_one_level_excludes_two_and_two_do_not_exclude_one(tmp_path: Path) -> None:
    assert TWO not in [f.hypothesis.label for f in beside_coulomb(tmp_path / "one", 0.3, 0.3)]
    assert TWO in [f.hypothesis.label for f in beside_coulomb(tmp_path / "two", 0.33, 0.27)]


def test_two_levels_are_left_open_where_there_is_little_friction(tmp_path: Path) -> None:
    (open_,) = beside_coulomb(tmp_path, 0.035, 0.035)
    assert open_.hypothesis.label == TWO
    assert left_open(open_, open_.hypothesis.sites[0])
    one, other = levels(open_)
    far = least_alike(open_)
    more, less = levels(far)
    assert (more - less) * (one - other) >= 0.0  # the same is the greater
    assert abs(more - less) > 2.0 * abs(one - other)
    assert more + less == pytest.approx(one + other, rel=0.2)
    rise = (far.z - open_.z) @ np.linalg.solve(open_.covariance, far.z - open_.z)
    assert rise == pytest.approx(LEVEL_95, rel=1e-3)  # the edge of a 95 % interval, everything else following


@pytest.mark.slow
def test_a_fit_without_two_levels_has_no_end_of_them(tmp_path: Path) -> None:
    (open_,) = beside_coulomb(tmp_path, 0.035, 0.035)
    assert not left_open(replace(open_, covariance=None), open_.hypothesis.sites[0])
    plain = replace(open_, covariance=None)
    assert least_alike(plain) is plain


@pytest.mark.slow
def test_levels_that_differ_by_a_hundredth_are_one_level(tmp_path: Path) -> None:
    """However surely they differ: models of arms err by more. (Ten in a hundred are two levels, as above.)"""
    assert TWO not in [f.hypothesis.label for f in beside_coulomb(tmp_path, 2.02, 1.98)]
