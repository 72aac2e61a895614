"""The whole diagnosis on small synthetic studies: each verdict, its numbers, and a run that was stopped."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.answer.schema import validate
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting import pool as pools
from spacerobot.diagnosis.fitting.fitted import interval
from spacerobot.diagnosis.fitting.profile import profile_interval
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.terms.candidates import refines
from spacerobot.diagnosis.terms.parameters import TIMES_STATED
from spacerobot.effects.registry import all_effects
from spacerobot.support.jsonio import plain
from tests.diagnosis.rigs import write_study

FRICTION = ("coulomb_friction", "wrist", {"force_N": 0.35})


class Notes(dict[str, Any]):
    """A store that can pull the plug after so many fits."""

    limit = math.inf

    def save(self, name: str, value: Any) -> None:
        self[name] = value
        if len(self) >= self.limit:
            raise KeyboardInterrupt

    def load(self, name: str) -> Any | None:
        return self.get(name)


@pytest.fixture(scope="module")
def notes() -> Notes:
    return Notes()


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory: pytest.TempPathFactory, notes: Notes) -> Diagnosis:
    study = write_study(tmp_path_factory.mktemp("rubbing"), planted=[FRICTION])
    return diagnose(study, jobs=1, store=notes)


def test_friction_is_named_with_its_size(rubbing: Diagnosis) -> None:
    verdict = plain(rubbing.verdict)
    validate(verdict)
    assert verdict["verdict"] == "named"
    (entry,) = verdict["effects"]
    assert (entry["effect"], entry["where"]) == ("coulomb_friction", "wrist")
    assert verdict["not_predicted"] == []  # target, wrist and force are all that was recorded
    found = entry["parameters"]["force_N"]
    low, high = found["ci95"]
    assert low < 0.35 < high
    assert high - low < 0.02
    overall = verdict["held_out"]["overall"]
    assert overall["rms_after"] < 1.05 < 1.2 < overall["rms_before"]


def test_the_profile_agrees_with_the_curvature_where_the_cost_is_a_parabola(rubbing: Diagnosis, tmp_path: Path) -> None:
    study = write_study(tmp_path, planted=[FRICTION])
    workshop = Workshop(study)
    assert rubbing.judgement is not None
    chosen = rubbing.judgement.chosen
    key = "coulomb_friction@wrist.force_N"
    _, (low, high) = interval(chosen, key, 1.0)
    below, above = profile_interval(workshop.fitter(), chosen, key, 1.0)
    assert above - below == pytest.approx(high - low, rel=0.25)
    wider = profile_interval(workshop.fitter(), chosen, key, 4.0)
    assert wider[1] - wider[0] == pytest.approx(2.0 * (above - below), rel=0.25)


def test_nothing_is_done_twice(
    rubbing: Diagnosis, notes: Notes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = write_study(tmp_path, planted=[FRICTION])  # the same bytes elsewhere
    monkeypatch.setattr(pools.Workshop, "run", lambda self, task: pytest.fail(f"done again: {task.label}"))
    monkeypatch.setattr("spacerobot.diagnosis.learning.settle.synthetic", lambda *a: [Check("x", True, "")])
    again = diagnose(study, jobs=1, store=notes)
    assert plain(again.verdict)["effects"] == plain(rubbing.verdict)["effects"]
    assert again.verdict["held_out"] == rubbing.verdict["held_out"]


def test_a_stopped_run_goes_on_to_the_same_verdict(rubbing: Diagnosis, notes: Notes, tmp_path: Path) -> None:
    study = write_study(tmp_path, planted=[FRICTION])
    stopped = Notes()
    stopped.limit = 9
    with pytest.raises(KeyboardInterrupt):
        diagnose(study, jobs=1, store=stopped)
    assert len(stopped) == 9
    assert set(stopped) < set(notes)
    for name, kept in stopped.items():
        assert kept == notes[name]  # so what a resumed run recalls is what a whole run finds


def test_nothing_is_named_where_nothing_is_missing(tmp_path: Path) -> None:
    verdict = plain(diagnose(write_study(tmp_path, seed=5), jobs=1).verdict)
    validate(verdict)
    assert verdict["verdict"] == "nothing_missing"
    assert verdict["effects"] == []
    smallest = {(d["effect"], d["where"]): d["smallest"] for d in verdict["detectable"]}
    assert 1e-3 < smallest["coulomb_friction", "wrist"] < 0.1
    assert 1e-5 < smallest["time_offset", "force_sensor"] < 1e-2


@pytest.mark.slow
def test_a_wrong_stiffness_is_no_missing_physics(tmp_path: Path) -> None:
    verdict = plain(diagnose(write_study(tmp_path, truth={"wrist.stiffness": 1.08 * 1020.0}), jobs=1).verdict)
    assert verdict["verdict"] == "wrong_parameter"
    (name,) = verdict["parameters"]
    assert name == "wrist.stiffness"
    low, high = verdict["parameters"][name]["ci95"]
    assert low < 1.08 * 1020.0 < high


@pytest.mark.slow
def test_masses_that_each_trial_states_are_told_as_a_factor(tmp_path: Path) -> None:
    study = write_study(tmp_path, weighed=0.96)
    found = diagnose(study, jobs=1)
    verdict = plain(found.verdict)
    assert verdict["verdict"] == "wrong_parameter"
    entry = verdict["parameters"]["target.mass"]
    low, high = entry["ci95"]
    assert low < 1.0 / 0.96 < high
    assert (entry["unit"], entry["believed"]) == (TIMES_STATED, 1.0)
    assert verdict["moved"]["target.mass"]["unit"] == TIMES_STATED


@pytest.mark.slow
def test_many_wrong_values_at_once_are_something_that_bends_them_all(tmp_path: Path) -> None:
    """As a force sensor's scale does, where no catalogue has it."""
    truth = {"wrist.stiffness": 1.15 * 1020.0, "wrist.mass": 1.15 * 0.7, "contact.stiffness": 1.3 * 68000.0}
    verdict = plain(diagnose(write_study(tmp_path, truth=truth), jobs=1).verdict)
    assert verdict["verdict"] == "unknown"
    assert verdict["effects"] == []
    assert set(verdict["parameters"]) >= set(truth)
    assert all(p["ci95"] is None for p in verdict["parameters"].values())  # no measurement in a model that is wrong


