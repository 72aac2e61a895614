from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.model import examples
from spacerobot.model.library import bundled, load


def test_the_list_names_every_robot_or_says_why_not(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["robots"]}
    assert set(rows) == {*bundled(), *examples.names()}
    assert rows["pa10_wrist"]["dof"] == 7
    assert rows["pa10_wrist"]["mass_kg"] == pytest.approx(34.9)
    assert rows["panda"]["tip"] == "panda_hand_tcp"
    assert rows["chaser_pa10_wrist"]["base"] == "free"
    assert "finger" in rows["bravo7_gripper"]["refused"]
    assert main(["robots"]) == 0
    text = capsys.readouterr().out
    assert all(name in text for name in rows)


def test_one_robot_in_full(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", "pa10_wrist", "--json"]) == 0
    robot = json.loads(capsys.readouterr().out)["robot"]
    joints = {joint["name"]: joint for joint in robot["joints"]}
    assert joints["S1"]["rotor_inertia"] == pytest.approx(0.75)
    assert joints["S1"]["upper"] == pytest.approx(math.radians(177), abs=1e-6)
    assert (joints["S1"]["unit"], joints["wrist_slider"]["unit"]) == ("rad", "m")
    assert main(["robots", "kinova"]) == 0
    assert "j2s6s200_joint_finger_1" not in capsys.readouterr().out.split("outside")[0]


def test_infinite_limits_are_rfc_8259(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", "kinova", "--json"]) == 0
    joints = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)["robot"]["joints"]
    assert joints[0]["upper"] == "inf"


def test_out_holds_a_urdf_that_loads_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run"
    arguments = ["robots", "pa10", "--wrist", "--chaser", "--out", str(out), "--json"]
    assert main(arguments) == 0
    first = capsys.readouterr().out
    robot = load(out / "robot.urdf")
    assert (robot.floating, robot.slider) == (True, "wrist_slider")
    assert json.loads((out / "robots.json").read_text()) == json.loads(first)
    assert main(arguments) == 0, "a finished run is reused"
    assert capsys.readouterr().out == first
    assert main(["robots", "pa10c", "--out", str(out)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert main(["robots", "pa10c", "--out", str(out), "--overwrite"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["pa10_wrst"], "did you mean 'pa10_wrist'"),
        (["pa10", "--tip", "flnge"], "did you mean 'flange'"),
        (["pa10_wrist", "--wrist"], "has a wrist already"),
        (["chaser_pa10_wrist", "--chaser"], "floats already"),
        (["cassie"], "SDF"),
        (["pa10", "--package-dir", "/no/such"], "package folder"),
        (["no.urdf"], "does not exist"),
        (["<robot/>"], "no link"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["robots", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert message in captured.err
    assert captured.err.count("\n") == 1
