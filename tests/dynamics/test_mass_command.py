from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.dynamics.effective_mass import effective_mass
from tests.dynamics.support import DEFAULT, robot

Q = ["--q", "0", "45", "0", "90", "0", "-45", "0", "--deg"]
PROMISED = ["robot", "frame", "q_rad", "direction", "base", "joints", "effective_mass_kg"]


def no_constant(text: str) -> float:
    raise AssertionError(f"{text} is not RFC 8259")


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    assert main(["mass", *arguments, "--json"]) == 0
    out = capsys.readouterr()
    assert out.out.count("\n{") == 0
    return json.loads(out.out, parse_constant=no_constant)


def test_the_example_of_the_readme(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "pa10_wrist", *Q, "--direction", "1", "0", "0", "--base", "fixed", "--joints", "free")
    assert set(PROMISED) <= set(found)
    expected = effective_mass(robot("pa10_wrist"), DEFAULT, [1.0, 0.0, 0.0])
    assert found["effective_mass_kg"] == pytest.approx(expected.effective_mass_kg, rel=1e-12)
    assert found["frame"] == robot("pa10_wrist").tip
    np.testing.assert_allclose(found["q_rad"], DEFAULT)
    assert np.shape(found["operational_inertia_3x3"]) == (3, 3)
    assert np.shape(found["operational_inertia_6x6"]) == (6, 6)
    assert np.shape(found["generalized_jacobian"]) == (6, 7)
    assert found["split"]["joints_locked_kg"] == "inf"
    assert found["warnings"] == []


