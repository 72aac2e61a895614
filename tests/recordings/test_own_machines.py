"""A folder of one joint or one ball: its own URDF is the machine, and what falls freely says in which unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.recordings.draft import draft
from spacerobot.recordings.study import load_study

URDF = """<robot name="mine"><link name="frame"/>
<link name="moving"><inertial><origin xyz="0 0 {below}"/><mass value="2.5"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{name}" type="{kind}"><parent link="frame"/><child link="moving"/><axis xyz="0 1 0"/>
<limit lower="-100" upper="100" effort="1e5" velocity="1e4"/></joint></robot>"""


def written(folder: Path, columns: dict[str, np.ndarray], name: str = "run") -> None:
    table = np.column_stack(list(columns.values()))
    np.savetxt(folder / f"{name}.csv", table, delimiter=",", header=",".join(columns), comments="", fmt="%.9g")


def drafted(folder: Path) -> str:
    """The study that a folder's draft is once its line is deleted; it can be loaded."""
    made = draft(folder)
    for name, text in made.files.items():
        (folder / name).write_text(text)
    text = "\n".join(line for line in made.text().splitlines() if not line.startswith("draft"))
    (folder / "study.toml").write_text(text)
    load_study(folder)
    return text


def test_an_axis_is_the_joint_of_the_urdf_beside_it(tmp_path: Path) -> None:
    (tmp_path / "mine.urdf").write_text(URDF.format(name="lift_stage", kind="prismatic", below=-0.3))
    time, random = np.arange(0.0, 3.0, 0.002), np.random.default_rng(1)
    place = 0.2 * np.sin(3.0 * time) + 1e-5 * random.standard_normal(time.size)
    written(tmp_path, {"t": time, "q": place, "f": -4.5 * np.sin(3.0 * time)})
    text = drafted(tmp_path)
    assert 'robot = "mine.urdf"' in text
    assert '"q" = { is = "joint.lift_stage.position" }' in text
    assert '"f" = { is = "joint.lift_stage.torque", use = "input" }' in text
    assert 'mass = "unknown"' not in text  # the URDF says it
    assert not (tmp_path / "axis.urdf").exists()


@pytest.mark.parametrize("hangs", [True, False])
def test_what_swings_on_a_joint_that_turns_is_a_pendulum(hangs: bool, tmp_path: Path) -> None:
    """Three periods, of an angle that states no unit; the URDF's zero may be where it stands on its head."""
    (tmp_path / "mine.urdf").write_text(URDF.format(name="hinge", kind="revolute", below=-0.3 if hangs else 0.3))
    random = np.random.default_rng(2)
    for n in range(2):
        time = np.arange(0.0, 7.0, 0.01)
        path = solve_ivp(
            lambda _, s: [s[1], -30.0 * np.sin(s[0]) - 0.1 * s[1]], (0.0, 7.0), [1.0 - 0.2 * n, 0.0], t_eval=time
        )
        written(tmp_path, {"t": time, "q": path.y[0] + 1e-3 * random.standard_normal(time.size)}, f"run{n}")
    text = drafted(tmp_path)
    assert "torque = 0" in text
    assert 'robot = "mine.urdf"' in text
    assert "# ?" not in text
    study = load_study(tmp_path)
    place = study.recording(study.trials[0])["joint.hinge.position"].value
    assert abs(0.5 * (place.max() + place.min())) == pytest.approx(0.0 if hangs else np.pi, abs=0.1)


@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("cm", 100.0), ("mm", 1000.0)])
def test_a_fall_tells_its_unit(unit: str, factor: float, tmp_path: Path) -> None:
    time, random = np.arange(0.0, 1.6, 1.0 / 120.0), np.random.default_rng(3)
    for n in range(3):
        path = np.stack([9.0 * time, (1.0 + n) * time, 1.5 + 8.0 * time - 0.5 * 9.8 * time**2])
        spins = {f"w{a}": 20.0 + n + 0.3 * random.standard_normal(time.size) for a in "xyz"}
        places = {a: factor * (p + 1e-3 * random.standard_normal(time.size)) for a, p in zip("xyz", path, strict=True)}
        written(tmp_path, {"t": time, **places, **spins}, f"throw{n}")
    text = drafted(tmp_path)
    stated = "" if unit == "m" else f', unit = "{unit}"'
    assert f'"z" = {{ is = "body.position.z"{stated} }}' in text
    assert '"wx" = { is = "body.angular_velocity.x" }' in text
    assert '"wz" = { is = "body.velocity.yaw" }' in text
    assert "pixels" not in text


def test_what_only_glides_says_nothing_of_its_unit(tmp_path: Path) -> None:
    time, random = np.arange(0.0, 4.0, 0.01), np.random.default_rng(4)
    for n in range(2):
        places = {a: (30.0 + 9.0 * n) * time + 0.01 * random.standard_normal(time.size) for a in "xyz"}
        written(tmp_path, {"t": time, **places}, f"run{n}")
    assert "mm, cm, or pixels" in draft(tmp_path).text()
