"""Laws of no catalogue at joints and bodies: the true one comes back, nothing comes where nothing is missing."""

from __future__ import annotations

import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers_hidden import body, joint

from spacerobot.diagnosis.answer.evidence import evidence_of_parts
from spacerobot.diagnosis.answer.learned import draft_of
from spacerobot.diagnosis.answer.mended_model import model_text, read_model
from spacerobot.diagnosis.answer.part_verdict import verdict_of
from spacerobot.diagnosis.answer.record import written
from spacerobot.diagnosis.answer.schema import validate
from spacerobot.diagnosis.learning.bands import band
from spacerobot.diagnosis.learning.learned_part import LearnedPart, room_for_a_law, settle_part
from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.diagnosis.learning.part import laws_of, taken_by_curves, words
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.measured import port_forces
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.effects import registry
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Friction
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.view.report.write import write_report

RESISTANCE = ("coulomb_friction", "viscous_friction", "viscous_drag", "quadratic_drag")


def searched(study: Study, names: tuple[str, ...] = RESISTANCE) -> Part:
    """The study's one part after a search among a few effects."""
    (model,) = some_models_for(study)
    return Part(grow(model, effects=[effect(n) for n in names]))


def quiet(*_: object) -> None:
    pass


def law_of(part: Part) -> Learnt:
    assert isinstance(part, LearnedPart), part.not_learned
    assert part.learnt is not None
    return part.learnt


def numbers(learnt: Learnt) -> dict[str, float]:
    return {k.rpartition(".")[2]: v for k, v in learnt.fit.values().items() if k.startswith(learnt.site.effect.name)}


def held(learnt: Learnt, truth: Any) -> float:
    """Share of the range that was visited on which the band holds the truth."""
    seen = band(learnt.curve)
    true = truth(seen.x)
    return float(np.mean((seen.low <= true) & (true <= seen.high)))


