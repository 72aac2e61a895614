"""`study check` shows each channel's range beside what the baseline expects: a wrong unit shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.recordings.check import check_study
from spacerobot.recordings.ranges import Limits, _reach
from spacerobot.recordings.study import load_study

RIG = """format = 1
[baseline]
robot = "pa10_wrist"
wrist.mass = 0.8
wrist.stiffness = 800
contact.stiffness = 6e4
target.mass = 12.5
[streams.log]
time = 0
[streams.log.channels]
1 = {{ is = "target.x", sigma = 1e-4, unit = "{unit}" }}
2 = {{ is = "wrist.x", sigma = 1e-4, unit = "{unit}", scale = {scale} }}
[[trials]]
id = "01"
log = "log.csv"
[[trials]]
id = "02"
log = "log.csv"
"""

ARM = """format = 1
[baseline]
robot = "pa10"
[streams.log]
time = 0
[streams.log.channels]
1 = { is = "joint.S1.position" }
[[trials]]
id = "01"
log = "log.csv"
"""


def rig(folder: Path, unit: str, scale: float = 1.0) -> list[str]:
    t = np.arange(0, 2, 0.01)
    pushed = np.where(t > 1, 6.25 * np.sin(np.clip(8 * (t - 1), 0, np.pi)), 0)  # mm, of 50 mm/s
    noise = np.random.default_rng(1).normal(0, 0.1, (2, len(t)))
    np.savetxt(folder / "log.csv", np.column_stack([t, 50 * (t - 1) + noise[0], pushed + noise[1]]), "%.5f", ",")
    (folder / "study.toml").write_text(RIG.format(unit=unit, scale=scale))
    return check_study(load_study(folder))["warnings"]


def test_a_wrist_that_moves_as_believed_is_not_remarked_upon(tmp_path: Path) -> None:
    assert not [w for w in rig(tmp_path, "mm") if "unit right" in w]


def test_millimetres_for_metres_show_with_both_numbers(tmp_path: Path) -> None:
    (found,) = (w for w in rig(tmp_path, "mm", 1000.0) if "unit right" in w)
    assert "reaches 6." in found
    assert "0.0062" in found


@pytest.mark.parametrize(("zero", "odd"), [(0.0, True), (3.0, False)])
def test_limits_are_counted_from_the_encoders_zero(tmp_path: Path, zero: float, odd: bool) -> None:
    t = np.arange(0, 1, 0.01)
    np.savetxt(tmp_path / "log.csv", np.column_stack([t, 4.0 + np.sin(t)]), "%.5f", ",")
    text = ARM.replace("[streams", f"[baseline.joint.S1]\nzero = {zero}\n[streams", 1)
    (tmp_path / "study.toml").write_text(text)
    warnings = check_study(load_study(tmp_path), {"S1": Limits(-3, 3)})["warnings"]
    assert any("its URDF allows" in w for w in warnings) == odd


@pytest.mark.parametrize(("size", "odd"), [(1.0, False), (57.3, True)])
def test_joints_are_held_against_their_limits(tmp_path: Path, size: float, odd: bool) -> None:
    t = np.arange(0, 1, 0.01)
    np.savetxt(tmp_path / "log.csv", np.column_stack([t, size * np.sin(t)]), "%.5f", ",")
    (tmp_path / "study.toml").write_text(ARM)
    warnings = check_study(load_study(tmp_path), {"S1": Limits(-3, 3)})["warnings"]
    assert any("its URDF allows -3 to 3 rad" in w for w in warnings) == odd
    assert any("no joint S1" in w for w in check_study(load_study(tmp_path), {"S2": Limits()})["warnings"])


def test_a_joint_that_slides_is_in_metres(tmp_path: Path) -> None:
    t = np.arange(0, 1, 0.01)
    np.savetxt(tmp_path / "log.csv", np.column_stack([t, np.sin(t)]), "%.5f", ",")
    (tmp_path / "study.toml").write_text(ARM)
    study = load_study(tmp_path)
    units = {s: check_study(study, {"S1": Limits(-3, 3, slides=s)})["ranges"][0]["unit"] for s in (True, False)}
    assert units == {True: "m", False: "rad"}


def test_what_is_stated_and_read_by_no_model_is_told(tmp_path: Path) -> None:
    t = np.arange(0, 1, 0.01)
    np.savetxt(tmp_path / "log.csv", np.column_stack([t, np.sin(t)]), "%.5f", ",")
    text = ARM.replace('robot = "pa10"\n', 'robot = "pa10"\njoint.S1.kp = 3.0\njoint.S1.gain = 2.0\n')
    (tmp_path / "study.toml").write_text(text)
    (said,) = (w for w in check_study(load_study(tmp_path))["warnings"] if "no model reads" in w)
    assert "joint.S1.kp" in said
    assert "gain" not in said


def test_the_table_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig(tmp_path, "mm")
    assert main(["study", "check", str(tmp_path)]) == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if x.startswith("wrist.x"))
    assert "up to 0.0062" in line
    assert " 100 " in line


@pytest.mark.parametrize("mass", [0.2, 9.0])
def test_what_a_target_is_expected_to_push_is_the_closed_form(mass: float) -> None:
    """A mass against a spring gives v sqrt(m / k), against a slider through a spring v sqrt(k m m_w / (m + m_w))."""
    values = {"target.mass": mass, "wrist.stiffness": 500.0, "wrist.mass": 0.7, "contact.stiffness": 6e4}
    pushed, force = _reach(values, 0.1)
    assert 500.0 * pushed**2 == pytest.approx(mass * 0.1**2), "all the energy in the wrist's spring"
    shared = 0.5 * mass * 0.1**2 - 0.5 * (mass * 0.1) ** 2 / (mass + 0.7)
    assert 0.5 * force**2 / 6e4 == pytest.approx(shared), "in the contact's, what the common motion does not keep"