def test_text_is_aligned_and_has_units(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mass", "pa10_wrist", *Q]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "S2 45 deg" in lines[2]
    row = next(line for line in lines if line.startswith("  effective mass"))
    assert row.endswith(" kg")
    ends = {line.rindex(" kg") for line in lines if line.endswith(" kg")}
    assert len(ends) == 1


@pytest.mark.parametrize(
    "q",
    [
        ["-1e-3", "0.5", "-.5", "-2", "0", "1", "-1E-3"],
        ["-1e-3,0.5,-.5,-2,0,1,-1E-3"],
        ["-1e-3,", "0.5,", "-.5,", "-2,", "0,", "1,", "-1E-3"],
        ["-1e-3 0.5 -.5 -2 0 1 -1E-3"],
    ],
    ids=["spaces", "commas", "both", "quoted"],
)
def test_negative_numbers_however_written(capsys: pytest.CaptureFixture[str], q: list[str]) -> None:
    found = answer(capsys, "pa10", "--q", *q, "--direction", "-1", "0", "-1e-9")
    assert found["q_rad"] == [-1e-3, 0.5, -0.5, -2.0, 0.0, 1.0, -1e-3]
    assert found["direction"][0] == -1.0


def test_infinity_is_text(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "pa10", "--q", *["0"] * 7, "--direction", "0", "0", "1")
    assert found["effective_mass_kg"] == "inf"
    assert found["mobility_per_kg"] == 0.0
    assert found["operational_inertia_6x6"] is None
    assert any("infinite" in note for note in found["notes"])


def test_servo_joints_say_at_which_frequency(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    servo = ["--joints", "servo", "--servo-stiffness", "1e5", "--servo-damping", "50"]
    spring = ["--wrist-stiffness", "530", "--target-mass", "9"]
    found = answer(capsys, "pa10_wrist", *Q, *servo, *spring, "--out", str(tmp_path / "out"))
    assert 7.0 < found["apparent_mass"]["omega_rad_s"] < 7.5  # sqrt(530/9.7) = 7.39
    assert "sqrt(k_w/m~)" in found["notes"][0]
    real, imaginary = found["apparent_mass"]["real_kg"], found["apparent_mass"]["imaginary_kg"]
    assert math.hypot(real, imaginary) == pytest.approx(found["effective_mass_kg"])
    assert real < 0.0
    table = np.genfromtxt(tmp_path / "out" / "apparent_mass.csv", delimiter=",", names=True)
    assert table["magnitude_kg"][200] == pytest.approx(found["effective_mass_kg"], rel=1e-6)
    given = answer(capsys, "pa10_wrist", *Q, *servo, "--frequency", "2")
    assert given["apparent_mass"]["omega_rad_s"] == pytest.approx(4.0 * math.pi)
    assert main(["mass", "pa10_wrist", *Q, *servo, "--frequency", "2"]) == 0
    assert "phase" in capsys.readouterr().out


def test_out_holds_the_answer_and_is_reused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out = ["--out", str(tmp_path / "out")]
    found = answer(capsys, "pa10", *Q, *out)
    path = tmp_path / "out" / "mass.json"
    assert json.loads(path.read_text()) == found
    stamp = path.stat().st_mtime_ns
    answer(capsys, "pa10", *Q, *out)
    assert path.stat().st_mtime_ns == stamp
    assert main(["mass", "pa10c", *Q, *out]) == 2
    assert "--overwrite" in capsys.readouterr().err
    answer(capsys, "pa10c", *Q, *out, "--overwrite")
    assert json.loads(path.read_text())["robot"] == "pa10c"


def test_impact_of_a_target(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "chaser_pa10_wrist", *Q, "--target-mass", "9", "--restitution", "0.8", "--speed", "0.05")
    hit = found["impact"]
    assert hit["matching_mass_kg"] == pytest.approx(9.0 / 0.8)
    assert hit["impulse_Ns"] == pytest.approx(1.8 * 0.05 * hit["reduced_mass_kg"])
    still = answer(capsys, "pa10", *Q, "--target-mass", "9", "--speed", "0", "--restitution", "0")
    assert still["impact"]["impulse_Ns"] == 0.0
    assert still["impact"]["matching_mass_kg"] == "inf"
    assert main(["mass", "chaser_pa10_wrist", *Q, "--target-mass", "9"]) == 0
    text = capsys.readouterr().out
    assert "base reaction" in text
    assert "impulse of the impact" in text


def test_other_joints_can_be_set(capsys: pytest.CaptureFixture[str]) -> None:
    pose = ["--q", "0", "-0.5", "0", "-2", "0", "1.5", "0.8"]
    closed = answer(capsys, "panda", *pose, "--frame", "panda_hand")
    opened = answer(capsys, "panda", *pose, "--frame", "panda_hand", "--set", "panda_finger_joint1=0.04")
    assert closed["effective_mass_kg"] != opened["effective_mass_kg"]
    turned = answer(capsys, "pa10", "--set", "S2=45", "E1=90", "--set", "W1=-45", "--deg")
    np.testing.assert_allclose(turned["q_rad"], DEFAULT)


def test_a_free_base_under_a_ground_arm_is_its_own_link(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "pa10_wrist", *Q, "--base", "free")
    assert found["base"] == "free"
    assert "3.04 kg" in found["notes"][0]
    ground = answer(capsys, "pa10_wrist", *Q)
    assert found["effective_mass_kg"] < ground["effective_mass_kg"]


def test_a_pose_outside_the_limits_warns_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["pa10", "--q", "200", "0", "0", "90", "0", "0", "0", "--deg", "--json"]
    assert main(["mass", *arguments]) == 0
    captured = capsys.readouterr()
    assert "outside its limits" in captured.err
    assert len(json.loads(captured.out)["warnings"]) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["pa11"], "did you mean 'pa10'"),
        (["pa10", "--q", "1", "2"], "S1, S2, S3, E1, E2, W1, W2"),
        (["pa10", "--q", *["x"] * 7], "not a number"),
        (["pa10", "--q", *["nan"] * 7], "not a finite number"),
        (["pa10", "--direction", "1", "1", "0"], "not a unit vector"),
        (["pa10", "--direction", "0", "0"], "one each for x, y, z"),
        (["pa10", "--frame", "flanje"], "did you mean 'flange'"),
        (["pa10", "--set", "W8=1"], "unknown joint"),
        (["pa10", "--set", "W2"], "NAME=VALUE"),
        (["pa10", *Q, "--set", "W2=1"], "that --q has set"),
        (["pa10", "--base", "flying"], "fixed or free"),
        (["pa10", "--joints", "loose"], "free or locked or servo"),
        (["pa10", "--slider", "x"], "free or locked"),
        (["pa10", "--joints", "servo"], "stiffness"),
        (["pa10", "--joints", "servo", "--servo-stiffness", "1e5"], "frequency"),
        (["pa10", "--joints", "servo", "--servo-stiffness", "1", "2", "--frequency", "1"], "wrong length"),
        (["pa10", "--joints", "servo", "--servo-stiffness", "-1", "--frequency", "1"], "not negative"),
        (["pa10", "--joints", "servo", "--servo-stiffness", "1", "--frequency", "-1"], "positive"),
        (["pa10", "--frequency", "1"], "need servo joints"),
        (["pa10", "--target-mass", "-9"], "must be positive"),
        (["pa10", "--target-mass", "9", "--restitution", "2"], "between 0 and 1"),
        (["pa10", "--speed", "1"], "needs a target"),
        (["/nowhere/robot.urdf"], "/nowhere/robot.urdf"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert main(["mass", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert message in captured.err
    assert captured.err.startswith("spacerobot mass: ")
    assert captured.err.count("\n") == 1


def test_bad_input_leaves_no_folder(tmp_path: Path) -> None:
    assert main(["mass", "pa10", "--direction", "2", "0", "0", "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


def test_start_up_loads_nothing_heavy() -> None:
    code = (
        "import sys; from spacerobot.cli.main import main; main(['mass', 'pa10_wrist', '--json']); "
        "heavy = {'scipy', 'numba', 'matplotlib', 'yourdfpy', 'meshcat', 'h5py'} & set(sys.modules); "
        "sys.exit(f'loaded {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_help_has_examples(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["mass", "--help"])
    assert stopped.value.code == 0
    assert "spacerobot mass pa10_wrist --q 0 45 0 90 0 -45 0 --deg" in capsys.readouterr().out