@pytest.fixture(scope="module")
def rippling(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, LearnedPart]:
    def law(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 0.15 * np.sin(12.0 * q + 0.7) + 0.2 * np.sign(v) + 0.03 * v

    study = joint(tmp_path_factory.mktemp("ripple"), law)
    part = settle_part(searched(study), quiet)
    law_of(part)
    assert isinstance(part, LearnedPart)
    return study, part


@pytest.mark.slow
def test_a_torque_that_ripples_with_the_angle_is_learned_beside_friction(rippling: tuple[Study, LearnedPart]) -> None:
    _, part = rippling
    learnt, values = law_of(part), part.fit.values()
    assert (learnt.site.where, learnt.curve.shape.kind, learnt.curve.shape.of) == ("joint.shaft", "force", "q")
    found = numbers(learnt)
    assert abs(found["a_1"]) == pytest.approx(0.15, rel=0.03)
    assert found["a_1_length"] == pytest.approx(2.0 * np.pi / 12.0, rel=5e-3)
    assert values["coulomb_friction@joint.shaft.force_N"] == pytest.approx(0.2, rel=0.03)
    assert values["viscous_friction@joint.shaft.coefficient_Ns_m"] == pytest.approx(0.03, rel=0.1)
    assert held(learnt, lambda q: 0.15 * np.sin(12.0 * q + 0.7)) >= 0.85
    assert part.after.total < 0.01 * part.before.total
    assert max(part.loudness.values()) < 1.3


@pytest.mark.slow
def test_it_is_said_shown_and_runs_again(
    rippling: tuple[Study, LearnedPart], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, part = rippling
    answer = verdict_of(study, [part], seed=0, seconds=1.0)
    said = written(answer)
    validate(said)
    assert said["verdict"] == said["parts"][0]["verdict"] == "learned"
    assert [e["effect"] for e in said["effects"]] == ["coulomb_friction", "learned_law", "viscous_friction"]
    (law,) = said["learned"]
    assert (law["table"]["unit"], law["table"]["value_unit"]) == ("rad", "N m")
    assert law["parameters"]["a_1"]["unit"] == "N m"
    assert law["parameters"]["a_1_length"]["unit"] == "rad"
    page = tmp_path / "report.html"
    write_report(said, evidence_of_parts(study, [part], answer), page)
    assert "displacement within a period" in page.read_text(encoding="utf-8")
    (tmp_path / "model.toml").write_text(model_text(study, [part]))
    (found,) = read_model(tmp_path / "model.toml")
    made, z = found.hypothesis(part.model)
    assert made.values(z) == pytest.approx(part.fit.values(), rel=1e-6)
    draft = draft_of(law_of(part))
    assert draft is not None
    (tmp_path / "my_law.py").write_text(draft)
    monkeypatch.setattr(registry, "_effects", dict(registry.all_effects()))
    assert registry.load_effects(tmp_path / "my_law.py") == ["my_law"]
    (site,) = part.model.sites([effect("my_law")])
    assert site.where == "joint.shaft"


@pytest.mark.slow
def test_it_comes_back_from_a_process_of_its_own(rippling: tuple[Study, LearnedPart]) -> None:
    part = rippling[1]
    again = pickle.loads(pickle.dumps(part))
    assert numbers(law_of(again)) == numbers(law_of(part))
    assert again.fit.values() == part.fit.values()
    trial = again.trials[0]
    mechanism = again.model.trial_mechanism(again.fit.hypothesis, again.fit.z, trial)
    told = again.model.predict(mechanism, trial, again.fit.trials[trial.id].initial)
    mechanism = part.model.trial_mechanism(part.fit.hypothesis, part.fit.z, trial)
    assert np.array_equal(
        told.blocks[0], part.model.predict(mechanism, trial, part.fit.trials[trial.id].initial).blocks[0]
    )


@pytest.mark.slow
def test_friction_that_rises_over_a_worn_stretch_is_learned_with_its_place(tmp_path: Path) -> None:
    def level(q: np.ndarray) -> np.ndarray:
        return np.asarray(0.2 + 0.25 * np.exp(-(((q - 0.2) / 0.2) ** 2)))

    part = settle_part(searched(joint(tmp_path, lambda q, v: np.sign(v) * level(q), seed=7)), quiet)
    learnt = law_of(part)
    assert (learnt.curve.shape.kind, learnt.curve.shape.of) == ("friction", "d")
    assert [s.label for s in part.fit.hypothesis.sites] == [learnt.site.label]  # its constant is friction of one level
    assert held(learnt, level) >= 0.85
    found = numbers(learnt)
    assert (found["a_1"], found["a_2"]) == pytest.approx((0.25, 0.2), rel=0.05)
    assert (found["a_1_place"], found["a_1_width"]) == pytest.approx((0.2, 0.2), rel=0.1)


@pytest.mark.slow
def test_a_damper_of_one_way_at_a_joint_is_learned(tmp_path: Path) -> None:
    part = settle_part(searched(joint(tmp_path, lambda q, v: 0.12 * np.maximum(v, 0.0), seed=8)), quiet)
    learnt = law_of(part)
    assert learnt.told is not None
    assert learnt.told.words == "like viscous damping, on one stroke only"
    assert numbers(learnt)["a_1"] == pytest.approx(0.12, rel=0.03)


@pytest.mark.parametrize(
    ("law", "verdict"),
    [
        (lambda q, v: 0.0 * q, "nothing_missing"),
        (lambda q, v: 0.3 * np.sign(v), "named"),
        (lambda q, v: 0.2 * np.sign(v) + 0.05 * v, "named"),
    ],
)
def test_nothing_is_learned_where_the_catalogue_suffices(law: Any, verdict: str, tmp_path: Path) -> None:
    part = searched(joint(tmp_path, law, seed=3))
    assert part.verdict == verdict
    assert not room_for_a_law(part)
    assert settle_part(part, quiet) is part


@pytest.mark.slow
def test_what_does_not_repeat_is_not_learned_and_says_why(tmp_path: Path) -> None:
    """A torque of its own in every trial, over time: of no use to any other trial."""
    random = np.random.default_rng(5)

    def law(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        time = np.linspace(0.0, 2.0 * np.pi, q.size)
        waves = (random.normal() * np.sin(k * time + random.uniform(0.0, 6.0)) for k in range(3, 9))
        return np.asarray(0.1 * sum(waves))

    part = searched(joint(tmp_path, law, seed=6))
    assert part.verdict == "unknown"
    after = settle_part(part, quiet)
    assert after.verdict == "unknown"
    assert after.not_learned
    said = written(verdict_of(joint(tmp_path, law, seed=6), [after], seed=0, seconds=1.0))
    assert any(after.not_learned.why in line for line in said["why"])


def waving(q: np.ndarray) -> np.ndarray:
    """A level of friction along the way of one joint."""
    return np.asarray(0.2 * (1.0 + 0.6 * np.sin(9.0 * q)))


@pytest.mark.slow
def test_a_name_that_leaves_mostly_one_curve_is_asked_again_where_no_noise_is_stated(tmp_path: Path) -> None:
    """A mean level explains much; what it leaves is the same at the same place, and many bends long."""
    joint(tmp_path, lambda q, v: waving(q) * np.sign(v))
    file = tmp_path / "study.toml"
    file.write_text(re.sub(r", sigma = [^ }]+", "", file.read_text()))
    part = searched(load_study(tmp_path))
    assert {s.effect.name for s in part.fit.hypothesis.sites} == {"coulomb_friction"}
    assert taken_by_curves(part.growth) > 0.7
    learnt = law_of(settle_part(part, quiet))
    assert (learnt.curve.shape.kind, learnt.curve.shape.of) == ("friction", "d")
    assert held(learnt, waving) >= 0.8


@pytest.mark.slow
def test_what_a_name_leaves_and_no_curve_takes_is_not_asked(tmp_path: Path) -> None:
    joint(tmp_path, lambda q, v: 0.2 * np.sign(v))
    file = tmp_path / "study.toml"
    file.write_text(re.sub(r", sigma = [^ }]+", "", file.read_text()))
    assert taken_by_curves(searched(load_study(tmp_path)).growth) < 0.2


@pytest.mark.slow
def test_drag_of_a_power_of_its_own_is_learned_at_a_body(tmp_path: Path) -> None:
    def drag(x: float, v: float) -> float:
        return float(-0.6 * v * abs(v) ** 0.5)

    study = body(tmp_path, drag, (0.3, 0.5, 0.8, 1.1, 1.5), seed=2)
    part = searched(study, ("viscous_drag",))
    assert room_for_a_law(part)
    learnt = law_of(settle_part(part, quiet))
    assert (learnt.site.where, learnt.curve.shape.of) == ("target", "v")
    assert held(learnt, lambda v: 0.6 * v * np.abs(v) ** 0.5) >= 0.8
    found = numbers(learnt)
    assert found["a_1_exponent"] == pytest.approx(1.5, rel=0.03)
    assert found["a_1"] == pytest.approx(0.6, rel=0.03)


def test_the_kinds_of_law_are_those_that_a_part_can_have(tmp_path: Path) -> None:
    turning = searched(joint(tmp_path / "joint", lambda q, v: 0.3 * np.sign(v)))
    assert [words(law) for law in laws_of(turning.growth)] == [
        "a force of its rate at joint.shaft",
        "a force of its displacement at joint.shaft",
        "dry friction of its displacement at joint.shaft",
        "a force of its displacement within a period at joint.shaft",
    ]
    sliding = searched(body(tmp_path / "body", lambda x, v: -0.4 * v, (0.4, 0.8)))
    assert {law.where for law in laws_of(sliding.growth)} == {"target"}


def rising(v: float, normal: float, d: float, p: Any) -> float:
    """A level that grows with the place."""
    return p[0] * d


def test_friction_along_a_measured_motion_knows_its_place() -> None:
    place, rate = np.array([0.1, 0.2, 0.3, 0.4]), np.array([1.0, -1.0, 0.0, 2.0])
    mechanism = Mechanism(
        coordinates={"joint.a": Coordinate("joint.a", 1.0)},
        ports={"joint.a": {"joint.a": 1.0}},
        frictions=(Friction("rising", "joint.a", rising, (2.0,)),),
    )
    found = port_forces(mechanism, {"joint.a": place}, {"joint.a": rate}, 0.01)["joint.a"]
    np.testing.assert_allclose(found, [-0.2, 0.4, 0.0, -0.8])
    needed = np.full(4, 0.5)
    at_rest = port_forces(mechanism, {"joint.a": place}, {"joint.a": rate}, 0.01, held={"joint.a": (needed, 0.1)})
    np.testing.assert_allclose(at_rest["joint.a"], [-0.2, 0.4, 0.5, -0.8])
