"""What is said of several joints at once: whole sets of what is missing, and nothing that chance brought."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")

from helpers_driven import driven_study

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.conclusion import Conclusion
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.proof.engine.missing import Missing

OPEN = Missing("coulomb_friction", "joint.S1", {"force_Nm": 0.035})
SURE = Missing("viscous_friction", "joint.S2", {"coefficient_Nms_rad": 0.6})
SURE_LABEL = (SURE.effect, SURE.where)


def said_of(folder: Path, *hidden: Missing) -> Mapping[str, Any]:
    return diagnose(driven_study(folder, *hidden), jobs=1).verdict


def listed(verdict: Mapping[str, Any]) -> list[Label]:
    return [tuple((e["effect"], e["where"]) for e in a["effects"]) for a in verdict["alternatives"]]


@pytest.mark.slow
def test_friction_left_open_is_told_with_the_trial_that_would_tell(tmp_path: Path) -> None:
    verdict = said_of(tmp_path, OPEN)
    assert verdict["verdict"] == "ambiguous"
    assert listed(verdict)[0] == (("coulomb_friction", "joint.S1"),)
    assert (("asymmetric_friction", "joint.S1"),) in listed(verdict)
    assert all(abs(a["score"]) < 1.0 for a in verdict["alternatives"])  # as good, in the same weights
    assert verdict["next_experiment"]["part"] == "S1"


@pytest.mark.slow
def test_what_is_sure_of_one_joint_stands_in_every_set_that_another_leaves_open(tmp_path: Path) -> None:
    verdict = said_of(tmp_path, OPEN, SURE)
    assert verdict["verdict"] == "ambiguous"
    found = listed(verdict)
    assert found[0] == (("coulomb_friction", "joint.S1"), SURE_LABEL)
    assert (("asymmetric_friction", "joint.S1"), SURE_LABEL) in found
    assert all(SURE_LABEL in one for one in found)
    parameters = verdict["alternatives"][0]["parameters"]
    assert parameters["viscous_friction@joint.S2.coefficient_Ns_m"] == pytest.approx(0.6, rel=0.1)
    assert parameters["coulomb_friction@joint.S1.force_N"] == pytest.approx(0.035, rel=0.3)


@pytest.mark.parametrize("coulomb", [0.0, pytest.param(0.3, marks=pytest.mark.slow)])
def test_an_effect_that_chance_would_bring_is_dropped_and_no_other(tmp_path: Path, coulomb: float) -> None:
    both = ("coulomb_friction", "joint.S1"), ("viscous_friction", "joint.S1")
    viscous = Missing("viscous_friction", "joint.S1", {"coefficient_Nms_rad": 0.6})
    study = driven_study(tmp_path, viscous, *([Missing(*both[0], {"force_Nm": coulomb})] if coulomb else []))
    (model,) = [m for m in models_for(study) if m.name == "S1"]
    bench, sites = Bench(model), {s.label: s for s in model.sites()}
    search = Conclusion(bench, sites, {})
    start = bench.baseline()
    bench.sharpen(start)
    fit = bench.fitted_as(bench.again(start), [sites[one] for one in both], {})
    assert fit is not None
    bench.weigh(fit)
    chosen = bench.tested(bench.again(fit))
    kept = search.without_chance(chosen, [both, both[:1], both[1:]])
    assert kept.label == (both if coulomb else both[1:])
    assert search.without_chance(chosen, [both]) is chosen  # what was never tried is not come back to
