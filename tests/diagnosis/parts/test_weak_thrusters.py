"""Thrusters weaker than their command on a body of known mass: only the ratio of force to mass is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import reweighted, split
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection import held_out
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_air_bed import INERTIA, LEVELS, NOISE, flown, head

SHARE = 0.8


def air_bed(folder: Path, forces: float, torque: float) -> Study:
    """Three runs under commands that hold for half a second, of which these shares come out."""
    random, text = np.random.default_rng(5), [head("An air bed with thrusters and a wheel")]
    share = np.array([forces, forces, torque])
    for run in range(3):
        level = random.choice([-1.0, 0.0, 1.0], (17, 3)) * LEVELS
        start = [0.0, 0.0, 0.0, *(random.standard_normal(3) * [0.03, 0.03, 0.05])]
        text.append(flown(folder, run, level, lambda command, yaw: share * command, start, 8.0, random))
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)


@pytest.mark.parametrize(
    "torque", [pytest.param(1.0, marks=pytest.mark.slow), pytest.param(SHARE, marks=pytest.mark.slow)]
)
def test_weak_thrusters_are_never_a_payload_for_sure(torque: float, tmp_path: Path) -> None:
    """Forces alone: the same as a larger mass, and both are said. With their torque: what the command is worth."""
    verdict = diagnose(air_bed(tmp_path, SHARE, torque), jobs=1).verdict
    said = {tuple((e["effect"], e["where"]) for e in a["effects"]) for a in verdict["alternatives"]}
    if torque == SHARE:
        assert verdict["verdict"] == "named"
        (found,) = verdict["effects"]
        assert (found["effect"], found["where"]) == ("scale", "command")
        assert found["parameters"]["factor"]["value"] == pytest.approx(SHARE, rel=0.03)
    else:
        assert verdict["verdict"] == "ambiguous"
        assert {(("payload", "target"),), (("scale", "command.force"),)} <= said


@pytest.mark.slow
def test_a_weak_command_of_a_body_that_was_weighed_is_no_two_wrong_values(tmp_path: Path) -> None:
    """Mass and inertia, known to a hundredth, may both be a quarter too large by chance; the command is likelier."""
    study = air_bed(tmp_path, SHARE, SHARE)
    text = (tmp_path / "study.toml").read_text()
    known = "[baseline.sigma]\nbody.mass = 0.01\nbody.yaw_inertia = 0.01\n[streams.log]\n"
    (tmp_path / "study.toml").write_text(text.replace("[streams.log]\n", known, 1))
    verdict = diagnose(load_study(study.path), jobs=1).verdict
    assert verdict["verdict"] == "ambiguous"
    assert verdict["confidence"] > 0.5
    first, *others = verdict["alternatives"]
    assert [(e["effect"], e["where"]) for e in first["effects"]] == [("scale", "command")]
    assert first["parameters"]["scale@command.factor"] == pytest.approx(SHARE, rel=0.03)
    assert {"body.mass", "body.yaw_inertia"} in [set(o["parameters"]) for o in others if not o["effects"]]


def test_forces_are_a_place_of_their_own_only_where_a_torque_is_beside_them(tmp_path: Path) -> None:
    (model,) = models_for(air_bed(tmp_path, 1.0, 1.0))
    assert {s.effect.name for s in model.sites() if s.where == "command.force"} == {"scale"}
    text = (tmp_path / "study.toml").read_text()
    alone = "\n".join(line for line in text.splitlines() if "torque" not in line and "yaw" not in line)
    (tmp_path / "study.toml").write_text(alone)
    (model,) = models_for(load_study(tmp_path))
    assert not [s for s in model.sites() if s.where == "command.force"]


def test_of_three_moments_of_inertia_a_body_in_the_plane_has_the_one_that_it_yaws_with(tmp_path: Path) -> None:
    air_bed(tmp_path, 1.0, 1.0)
    path = tmp_path / "study.toml"
    path.write_text(path.read_text().replace(f"yaw_inertia = {INERTIA}", f"inertia = [0.7, 0.9, {INERTIA}]"))
    (model,) = models_for(load_study(tmp_path))
    assert model.base["body.yaw_inertia"] == INERTIA
    assert "body.yaw_inertia" not in model.believed.unknown


@pytest.mark.parametrize("trust", [held_out.FAINTLY, 1.0])
def test_how_a_piece_starts_hangs_on_its_readings_and_not_on_what_they_weigh(trust: float, tmp_path: Path) -> None:
    """Where thrusters fire at once, the velocity of the first readings is not how the piece began."""
    (model,) = models_for(air_bed(tmp_path, 1.0, 1.0))
    made = hypothesis(model.believed, ())
    worst = 0.0
    for trial in reweighted(model.trials, dict.fromkeys(model.trials[0].channels, 30.0)):
        fitter = Fitter(model, [trial])
        start = held_out.start_of(fitter, model, made, made.start(), trial, trust=trust)
        residual, _ = fitter.residual(made, made.start(), trial, start)
        for part, weight in zip(split(residual, trial).values(), (b.weight for b in trial.blocks), strict=True):
            worst = max(worst, float(np.sqrt(np.mean((part / weight[0]) ** 2))))
    assert (worst < 2.0 * NOISE) == (trust < 1.0)
