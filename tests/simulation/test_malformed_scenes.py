"""Malformed scenes end in one clear error that says what was given and where, never in a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.simulation.parts import Target
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.support.errors import InputError

CASES: dict[str, tuple[str, str]] = {
    "not TOML": ("robot = pa10", "not TOML"),
    "unclosed string": ('robot = "pa10_wrist\nbase = 1', "line 1"),
    "key twice": ('robot = "pa10_wrist"\nrobot = "pa10"', "not TOML"),
    "unknown format": ("format = 2", "format"),
    "format is a truth": ("format = true", "format"),
    "unknown key": ('robots = "pa10_wrist"', "did you mean 'robot'"),
    "unknown table": ("[wrists]\nmass = 1", "did you mean 'wrist'"),
    "unknown key in a table": ("[wrist]\nstifness = 1", "did you mean 'stiffness'"),
    "unknown robot": ('robot = "pa10_wrst"', "did you mean 'pa10_wrist'"),
    "robot is a number": ("robot = 7", "must be text"),
    "robot is empty": ('robot = ""', "robot"),
    "robot is XML": ('robot = "<robot/>"', "a name or a URDF path"),
    "robot file missing": ('robot = "no/such.urdf"', "does not exist"),
    "unknown base": ('base = "float"', "base"),
    "base free without spacecraft": ('base = "free"', "spacecraft"),
    "spacecraft on a fixed base": ('base = "fixed"\n[spacecraft]\nmass = 5.0', "floats"),
    "spacecraft that cannot exist": ("[spacecraft]\nmass = -5.0\n", "spacecraft"),
    "unknown joints": ('joints = "stiff"', "joints"),
    "servo without servo joints": ("[servo]\nstiffness = 1.0", "servo joints"),
    "servo joints without servo": ('joints = "servo"', "servo"),
    "servo of wrong length": ('joints = "servo"\n[servo]\nstiffness = [1.0, 2.0]', "wrong length"),
    "negative servo": ('joints = "servo"\n[servo]\nstiffness = -1.0', "must not be negative"),
    "pose too short": ("pose = [0, 0, 0]", "wrong length"),
    "pose has text": ('pose = [0, 0, 0, 0, 0, 0, "x"]', "not a number"),
    "pose has nan": ("pose = [0, 0, 0, 0, 0, 0, nan]", "finite"),
    "pose twice": ("pose = [0, 0, 0, 0, 0, 0, 0]\npose_deg = [0, 0, 0, 0, 0, 0, 0]", "both"),
    "unknown frame": ('robot = "panda"\ntip = "panda_hnd"', "did you mean 'panda_hand'"),
    "frame for a wrist that is there": ('tip = "W2"', "wrist already"),
    "unknown other joint": (
        'robot = "panda"\n[others]\npanda_finger_joint9 = 0.01',
        "did you mean 'panda_finger_joint",
    ),
    "other joint of the chain": ("[others]\nS1 = 0.1", "set by the pose"),
    "other joint nan": ('robot = "panda"\n[others]\npanda_finger_joint1 = nan', "finite"),
    "approach no unit vector": ("approach = [1, 1, 0]", "unit vector"),
    "approach zero": ("approach = [0, 0, 0]", "unit vector"),
    "approach too short": ("approach = [1, 0]", "wrong length"),
    "approach is text": ('approach = "x"', "list of numbers"),
    "approach has nan": ("approach = [nan, 0, 0]", "finite"),
    "gravity too long": ("gravity = [0, 0, 0, 0]", "wrong length"),
    "duration zero": ("duration = 0", "duration"),
    "duration infinite": ("duration = inf", "finite"),
    "duration is a truth": ("duration = true", "not a number"),
    "unknown backend": ('backend = "mujoco"', "backend"),
    "wrist is a number": ("wrist = 3", "must be a table"),
    "wrist without mass": ("[wrist]\nmass = 0", "must be positive"),
    "wrist with negative mass": ("[wrist]\nmass = -0.7", "positive"),
    "wrist with negative stiffness": ("[wrist]\nstiffness = -530", "must not be negative"),
    "wrist stiffness nan": ("[wrist]\nstiffness = nan", "finite"),
    "wrist stiffness text": ('[wrist]\nstiffness = "soft"', "not a number"),
    "negative guide friction": ("[wrist]\nguide_friction = -1", "must not be negative"),
    "contact without stiffness": ("[contact]\nstiffness = 0", "must be positive"),
    "negative contact damping": ("[contact]\ndamping = -1", "must not be negative"),
    "unknown law": ('[contact]\nlaw = "hertzian"', "did you mean 'hertz'"),
    "chi without its law": ("[contact]\nchi_over_k = 0.5", "hunt_crossley"),
    "dashpot with hunt_crossley": ('[contact]\nlaw = "hunt_crossley"\ndamping = 3', "chi_over_k"),
    "exponent too small": ('[contact]\nlaw = "hertz"\nexponent = 0.1', "exponent"),
    "exponent of a linear law": ("[contact]\nexponent = 1.5", "exponent"),
    "bilateral is a word": ('[contact]\nbilateral = "yes"', "true or false"),
    "bilateral and adhesive": ("[contact]\nbilateral = true\nadhesion = 1", "pulls already"),
    "target without mass": ("[target]\nmass = 0", "positive"),
    "target of negative mass": ("[target]\nmass = -9", "positive"),
    "target of infinite mass": ("[target]\nmass = inf", "finite"),
    "target inertia and yaw inertia": ("[target]\ninertia = [1, 1, 1]\nyaw_inertia = 1", "one of them"),
    "target inertia of two": ("[target]\ninertia = [1, 1]", "three moments"),
    "target inertia not symmetric": ("[target]\ninertia = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]", "symmetric"),
    "target inertia impossible": ("[target]\ninertia = [1, 1, 3]", "triangle"),
    "target inertia negative": ("[target]\ninertia = [-1, 1, 1]", "positive definite"),
    "contact point of one": ("[target]\ncontact_point = [0.1]", "wrong length"),
    "spin of two": ("[target]\nspin = [1, 2]", "wrong length"),
    "attitude nan": ("[target]\nattitude = [nan, 0, 0]", "finite"),
    "starts in penetration": ("[target]\ngap = -0.001", "penetration"),
    "target at rest": ("[target]\nspeed = 0", "never arrives"),
    "target flies away": ("[target]\nspeed = -0.1", "never arrives"),
    "arrives after the end": ("duration = 1\n[target]\nspeed = 0.1\ngap = 0.5", "never arrives"),
    "chaser speed of a bolted arm": ("[chaser]\nhand_speed = 0.1", "free chaser"),
    "effects as a table": ("[effects]\neffect = 1", r"\[\[effects\]\]"),
    "effect without a place": ('[[effects]]\neffect = "adhesion"', "where"),
    "unknown effect": ('[[effects]]\neffect = "coulomb"\nwhere = "wrist"', "did you mean 'coulomb_friction'"),
    "unknown place": (
        '[[effects]]\neffect = "coulomb_friction"\nwhere = "wrst"\nparameters = { force_N = 1.0 }',
        "did you mean 'wrist'",
    ),
    "unknown joint": (
        'joints = "free"\n[[effects]]\neffect = "coulomb_friction"\nwhere = "joint.S9"\nparameters = { force_N = 1.0 }',
        "did you mean 'joint.S",
    ),
    "unknown parameter": (
        '[[effects]]\neffect = "coulomb_friction"\nwhere = "wrist"\nparameters = { forceN = 1.0 }',
        "did you mean 'force_N'",
    ),
    "parameter missing": ('[[effects]]\neffect = "coulomb_friction"\nwhere = "wrist"', "lacks a parameter"),
    "parameter negative": (
        '[[effects]]\neffect = "coulomb_friction"\nwhere = "wrist"\nparameters = { force_N = -1.0 }',
        "outside its bounds",
    ),
    "parameter nan": (
        '[[effects]]\neffect = "coulomb_friction"\nwhere = "wrist"\nparameters = { force_N = nan }',
        "finite",
    ),
    "parameter is text": (
        '[[effects]]\neffect = "coulomb_friction"\nwhere = "wrist"\nparameters = { force_N = "x" }',
        "not a number",
    ),
    "joint effect on the reduced backend": (
        'backend = "reduced"\njoints = "free"\n[[effects]]\neffect = "preload"\nwhere = "joint.S2"\n'
        "parameters = { force_N = 1.0 }",
        "backend multibody alone",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_one_clear_error(name: str) -> None:
    text, said = CASES[name]
    with pytest.raises(InputError, match=said) as caught:
        scene_from_text(text, where="scene.toml", folder=Path("/nowhere"))
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith("scene.toml")


@pytest.mark.parametrize("name", list(CASES)[::7])
def test_the_command_exits_with_2_and_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(CASES[name][0])
    assert main(["simulate", str(path), "--json", "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert len(told.err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists(), "nothing half-written"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["pa10_wrst"], "did you mean 'pa10_wrist'"),
        (["none.toml"], "no such scene"),
        (["pa10_wrist", "--wrist-stiffness", "-1"], "must not be negative"),
        (["pa10_wrist", "--speed", "fast"], "not a number"),
        (["pa10_wrist", "--speed", "nan"], "finite"),
        (["pa10_wrist", "--q", "1", "2"], "wrong length"),
        (["pa10_wrist", "--deg"], "--deg"),
        (["pa10_wrist", "--approach", "1", "1", "1"], "unit vector"),
        (["pa10_wrist", "--target-inertia", "1", "2"], "1, 3 or 9"),
        (["pa10_wrist", "--effect", "friction"], "NAME@WHERE"),
        (["pa10_wrist", "--effect", "coulomb_friction@wrist:force_N"], "NAME=VALUE"),
        (["pa10_wrist", "--effects", "none.py"], "No such file"),
        (["pa10_wrist", "--servo-damping", "1"], "--servo-stiffness"),
        (["pa10_wrist", "--tolerance", "2"], "tolerance"),
        (["pa10_wrist", "--rate", "0"], "rate"),
        (["pa10_wrist", "--rate", "1e9"], "rate"),
        (["pa10_wrist", "--duration", "-1"], "must be positive"),
        (["pa10_wrist", "--wrist-stiffness", "0"], "duration"),
        (["pa10_wrist", "--stiffness", "3"], "unknown option"),
        (["pa10_wrist", "--gap", "1", "--speed", "0.1", "--duration", "2"], "never arrives"),
        (
            ["pa10_wrist", "--gap", "0.1", "--speed", "0.1", "--effect", "viscous_drag@target:coefficient_Ns_m=50"],
            "never",
        ),
        ([], "required"),
    ],
)
def test_wrong_arguments(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", *arguments]) == 2
    told = capsys.readouterr()
    assert said in told.err
    assert told.out == ""


def test_a_scene_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xff\xfe\x00robot")
    with pytest.raises(InputError, match="cannot be read"):
        Scene.from_toml(path)
    path.write_text("#" * 2_000_000)
    with pytest.raises(InputError, match="too large"):
        Scene.from_toml(path)
    path.write_text("a = " + "[" * 5000)
    with pytest.raises(InputError, match="not TOML"):
        Scene.from_toml(path)


def test_a_pose_outside_the_limits_is_answered_with_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.warns(PoseLimitWarning, match="joint S2 at 200 deg"):
        scene_from_text("pose_deg = [0, 200, 0, 90, 0, -45, 0]")
    pose = ["--q", "0", "200", "0", "90", "0", "-45", "0", "--deg"]
    assert main(["simulate", "pa10_wrist", *pose, "--duration", "0.1", "--json"]) == 0
    assert "warning: joint S2 at 200 deg" in capsys.readouterr().err


def test_what_python_gives_is_checked_alike() -> None:
    for wrong in ({"wrist": 3}, {"effects": ("adhesion",)}, {"target": Target}, {"joints": None}, {"pose": 3.0}):
        with pytest.raises(InputError):
            Scene(**wrong)


def test_there_are_enough_of_them() -> None:
    assert len(CASES) >= 40
