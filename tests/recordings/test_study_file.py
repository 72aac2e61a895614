"""The study file: what it means, and what it refuses with which line."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from helpers_recordings import HEAD, STREAM, TRIAL, write_study

from spacerobot.recordings.baseline import DEFAULT_POSE
from spacerobot.recordings.document import scan_lines
from spacerobot.recordings.study import Study, bundled_studies, load_study
from spacerobot.support.errors import InputError, NotFoundError


def load(folder: Path, text: str) -> Study:
    return load_study(write_study(folder, text))


def test_bundled_study_loads_by_name() -> None:
    study = load_study("guide-friction")
    assert "guide-friction" in bundled_studies()
    assert len(study.trials) == 12
    assert list(study.conditions()) == [f"target.mass={m}" for m in ("9", "23.2", "35.7", "63.2")]
    assert study.value("wrist.stiffness", "01") == 530.0
    assert study.value("target.mass") is None
    assert study.value("target.mass", "12") == 63.2
    assert study.trial("01").overrides == {"target.mass": 9.0}
    assert study.sigma["wrist.stiffness"] == 0.01
    assert study.scatter["wrist.stiffness"] == 0.003
    assert study.sigma_of("wrist.damping") == study.sigma["wrist.equivalent_damping"]
    assert study.pose() == DEFAULT_POSE
    assert study.channels() == ("target.x", "wrist.x", "contact.force")


def test_folder_file_and_name_are_the_same_study(tmp_path: Path) -> None:
    folder = write_study(tmp_path)
    assert load_study(folder) == load_study(folder / "study.toml")


def test_nested_and_quoted_dotted_keys_mean_the_same(tmp_path: Path) -> None:
    nested = load(tmp_path, HEAD + STREAM + TRIAL)
    quoted = load(
        tmp_path,
        'format = 1\ntitle = "A small study"\n[baseline]\nrobot = "pa10_wrist"\napproach = [1, 0, 0]\n'
        '"wrist.mass" = 0.7\nwrist.stiffness = 1000\n' + STREAM + TRIAL.replace("target.mass", '"target.mass"'),
    )
    assert quoted.baseline == nested.baseline
    assert quoted.trials[0].overrides == nested.trials[0].overrides


def test_sigma_may_be_nested_too(tmp_path: Path) -> None:
    study = load(tmp_path, HEAD + "[baseline.sigma]\nwrist.mass = 0.01\n" + STREAM + TRIAL)
    assert study.sigma == {"wrist.mass": 0.01}


def test_vectors_are_addressed_by_component(tmp_path: Path) -> None:
    study = load(tmp_path, HEAD + "[baseline.target]\ncontact_point = [0.15, -0.01]\n" + STREAM + TRIAL)
    assert study.value("target.contact_point.ahead") == 0.15
    assert study.value("target.contact_point.lateral", "01") == -0.01


def test_joints_and_bodies_of_other_robots(tmp_path: Path) -> None:
    text = HEAD + (
        '[baseline.joint.axis]\nmass = "unknown"\ndamping = 0.5\n[baseline.body]\nmass = 2\ninertia = [1, 2, 3]\n'
    )
    study = load(tmp_path, text + STREAM + TRIAL)
    assert study.value("joint.axis.mass") is None
    assert study.baseline.unknown == {"joint.axis.mass"}
    assert study.value("joint.axis.damping") == 0.5
    assert study.value("body.inertia.z") == 3.0


def test_condition_is_the_target_mass_unless_stated(tmp_path: Path) -> None:
    text = HEAD + STREAM + TRIAL + TRIAL.replace("01", "02", 1).replace("target.mass = 9.0", 'condition = "fast"')
    study = load(tmp_path, text)
    assert [study.condition(t) for t in study.trials] == ["target.mass=9", "fast"]


def test_each_writes_many_trials(tmp_path: Path) -> None:
    trial = '[[trials]]\neach = [8, 11]\nid = "toss_{n:03d}"\nmocap = { file = "01.csv", variable = "x{n}" }\n'
    study = load(tmp_path, HEAD + STREAM + trial)
    assert [t.id for t in study.trials] == ["toss_008", "toss_009", "toss_010", "toss_011"]
    assert study.trials[2].sources["mocap"].variable == "x10"


def test_pose_in_degrees(tmp_path: Path) -> None:
    study = load(tmp_path, HEAD.replace("approach", "pose_deg = [90, 45]\napproach") + STREAM + TRIAL)
    assert study.pose() == pytest.approx((math.pi / 2, math.pi / 4))


ERRORS = [
    ("wrist.stiffnes", HEAD + "stiffnes = 5\n" + STREAM + TRIAL, 11, "did you mean 'wrist.stiffness'"),
    ("top key", "titel = 1\n" + HEAD + STREAM + TRIAL, 1, "did you mean 'title'"),
    ("baseline key", HEAD.replace("robot", "robto") + STREAM + TRIAL, 5, "did you mean 'robot'"),
    ("stream key", HEAD + STREAM.replace("time", "tiem") + TRIAL, 13, "did you mean 'time'"),
    ("channel key", HEAD + STREAM.replace("sigma", "sgima") + TRIAL, 15, "did you mean 'sigma'"),
    ("channel", HEAD + STREAM.replace("target.x", "traget.x") + TRIAL, 15, "did you mean 'target.x'"),
    ("unit", HEAD + STREAM.replace("1e-4", '1e-4, unit = "kN"') + TRIAL, 15, "cannot measure length"),
    ("trial key", HEAD + STREAM + TRIAL.replace("mocap =", "mocpa ="), 20, "did you mean 'mocap'"),
    ("override", HEAD + STREAM + TRIAL.replace("target.mass", "target.mas"), 19, "did you mean 'target.mass'"),
    ("negative mass", HEAD.replace("0.7", "-0.7") + STREAM + TRIAL, 9, "above 0 kg"),
    ("negative stiffness", HEAD.replace("1000", "-1") + STREAM + TRIAL, 10, "at least 0 N/m"),
    ("not a number", HEAD.replace("0.7", "nan") + STREAM + TRIAL, 9, "finite"),
    ("text for a number", HEAD.replace("0.7", '"heavy"') + STREAM + TRIAL, 9, "must be a number"),
    ("true for a number", HEAD.replace("0.7", "true") + STREAM + TRIAL, 9, "must be a number"),
    ("approach", HEAD.replace("[1, 0, 0]", "[1, 1, 0]") + STREAM + TRIAL, 6, "unit vector"),
    ("gravity", HEAD.replace("approach = [1, 0, 0]", "gravity = [0, 0]") + STREAM + TRIAL, 6, "3 numbers"),
    ("base", HEAD.replace("approach = [1, 0, 0]", 'base = "fixd"') + STREAM + TRIAL, 6, "did you mean 'fixed'"),
    ("pose in degrees", HEAD.replace("approach = [1, 0, 0]", "pose = [0, 90]") + STREAM + TRIAL, 6, "pose_deg"),
    ("law", HEAD + '[baseline.contact]\nlaw = "herz"\n' + STREAM + TRIAL, 12, "did you mean 'hertz'"),
    ("sigma", HEAD + '[baseline.sigma]\n"wrist.mas" = 1\n' + STREAM + TRIAL, 12, "did you mean 'wrist.mass'"),
    ("negative sigma", HEAD + '[baseline.sigma]\n"wrist.mass" = -1\n' + STREAM + TRIAL, 12, "not be negative"),
    ("sensor sigma", HEAD + STREAM.replace("1e-4", "0") + TRIAL, 15, "must be positive"),
    ("one id twice", HEAD + STREAM + TRIAL + TRIAL, 22, "same id"),
    ("no time", HEAD + STREAM.replace('time = "t"', "") + TRIAL, 12, "needs its times"),
    ("huge whole number", HEAD.replace("0.7", "1" + "0" * 400) + STREAM + TRIAL, 9, "finite"),
    ("format", HEAD.replace("format = 1", "format = 2") + STREAM + TRIAL, 1, "format"),
    ("inline URDF", HEAD.replace('"pa10_wrist"', '"<robot/>"') + STREAM + TRIAL, 5, "URDF path"),
    ("broken TOML", HEAD + "[baseline\n", 11, "not valid TOML"),
]


@pytest.mark.parametrize(("text", "line", "message"), [e[1:] for e in ERRORS], ids=[e[0] for e in ERRORS])
def test_what_is_wrong_is_named_with_its_line(tmp_path: Path, text: str, line: int, message: str) -> None:
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert message in str(caught.value)
    assert f"study.toml:{line}:" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + STREAM, "no trials"),
        (HEAD + TRIAL, "no streams"),
        (HEAD + STREAM + "[trials]\nid = 1\n", r"\[\[trials\]\]"),
        (HEAD + STREAM.replace("mocap", "wrist") + TRIAL, "cannot have this name"),
        ("[baseline]\n" + STREAM + TRIAL, "names no robot"),
        (HEAD + '"wrist.mass" = 3\n' + STREAM + TRIAL, "unknown value"),
    ],
)
def test_what_is_missing_is_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(tmp_path, text)


def test_one_value_written_nested_and_dotted_is_refused(tmp_path: Path) -> None:
    text = HEAD.replace("approach", '"wrist.mass" = 3\napproach') + STREAM + TRIAL
    with pytest.raises(InputError, match="written twice"):
        load(tmp_path, text)


def test_byte_order_mark_and_crlf_are_fine(tmp_path: Path) -> None:
    text = HEAD + STREAM + TRIAL
    write_study(tmp_path)
    (tmp_path / "study.toml").write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_study(tmp_path).value("wrist.mass") == 0.7


def test_other_encodings_are_refused_with_the_line(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_bytes(b'format = 1\ntitle = "\xff"\n')
    with pytest.raises(InputError, match=r"study\.toml:2: a study must be UTF-8"):
        load_study(tmp_path)


def test_unknown_study_lists_the_bundled_ones() -> None:
    with pytest.raises(NotFoundError, match="did you mean 'guide-friction'"):
        load_study("guide-frcition")


def test_lines_are_found_in_arrays_of_tables() -> None:
    lines = scan_lines('[[trials]]\nid = "a"\n\n[[trials]]\nid = "b"\ntarget.mass = 1\n[trials.wrist]\nmass = 2\n')
    assert lines["trials.1.id"] == 5
    assert lines["trials.1.target.mass"] == 6
    assert lines["trials.1.wrist.mass"] == 8


def test_the_hash_tells_where_one_file_ends_and_the_next_begins(tmp_path: Path) -> None:
    """The same bytes in all, dealt to the files in another way, or under other names, are other inputs."""
    text = HEAD + STREAM + TRIAL + TRIAL.replace("01", "02")
    found = set()
    for number, (one, other) in enumerate(
        [("t,x\n0,1\n", "t,x\n0,2\n"), ("t,x\n0,2\n", "t,x\n0,1\n"), ("t,x\n0,1\nt", ",x\n0,2\n")]
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        write_study(folder, text, one)
        (folder / "02.csv").write_text(other)
        found.add(load_study(folder).input_hash)
    assert len(found) == 3