@pytest.mark.slow
def test_what_has_no_name_is_not_given_another(tmp_path: Path) -> None:
    family = tuple(name for name in all_effects() if name == "coulomb_friction" or refines(name, "coulomb_friction"))
    study = write_study(tmp_path, planted=[("coulomb_friction", "wrist", {"force_N": 0.6})])
    verdict = plain(diagnose(study, jobs=1, without=family).verdict)
    assert verdict["verdict"] == "unknown"
    assert verdict["effects"] == []


@pytest.mark.slow
def test_a_special_case_that_is_left_out_stays_out(tmp_path: Path) -> None:
    """Where its general effect fits, which would be said more simply."""
    study = write_study(tmp_path, planted=[("coulomb_friction", "wrist", {"force_N": 0.6})])
    found = diagnose(study, jobs=1, without=("coulomb_friction",))
    assert any("asymmetric_friction" in e for label in found.found.fits for e, _ in label)
    assert not any(e == "coulomb_friction" for label in found.found.fits for e, _ in label)


@pytest.mark.slow
def test_the_papers_puzzle(tmp_path: Path) -> None:
    """A c_eq that fits one speed; Coulomb friction that explains all of them, and speeds not seen."""
    force, fitted_speed = 0.3, 0.07
    c_eq = 4.0 * force / (math.pi * fitted_speed)
    study = write_study(
        tmp_path,
        planted=[("coulomb_friction", "wrist", {"force_N": force})],
        truth={"wrist.equivalent_damping": 0.0},
        believed={"wrist.equivalent_damping": c_eq},
        masses=(9.0,),
        speeds=(0.05, 0.07, 0.1, 0.14),
    )
    found = diagnose(study, jobs=1)
    verdict = plain(found.verdict)
    assert verdict["verdict"] == "named"
    (entry,) = verdict["effects"]
    assert entry["effect"] == "coulomb_friction"
    assert entry["parameters"]["force_N"]["value"] == pytest.approx(force, rel=0.1)
    assert found.judgement is not None
    assert found.judgement.chosen.values()["wrist.equivalent_damping"] < 0.3 * c_eq
    overall = verdict["held_out"]["overall"]  # leave one speed out
    assert overall["rms_after"] < 1.05 < overall["rms_before"]
