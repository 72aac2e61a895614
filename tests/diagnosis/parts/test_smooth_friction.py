"""Friction that is smooth about rest, as in most simulators: the name of dry friction, with its speed."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_fold import settled
from spacerobot.effects.registry import effect
from tests.diagnosis.parts.helpers_axis import followed

LEVEL, CREEP = 3.0, 0.05
OFFERED = ("viscous_friction", "coulomb_friction", "preload", "quadratic_damping")


@pytest.mark.parametrize(("creep", "form"), [(CREEP, "coulomb_friction~creeping"), (0.0, "coulomb_friction")])
def test_it_is_told_from_friction_that_sticks(creep: float, form: str, tmp_path: Path) -> None:
    (model,) = models_for(followed(tmp_path, dry=LEVEL, creep=creep))
    growth, unseen = settled(grow(model, effects=[effect(n) for n in OFFERED]))
    assert growth.after.label == ((form, "joint.j"),)
    assert all(fold.selected == growth.after.label for fold in unseen.folds)
    values = growth.after.fit.values()  # a command that is held is late by half a sample, of which nothing is on offer
    assert values[f"{form}@joint.j.force_N"] == pytest.approx(LEVEL, rel=0.1)


@pytest.mark.slow
def test_it_keeps_its_name(tmp_path: Path) -> None:
    verdict = diagnose(followed(tmp_path, dry=LEVEL, creep=CREEP), jobs=1).verdict
    assert verdict["verdict"] == "named"
    (one,) = verdict["effects"]
    assert (one["effect"], one["kind"]) == ("coulomb_friction", "creeping")
    assert one["parameters"]["creep_m_s"]["value"] == pytest.approx(CREEP, rel=0.15)
