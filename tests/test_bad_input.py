"""Malformed scenes, studies, URDFs and arguments through the real command: one line, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.cli.main import main

SCENE = """format = 1
robot = "pa10_wrist"
base = "fixed"
joints = "locked"
pose_deg = [0, 45, 0, 90, 0, -45, 0]
approach = [1, 0, 0]
gravity = [0, 0, 0]
backend = "reduced"

[wrist]
mass = 0.7
stiffness = 530
damping = 1.4

[contact]
stiffness = 68000
damping = 40

[target]
mass = 9.0
speed = 0.07
gap = 0.01

[[effects]]
effect = "coulomb_friction"
where = "wrist"
parameters = { force_N = 0.4 }
"""

SCENES = {
    "robot unknown": ('"pa10_wrist"', '"pa10_wirst"', "did you mean 'pa10_wrist'"),
    "robot file missing": ('"pa10_wrist"', '"arm.urdf"', "arm.urdf"),
    "robot a number": ('"pa10_wrist"', "7", "robot: must be text"),
    "robot inline": ('"pa10_wrist"', '"<robot/>"', "a scene names its robot"),
    "format from the future": ("format = 1", "format = 2", "unknown format of a scene, written for a newer spacerobot"),
    "key unknown": ("base =", "bse =", "did you mean 'base'"),
    "key twice": ('base = "fixed"', 'base = "fixed"\nbase = "fixed"', "not TOML"),
    "no TOML": ("[wrist]", "[wrist", "not TOML"),
    "base unknown": ('"fixed"', '"fixd"', "did you mean 'fixed'"),
    "base free without a spacecraft": ('"fixed"', '"free"', "spacecraft"),
    "joints unknown": ('"locked"', '"lokced"', "did you mean 'locked'"),
    "joints servo without a servo": ('"locked"', '"servo"', "servo joints need a servo"),
    "servo without servo joints": ("[wrist]", "[servo]\nstiffness = 1e5\n[wrist]", "a servo needs servo joints"),
    "pose too short": ("[0, 45, 0, 90, 0, -45, 0]", "[0, 45]", "one for each of S1, S2"),
    "pose of words": ("[0, 45, 0, 90, 0, -45, 0]", '["a", 1, 2, 3, 4, 5, 6]', "not a number"),
    "pose with NaN": ("[0, 45, 0, 90, 0, -45, 0]", "[0, nan, 0, 90, 0, -45, 0]", "not a finite number"),
    "pose twice": ("approach", "pose = [0,0,0,0,0,0,0]\napproach", "pose and pose_deg are both given"),
    "approach no unit vector": ("approach = [1, 0, 0]", "approach = [1, 1, 0]", "approach"),
    "approach zero": ("approach = [1, 0, 0]", "approach = [0, 0, 0]", "approach"),
    "approach of two": ("approach = [1, 0, 0]", "approach = [1, 0]", "approach"),
    "gravity NaN": ("gravity = [0, 0, 0]", "gravity = [0, 0, nan]", "gravity"),
    "gravity text": ("gravity = [0, 0, 0]", 'gravity = "down"', "not a list of numbers"),
    "backend unknown": ('"reduced"', '"reducd"', "did you mean 'reduced'"),
    "duration negative": ("gravity", "duration = -1\ngravity", "duration: must be positive"),
    "duration too short to arrive": ("gravity", "duration = 0.01\ngravity", "never arrives"),
    "wrist mass negative": ("mass = 0.7", "mass = -0.7", "wrist.mass: must be positive"),
    "wrist mass zero": ("mass = 0.7", "mass = 0", "wrist.mass: must be positive"),
    "wrist stiffness negative": ("stiffness = 530", "stiffness = -530", "wrist.stiffness: must not be negative"),
    "wrist stiffness infinite": ("stiffness = 530", "stiffness = inf", "wrist.stiffness: not a finite number"),
    "wrist stiffness true": ("stiffness = 530", "stiffness = true", "wrist.stiffness: not a number"),
    "wrist damping NaN": ("damping = 1.4", "damping = nan", "wrist.damping: not a finite number"),
    "wrist key unknown": ("damping = 1.4", "dampin = 1.4", "did you mean 'damping'"),
    "wrist no table": ("[wrist]\nmass = 0.7\nstiffness = 530\ndamping = 1.4", "wrist = 3", "must be a table"),
    "contact stiffness zero": ("stiffness = 68000", "stiffness = 0", "contact.stiffness"),
    "contact law unknown": ("damping = 40", 'damping = 40\nlaw = "herz"', "did you mean 'hertz'"),
    "contact friction negative": ("damping = 40", "damping = 40\nmu = -0.1", "contact.mu"),
    "contact exponent zero": ("damping = 40", "damping = 40\nexponent = 0", "contact.exponent"),
    "target mass zero": ("mass = 9.0", "mass = 0", "target.mass"),
    "target mass a text": ("mass = 9.0", 'mass = "9 kg"', "target.mass: not a number"),
    "target leaves": ("speed = 0.07", "speed = -0.07", "never arrives"),
    "target at rest": ("speed = 0.07", "speed = 0", "never arrives"),
    "starts in penetration": ("gap = 0.01", "gap = -0.01", "penetration"),
    "target inertia impossible": ("gap = 0.01", "gap = 0.01\ninertia = [1, 1, 3]", "inertia"),
    "target inertia twice": ("gap = 0.01", "gap = 0.01\ninertia = [1, 1, 1]\nyaw_inertia = 1", "inertia"),
    "contact point of one": ("gap = 0.01", "gap = 0.01\ncontact_point = [1]", "contact_point"),
    "spin of words": ("gap = 0.01", 'gap = 0.01\nspin = ["x", 0, 0]', "spin"),
    "effect unknown": ('"coulomb_friction"', '"coulom_friction"', "did you mean 'coulomb_friction'"),
    "effect nowhere": ('where = "wrist"', 'where = "elbow"', "elbow"),
    "effect without where": ('where = "wrist"\n', "", "needs where = NAME"),
    "effect parameter unknown": ("force_N = 0.4", "froce_N = 0.4", "force_N"),
    "effect parameter missing": ("parameters = { force_N = 0.4 }", "", "force_N"),
    "effect parameter NaN": ("force_N = 0.4", "force_N = nan", "finite"),
    "effect parameter negative": ("force_N = 0.4", "force_N = -0.4", "force_N"),
    "effects no list": ("[[effects]]", "[effects]", "must be written as [[effects]]"),
    "control characters": ("format = 1", "format = 1\x00", "not TOML"),
}

STUDY = """format = 1
title = "bad"
[baseline]
robot = "pa10_wrist"
approach = [1, 0, 0]
gravity = [0, 0, 0]
[baseline.wrist]
mass = 0.7
stiffness = 530
[baseline.contact]
stiffness = 68000
[baseline.sigma]
"wrist.stiffness" = 0.01
[streams.mocap]
time = "t"
[streams.mocap.channels]
x = { is = "target.x", sigma = 1e-4 }
w = { is = "wrist.x", sigma = 1e-4, unit = "m" }
[[trials]]
id = "01"
target.mass = 9.0
mocap = "01.csv"
"""

CSV = "t,x,w\n" + "\n".join(f"{0.01 * i:.2f},{-0.02 + 0.001 * i:.4f},0.0" for i in range(60)) + "\n"

STUDIES = {
    "format from the future": ("format = 1", "format = 9", "unknown format of a study, written for a newer spacerobot"),
    "key unknown": ("gravity =", "gravty =", "did you mean 'gravity'"),
    "no TOML": ("[baseline]", "[baseline", "line 3"),
    "no baseline": ('robot = "pa10_wrist"\n', "", "names no robot"),
    "approach too long": ("approach = [1, 0, 0]", "approach = [1, 1, 0]", "approach must be a unit vector"),
    "gravity of two": ("gravity = [0, 0, 0]", "gravity = [0, 0]", "gravity"),
    "base unknown": ("gravity", 'base = "fixd"\ngravity', "did you mean 'fixed'"),
    "joints servo on a rig": ("gravity", 'joints = "servo"\ngravity', "servos"),
    "wrist mass negative": ("mass = 0.7", "mass = -0.7", "wrist.mass must be above 0"),
    "wrist stiffness text": ("stiffness = 530", 'stiffness = "soft"', "study.toml:9: 'stiffness' must be a number"),
    "wrist key unknown": ("stiffness = 530", "stifness = 530", "did you mean"),
    "contact stiffness NaN": ("stiffness = 68000", "stiffness = nan", "study.toml:11: 'stiffness' must be finite"),
    "contact law unknown": ("stiffness = 68000", 'stiffness = 68000\nlaw = "herz"', "did you mean 'hertz'"),
    "sigma negative": ('"wrist.stiffness" = 0.01', '"wrist.stiffness" = -0.01', "must not be negative"),
    "sigma of nothing": ('"wrist.stiffness" = 0.01', '"wrist.stifness" = 0.01', "did you mean"),
    "stream without channels": (
        'x = { is = "target.x", sigma = 1e-4 }\nw = { is = "wrist.x", sigma = 1e-4, unit = "m" }\n',
        "",
        "channel",
    ),
    "channel unknown": ('"wrist.x"', '"wirst.x"', "did you mean"),
    "channel twice": ('"wrist.x"', '"target.x"', "target.x"),
    "unit unknown": ('unit = "m"', 'unit = "metre"', "unit"),
    "unit of something else": ('unit = "m"', 'unit = "N"', "unit"),
    "noise negative": ('"target.x", sigma = 1e-4', '"target.x", sigma = -1e-4', "sigma"),
    "column missing": ("x = {", "xx = {", "xx"),
    "time column missing": ('time = "t"', 'time = "time"', "time"),
    "stream name taken": ("[streams.mocap", "[streams.id", "cannot have this name"),
    "no trials": ('[[trials]]\nid = "01"\ntarget.mass = 9.0\nmocap = "01.csv"\n', "", "no trials"),
    "trial without files": ('mocap = "01.csv"\n', "", "01"),
    "trial twice": ('mocap = "01.csv"\n', 'mocap = "01.csv"\n[[trials]]\nid = "01"\nmocap = "01.csv"\n', "same id"),
    "trial key unknown": ("target.mass", "target.mas", "did you mean"),
    "trial mass zero": ("target.mass = 9.0", "target.mass = 0.0", "target.mass"),
    "trial mass of nothing": ("target.mass = 9.0", "target.mass = 1e-100", "target.mass is out of range"),
    "trial file missing": ("01.csv", "02.csv", "02.csv"),
    "trial file outside": ("01.csv", "../../etc/passwd", "leaves the data folder"),
    "data elsewhere": ('title = "bad"', 'data = "${HOME}/x"', "data"),
    "data missing": ('title = "bad"', 'data = "nothing"', "no such folder"),
    "empty window": ('id = "01"', 'id = "01"\nwindow = [50, 60]', "window"),
    "window backwards": ('id = "01"', 'id = "01"\nwindow = [6, 5]', "window"),
}

RECORDINGS = {
    "empty": "",
    "header only": "t,x,w\n",
    "ragged": CSV + "0.7,1\n",
    "words": CSV + "0.7,hello,0\n",
    "clock backwards": CSV + "0.01,1,0\n",
    "clock stands still": CSV + "0.59,1,0\n",
    "never a reading": CSV.replace(",0.0\n", ",\n"),
    "binary": "\x00\x01\x02\x03" * 50,
}

URDF = """<?xml version="1.0"?>
<robot name="good">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="2"/></joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/></joint>
</robot>
"""

URDFS = {
    "mass negative": ('mass value="2"', 'mass value="-2"', "link 'arm'"),
    "mass NaN": ('mass value="2"', 'mass value="nan"', "link 'arm'"),
    "mass a word": ('mass value="2"', 'mass value="two"', "link 'arm'"),
    "inertia not positive": ('ixx="0.1"', 'ixx="-0.1"', "arm"),
    "inertia breaks the triangle": ('izz="0.02"', 'izz="0.5"', "arm"),
    "inertia missing": ('ixx="0.1" ', "", "ixx"),
    "parent unknown": ('parent link="base"', 'parent link="bse"', "bse"),
    "child unknown": ('child link="tip"', 'child link="tp"', "tp"),
    "link twice": ('<link name="tip"/>', '<link name="tip"/><link name="tip"/>', "tip"),
    "joint twice": ('joint name="end"', 'joint name="turn"', "turn"),
    "joint of no type": ('type="revolute"', 'type="revolve"', "revolve"),
    "axis zero": ('axis xyz="0 1 0"', 'axis xyz="0 0 0"', "axis"),
    "axis of two": ('axis xyz="0 1 0"', 'axis xyz="0 1"', "axis"),
    "origin of words": ('xyz="0 0 0.5"', 'xyz="a b c"', "turn"),
    "limits crossed": ('lower="-1" upper="1"', 'lower="1" upper="-1"', "turn"),
    "a loop": ('<parent link="arm"/><child link="tip"/>', '<parent link="arm"/><child link="base"/>', "loop"),
    "no XML": ("</robot>", "", "XML"),
    "an external entity": ("<robot", '<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot', "DOCTYPE"),
    "not a robot": ('<robot name="good">', '<sdf name="good">', "XML"),
    "mesh outside": (
        '<link name="tip"/>',
        '<link name="tip"><visual><geometry><mesh filename="../../x.stl"/></geometry></visual></link>',
        "mesh",
    ),
}

ARGUMENTS = {
    "no command": ([], "COMMAND"),
    "command unknown": (["mas"], "did you mean 'mass'"),
    "option unknown": (["mass", "pa10", "--dierction", "1", "0", "0"], "did you mean '--direction'"),
    "option without value": (["mass", "pa10", "--frame"], "--frame"),
    "robot unknown": (["mass", "pa11"], "did you mean 'pa10'"),
    "robot nowhere": (["mass", "/nowhere/arm.urdf"], "/nowhere/arm.urdf"),
    "robot a folder": (["mass", "/"], "/"),
    "robot with a null": (["mass", "pa\x0010"], "pa?10"),
    "frame unknown": (["mass", "pa10_wrist", "--frame", "wrist_mont"], "did you mean 'wrist_mount'"),
    "joint unknown": (["mass", "panda", "--set", "panda_finger_joint9=0.1"], "did you mean"),
    "q too short": (["mass", "pa10", "--q", "0", "45"], "7 numbers, one each for S1"),
    "q of words": (["mass", "pa10", "--q", "a"], "not a number"),
    "q NaN": (["mass", "pa10", "--q", "nan", "0", "0", "0", "0", "0", "0"], "not a finite number"),
    "direction not of length 1": (["mass", "pa10", "--direction", "1", "1", "0"], "length 1"),
    "direction zero": (["mass", "pa10", "--direction", "0", "0", "0"], "direction"),
    "base unknown": (["mass", "pa10", "--base", "floating"], "floating"),
    "joints unknown": (["mass", "pa10", "--joints", "loked"], "valid: free or locked or servo"),
    "servo without stiffness": (["mass", "pa10", "--joints", "servo"], "stiffness"),
    "servo stiffness negative": (["mass", "pa10", "--joints", "servo", "--servo-stiffness", "-5"], "negative"),
    "target mass negative": (["mass", "pa10", "--target-mass", "-9"], "must be positive"),
    "restitution above 1": (["mass", "pa10", "--target-mass", "9", "--restitution", "1.5"], "between 0 and 1"),
    "paper without a folder": (["paper"], "--out"),
    "paper damping": (["paper", "--out", "OUT", "--equivalent-damping", "-1"], "out of range"),
    "paper seed": (["paper", "--out", "OUT", "--seed", "1.5"], "not a seed"),
    "study unknown": (["study", "check", "guide-frction"], "did you mean 'guide-friction'"),
    "study nowhere": (["study", "check", "/nowhere"], "no such study"),
    "study action": (["study", "chck", "guide-friction"], "did you mean 'check'"),
    "study of no folder": (["study", "new", "/nowhere"], "/nowhere"),
    "overlay of nothing": (["overlay"], "STUDY"),
    "overlay trial": (["overlay", "guide-friction", "--trials", "13"], "unknown trial"),
    "overlay data": (["overlay", "guide-friction", "--data", "/nowhere"], "data folder"),
    "simulate mass": (["simulate", "pa10_wrist", "--target-mass", "-9"], "target.mass"),
    "simulate speed": (["simulate", "pa10_wrist", "--speed", "0"], "never arrives"),
    "simulate gap": (["simulate", "pa10_wrist", "--gap", "-0.1"], "penetration"),
    "simulate effect": (["simulate", "pa10_wrist", "--effect", "friction"], "NAME@WHERE"),
    "simulate scene": (["simulate", "nowhere.toml"], "no such scene"),
    "simulate tolerance": (["simulate", "pa10_wrist", "--tolerance", "2"], "tolerance"),
    "simulate rate": (["simulate", "pa10_wrist", "--rate", "-1"], "rate"),
}


def refused(arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command answers bad input as it promises."""
    before = sorted(tmp_path.rglob("*"))
    assert main(arguments) == 2
    captured = capsys.readouterr()
    error = captured.err
    assert message in error
    assert error.endswith("\n")
    assert error.count("\n") == 1, "one line"
    assert error.startswith("spacerobot"), "who says it"
    assert len(error) < 1500, "short enough to read"
    assert error.removesuffix("\n").isprintable(), "nothing that a terminal would obey"
    assert captured.out == ""
    assert sorted(tmp_path.rglob("*")) == before, "nothing is written"


