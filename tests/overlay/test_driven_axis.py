"""The driven axis: closed-form recordings come back as noise, wrong values do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.driven_axis import DrivenAxis
from spacerobot.diagnosis.machines.axis import axis_model
from spacerobot.diagnosis.machines.links import robot_of
from spacerobot.diagnosis.overlay import overlay
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.overlay.studies import axis_study, needs_real


def residual(folder: Path) -> np.ndarray:
    study = load_study(folder)
    (channel,) = forward_model(study).simulate(study.trials[0]).channels
    return channel.residual


def test_a_right_axis_shows_no_residual(tmp_path: Path) -> None:
    assert np.abs(residual(axis_study(tmp_path))).max() < 2e-5


def test_a_wrong_axis_shows_one(tmp_path: Path) -> None:
    right = residual(axis_study(tmp_path / "right"))
    for name, baseline in (("mass", "mass = 3.3\ndamping = 4.0"), ("damping", "mass = 3.0\ndamping = 0.0")):
        wrong = residual(axis_study(tmp_path / name, baseline=baseline))
        assert np.abs(wrong).max() > 50 * np.abs(right).max(), name


@pytest.mark.parametrize(("kind", "unit"), [("prismatic", "m"), ("revolute", "rad")])
def test_without_a_unit_the_robot_says_whether_an_axis_slides(tmp_path: Path, kind: str, unit: str) -> None:
    folder = axis_study(tmp_path)
    (folder / "axis.urdf").write_text((folder / "axis.urdf").read_text().replace("prismatic", kind))
    text = (folder / "study.toml").read_text().replace(', unit = "N"', "").replace(', unit = "m"', "")
    (folder / "study.toml").write_text(text)
    found = overlay(load_study(folder))
    assert [c.unit for c in found["a"].channels] == [unit]
    assert {v.unit for v in found.model.values} >= ({"kg"} if unit == "m" else {"kg m2"})


def test_a_drive_logged_in_volts_is_turned_into_newtons(tmp_path: Path) -> None:
    """By the stated motor constant, in the simulation and in what is found of unknown values."""
    plain = "mass = 3.0\ndamping = 4.0"
    volts = axis_study(tmp_path / "volts", sign=0.2, baseline=f"{plain}\ngain = 5.0")
    assert np.abs(residual(volts)).max() < 2e-5
    assert np.abs(residual(axis_study(tmp_path / "unsaid", sign=0.2))).max() > 1e-3
    open_ = axis_study(tmp_path / "open", sign=0.2, baseline='mass = "unknown"\ndamping = 4.0\ngain = 5.0')
    assert taken(open_)["mass"] == pytest.approx(3.0, rel=1e-3)


def taken(folder: Path) -> dict[str, float]:
    """Values of the axis that its overlay takes."""
    return {v.name.rpartition(".")[2]: v.value for v in DrivenAxis.of(load_study(folder)).values}


@pytest.mark.parametrize(
    "moving", ["mass = 3.0", "inertia = 3.0", "mass = 2.2\narmature = 0.8", 'inertia = "unknown"', 'mass = "unknown"']
)
def test_what_moves_is_what_is_stated_by_whatever_name(moving: str, tmp_path: Path) -> None:
    """The robot's own file says 7 kg."""
    folder = axis_study(tmp_path, baseline=f"{moving}\ndamping = 4.0")
    assert taken(folder)["mass"] == pytest.approx(3.0, rel=1e-3)
    assert np.abs(residual(folder)).max() < 2e-5


def test_what_is_unknown_is_not_said_to_be_believed(tmp_path: Path) -> None:
    model = DrivenAxis.of(load_study(axis_study(tmp_path, baseline='mass = "unknown"\ndamping = 4.0')))
    said = {v.name.rpartition(".")[2]: v.source for v in model.values}
    assert said["mass"] == DrivenAxis.source
    assert said["damping"] == "believed"


