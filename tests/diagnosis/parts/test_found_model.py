"""What a diagnosis found is written down, runs again, and says which trial would settle what it could not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers_driven import driven_study
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.answer.mended_model import Found, read_model
from spacerobot.diagnosis.answer.part_verdict import next_trial_of as next_trial
from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.parts import Parts
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.overlay import overlay
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.effects.registry import effect
from spacerobot.model.library import load
from spacerobot.proof.engine.missing import Missing
from spacerobot.support.errors import InputError, NotFoundError


def model_of(viscous: float) -> InverseDynamics:
    robot = load(ARM)
    grids = {
        f"run{n}": (arm_log(robot, n, {"shoulder": (0.0, viscous, 0.0)}, seconds=8.0), f"motion {n}", {})
        for n in range(2)
    }
    return InverseDynamics(robot, (0.0, 0.0, -9.81), grids, ("shoulder", "elbow"), compared=["shoulder"])


def test_rivals_are_told_apart_by_a_faster_motion() -> None:
    growth = grow(model_of(0.5), effects=[effect("viscous_friction"), effect("quadratic_damping")])
    rival = next(c for c in growth.considered if c.label == (("quadratic_damping", "joint.shoulder"),))
    said = next_trial(Part(replace(growth, rivals=(rival,))))
    assert said is not None
    assert said.change == {"speed": "3 times that of the recorded motion"}
    assert [s[0].effect for s in said.separates] == ["viscous_friction", "quadratic_damping"]
    assert next_trial(Part(growth)) is None  # nothing is in doubt


def test_a_faster_motion_asks_for_its_own_torque() -> None:
    """Twice as fast: weight as before, inertia fourfold; checked against Pinocchio at the changed motion."""
    model = model_of(0.0)
    trial = model.trials[0]
    slow, fast = model.measured(trial), model.faster(2.0).measured(trial)
    own = model._arm.torque(slow.position, 2.0 * slow.velocity, 4.0 * slow.acceleration)
    np.testing.assert_allclose(fast.rigid, own, atol=1e-9)


def test_what_was_found_predicts_as_it_did() -> None:
    model = model_of(0.5)
    place = "joint.shoulder"
    found = Found("shoulder", {f"viscous_friction@{place}.coefficient_Ns_m": 0.5}, (("viscous_friction", place),))
    made, z = found.hypothesis(model)
    assert made.values(z)[f"viscous_friction@{place}.coefficient_Ns_m"] == pytest.approx(0.5)
    with pytest.raises(NotFoundError):
        replace(found, effects=(("viscous_friction", "wrist"),)).hypothesis(model)


@pytest.mark.parametrize(
    "text",
    ["", "[[parts]]\npart = 1\n", "parts = 3", "format = 2\nparts = []", "[[parts]]\npart='a'\nvalues=3\neffects=[]"],
)
def test_files_that_are_no_model_are_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "model.toml"
    file.write_text(text)
    with pytest.raises(InputError):
        read_model(file)


@pytest.mark.real
@pytest.mark.slow
def test_the_drive_is_overlaid_as_it_was_found(tmp_path: Path) -> None:
    from helpers_models import real_study

    from spacerobot.diagnosis.diagnose import diagnose
    from spacerobot.diagnosis.forward.parts import AsDiagnosed

    study = real_study("emps")
    found = diagnose(study, jobs=1)
    assert found.model is not None
    (tmp_path / "model.toml").write_text(found.model)
    model = AsDiagnosed.read(study, tmp_path / "model.toml")
    for trial in study.trials:
        (channel,) = model.simulate(trial).channels
        assert np.sqrt(np.mean(channel.residual**2)) < 2.5  # N; the drive pushes with 48


@pytest.mark.slow
def test_several_driven_joints_are_overlaid(tmp_path: Path) -> None:
    """By the torque that moves them: a right arm's to about its noise, and friction shows at the joint that has it."""
    (tmp_path / "right").mkdir()
    (tmp_path / "rubbing").mkdir()
    rub = Missing("coulomb_friction", "joint.S2", {"force_Nm": 5.0})
    right, rubbing = (overlay(driven_study(tmp_path / n, *h)) for n, h in (("right", ()), ("rubbing", (rub,))))
    assert isinstance(right.model, Parts)
    assert right.not_predicted == []  # motion is taken as given
    shares = {c: r.rms / right.residuals[c].rms for c, r in rubbing.residuals.items()}
    assert all(r.rms_sigmas < 3.0 for r in right.residuals.values())
    assert shares.pop("joint.S2.torque") > 10.0
    assert max(shares.values()) < 1.5


@pytest.mark.real
def test_every_real_study_has_an_overlay() -> None:
    from helpers_models import real_study

    for folder in sorted(Path("examples/studies/real").iterdir()):
        assert forward_model(real_study(folder.name)).assumptions, folder.name