def edited(text: str, edit: tuple[str, str, str]) -> str:
    old, new, _ = edit
    assert text.count(old) >= 1
    return text.replace(old, new)


def test_the_good_ones_are_good(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "01.csv").write_text(CSV)
    (tmp_path / "arm.urdf").write_text(URDF)
    assert main(["simulate", str(tmp_path / "scene.toml")]) == 0
    assert main(["overlay", str(tmp_path)]) == 0
    assert main(["mass", str(tmp_path / "arm.urdf")]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("name", SCENES)
def test_scene(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(edited(SCENE, SCENES[name]))
    refused(["simulate", str(path), "--out", str(tmp_path / "out")], SCENES[name][2], tmp_path, capsys)


@pytest.mark.parametrize("name", STUDIES)
def test_study(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "01.csv").write_text(CSV)
    (tmp_path / "study.toml").write_text(edited(STUDY, STUDIES[name]))
    refused(["overlay", str(tmp_path), "--out", str(tmp_path / "out")], STUDIES[name][2], tmp_path, capsys)


@pytest.mark.parametrize("name", RECORDINGS)
def test_recording(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "01.csv").write_text(RECORDINGS[name])
    (tmp_path / "study.toml").write_text(STUDY)
    refused(["overlay", str(tmp_path), "--out", str(tmp_path / "out")], "01.csv", tmp_path, capsys)


@pytest.mark.parametrize("name", URDFS)
def test_urdf(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(edited(URDF, URDFS[name]))
    refused(["mass", str(path), "--out", str(tmp_path / "out")], URDFS[name][2], tmp_path, capsys)


@pytest.mark.parametrize("name", ARGUMENTS)
def test_arguments(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments, message = ARGUMENTS[name]
    out = str(tmp_path / "out")
    takes_out = arguments and arguments[0] in ("mass", "simulate", "overlay") and "--out" not in arguments
    arguments = [a.replace("OUT", out) for a in arguments] + (["--out", out] if takes_out else [])
    if name in ("option without value", "overlay of nothing"):
        arguments = [a for a in arguments if a not in ("--out", out)]
    refused(arguments, message, tmp_path, capsys)


@pytest.mark.parametrize("value", ["nan", "-inf", "1e308", "1e-308", "1" + "0" * 400, '""', "[]", "[1e300, 0, 0]"])
def test_any_value_gets_an_answer(value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every key in turn takes the odd value: an answer, or one line; never an unforeseen error."""
    (tmp_path / "01.csv").write_text(CSV)
    for text, file, command in ((SCENE, "scene.toml", "simulate"), (STUDY, "study.toml", "overlay")):
        lines = text.splitlines()
        for number, line in enumerate(lines):
            key, equals, _ = line.partition(" = ")
            if not equals:
                continue
            (tmp_path / file).write_text("\n".join([*lines[:number], f"{key} = {value}", *lines[number + 1 :]]))
            code = main([command, str(tmp_path / file)])
            captured = capsys.readouterr()
            assert code in (0, 2), f"{key} = {value}: {captured.err}"
            assert captured.err.count("\n") == (1 if code else 0), f"{key} = {value}: {captured.err}"


def test_there_are_at_least_a_hundred() -> None:
    assert len(SCENES) + len(STUDIES) + len(RECORDINGS) + len(URDFS) + len(ARGUMENTS) >= 100