def test_a_rotor_as_well_known_as_stated_makes_the_whole_no_less_known(tmp_path: Path) -> None:
    """7 kg of the robot's file and a rotor of 0.5 kg, known to a tenth."""
    folder = axis_study(tmp_path, baseline="armature = 0.5\ndamping = 4.0")
    path = folder / "study.toml"
    path.write_text(path.read_text().replace("[streams", "[baseline.sigma]\njoint.slide.armature = 0.1\n[streams", 1))
    study = load_study(folder)
    believed = axis_model(study, study.trials, "slide", robot_of(study)).believed
    assert believed.values["joint.slide.mass"] == pytest.approx(7.5)
    assert believed.sigma == {"joint.slide.mass": pytest.approx(0.05 / 7.5)}


def test_a_trial_that_moves_more_says_so(tmp_path: Path) -> None:
    folder = axis_study(tmp_path, baseline="mass = 1.0\narmature = 0.8\ndamping = 4.0")
    assert np.abs(residual(folder)).max() > 1e-3
    path = folder / "study.toml"
    path.write_text(path.read_text() + "joint.slide.mass = 2.2\n")
    assert np.abs(residual(folder)).max() < 2e-5


def test_a_spring_is_followed_too(tmp_path: Path) -> None:
    baseline = "mass = 3.0\ndamping = 4.0\nstiffness = 900.0"
    assert np.abs(residual(axis_study(tmp_path, stiffness=900.0, baseline=baseline))).max() < 2e-5


def test_what_is_unknown_is_found(tmp_path: Path) -> None:
    found = taken(axis_study(tmp_path / "two", baseline='mass = "unknown"\ndamping = "unknown"'))
    assert found["mass"] == pytest.approx(3.0, rel=1e-3)
    assert found["damping"] == pytest.approx(4.0, rel=1e-2)
    baseline = 'mass = "unknown"\ndamping = "unknown"\nstiffness = "unknown"'
    found = taken(axis_study(tmp_path / "three", stiffness=50.0, baseline=baseline))
    assert found["mass"] == pytest.approx(3.0, rel=1e-3)
    assert found["stiffness"] == pytest.approx(50.0, rel=2e-2)


def test_a_drive_of_the_wrong_sign_is_refused(tmp_path: Path) -> None:
    study = load_study(axis_study(tmp_path, baseline='mass = "unknown"', sign=-1.0))
    with pytest.raises(InputError, match="sign of the drive"):
        DrivenAxis.of(study)


def test_a_mass_that_nobody_states_is_the_robots(tmp_path: Path) -> None:
    assert taken(axis_study(tmp_path, baseline="damping = 4.0"))["mass"] == pytest.approx(7.0)


@pytest.mark.parametrize("horizon", [None, 0.8])
def test_it_starts_anew_when_a_diagnosis_does_and_says_so(tmp_path: Path, horizon: float | None) -> None:
    """By the data, or as the study says; what is simulated goes over the whole record."""
    folder = axis_study(tmp_path, seconds=2.4)
    if horizon:
        path = folder / "study.toml"
        path.write_text(path.read_text().replace("title =", f"horizon = {horizon}\ntitle =", 1))
    study = load_study(folder)
    model = DrivenAxis.of(study)
    (machine, _, _), (channel,) = model.parts[0], model.simulate(study.trials[0]).channels
    assert channel.restarts is not None
    assert np.diff(channel.restarts) == pytest.approx(machine.window)
    assert channel.time[[0, -1]] == pytest.approx([0.0, 2.399], abs=machine.window / 2.0)
    assert any(f"every {machine.window:.3g} s" in text for text in model.assumptions)
    if horizon:
        assert machine.window == horizon


@pytest.mark.real
@needs_real("emps")
def test_emps_weighs_what_others_found_and_lacks_friction() -> None:
    study = load_study("real/emps")
    model = forward_model(study)
    assert isinstance(model, DrivenAxis)
    # 95.1 kg with friction in the model (Janot, Gautier, Brunot 2019); without it something near fits best
    mass = next(v.value for v in model.values if v.name.endswith(".mass"))
    assert mass == pytest.approx(95.1, rel=0.06)
    for trial in study.trials:
        (channel,) = model.simulate(trial).channels
        velocity = np.gradient(channel.measured, channel.time)
        moving = np.abs(velocity) > 0.03
        # friction is missing, so the simulation runs ahead of the axis, whichever way it goes
        assert np.mean(np.sign(channel.residual[moving]) == np.sign(velocity[moving])) > 0.8
