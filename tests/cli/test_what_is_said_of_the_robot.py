"""What a scene does with a robot besides moving its arm, in the words and numbers of `mass`, `simulate` and `sweep`."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.cli.main import main
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.model.describe import held_words, other_joints
from spacerobot.model.library import load
from spacerobot.simulation.multibody.assembly import TARGET, assemble_bodies
from spacerobot.simulation.parts import Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


UNIT = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@settings(max_examples=12, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from([("pa10_wrist", "free"), ("chaser_pa10_wrist", "free"), ("chaser_pa10_wrist", "locked")]),
    st.lists(st.floats(-1.4, 1.4), min_size=7, max_size=7),
    UNIT,
)
def test_mass_and_simulate_have_one_hand(
    capsys: pytest.CaptureFixture[str], which: tuple[str, str], pose: list[float], direction: tuple[float, ...]
) -> None:
    """With the wrist aimed alike; and where it is not, `mass` says what `simulate` has."""
    robot, joints = which
    along = np.array(direction) / np.linalg.norm(direction)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoseLimitWarning)
        scene = Scene(robot, joints=joints, pose=tuple(pose), approach=tuple(along.tolist()))
    given_ = ["mass", robot, "--q", *map(repr, pose), "--direction", *map(repr, along.tolist()), "--joints", joints]
    aimed, plain = answer(capsys, *given_, "--aim"), answer(capsys, *given_)
    assert aimed["aimed"]
    assert not plain["aimed"]
    assert aimed["effective_mass_kg"] == pytest.approx(scene.hand.mass, rel=1e-9)
    assert plain["aimed_effective_mass_kg"] == pytest.approx(scene.hand.mass, rel=1e-9)
    said = [n for n in plain["notes"] if f"`simulate` has {scene.hand.mass:.6g} kg" in n]
    differs = not math.isclose(plain["effective_mass_kg"], scene.hand.mass, rel_tol=1e-9)
    assert bool(said) == differs
    assert any("--aim" in n for n in scene.notes)


def test_the_two_numbers_of_the_readme_s_pose(capsys: pytest.CaptureFixture[str]) -> None:
    q = ["--q", "0", "45", "0", "90", "0", "-45", "0", "--deg"]
    assert answer(capsys, "mass", "pa10_wrist", *q)["effective_mass_kg"] == pytest.approx(7.841, abs=5e-4)
    turned = answer(capsys, "mass", "pa10_wrist", *q, "--aim")["effective_mass_kg"]
    asked = ["simulate", "pa10_wrist", *q, "--joints", "free", "--backend", "reduced", "--duration", "0.2"]
    hit = answer(capsys, *asked, "--approach", "1", "0", "0")
    assert hit["hand"]["effective_mass_kg"] == pytest.approx(turned, rel=1e-12)
    assert turned == pytest.approx(7.815, abs=5e-4)
    assert any("mass --aim" in n for n in hit["notes"])
    along = answer(capsys, *asked)  # along the hand nothing is turned, and `mass` has the very mass
    assert along["hand"]["effective_mass_kg"] == pytest.approx(7.841, abs=5e-4)
    assert not any("mass --aim" in n for n in along["notes"])


WHEEL = """
  <link name="disc">
    <inertial><mass value="3.0"/><inertia ixx="0.1" iyy="0.1" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="wheel" type="continuous">
    <parent link="base_link"/><child link="disc"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/>
  </joint>
</robot>"""


def with_wheel(tmp_path: Path) -> Path:
    text = load("pa10_wrist").urdf
    path = tmp_path / "wheeled.urdf"
    root = text[text.index('<link name="') + 12 :].split('"')[0]
    path.write_text(text.replace("</robot>", WHEEL.replace("base_link", root)), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["panda", "pa10_wrist", "a wheel"])
@pytest.mark.parametrize("base", ["fixed", "free"])
def test_every_joint_moves_or_is_said_to_be_held(
    name: str, base: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = str(with_wheel(tmp_path)) if name == "a wheel" else name
    loaded = load(Path(robot) if name == "a wheel" else robot, floating=base == "free")
    scene = Scene(loaded, joints="free", wrist=Wrist(stiffness=530.0))
    model = assemble_bodies(scene, scene.mechanism("multibody")).model
    still = set(scene.prepared.model.names) - set(model.names)
    assert still == set(other_joints(loaded))
    assert still == (
        {"wheel"} if name == "a wheel" else {"panda_finger_joint1", "panda_finger_joint2"} if name == "panda" else set()
    )
    assert TARGET in model.names
    outputs = [
        answer(capsys, "mass", robot, "--base", base, "--joints", "free"),
        {"notes": list(simulate(scene, backend="reduced", duration=0.05, must_touch=False).notes)},
    ]
    if base == "fixed":
        outputs.append(answer(capsys, "simulate", robot, "--joints", "free", "--backend", "reduced"))
        assert main(["simulate", robot, "--joints", "free", "--backend", "reduced"]) == 0
        told = capsys.readouterr().out
        assert ("held still" in told) == bool(still)
        assert held_words(loaded) in told
    for found in outputs:
        said = [n for n in found["notes"] if n.startswith("held still")]
        assert said == ([held_words(loaded)] if still else [])
        assert all(joint in said[0] for joint in still)


@pytest.mark.slow
def test_a_sweep_says_it_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pyarrow", reason="extra 'scale' is not installed")
    with_wheel(tmp_path)
    file = tmp_path / "sweep.toml"
    file.write_text('format = 1\n[scene]\nrobot = "./wheeled.urdf"\njoints = "free"\n', encoding="utf-8")
    found = answer(capsys, "sweep", str(file), "--out", str(tmp_path / "out"))
    assert any("wheel" in n for n in found["notes"])
    assert main(["sweep", str(file), "--out", str(tmp_path / "out")]) == 0
    assert "note: held still, being no joints of the arm from base to tip: wheel" in capsys.readouterr().out


def test_a_slider_that_the_scene_weighs_anew_is_said() -> None:
    assert not any("slider weighs" in n for n in Scene(wrist=Wrist(mass=0.7)).notes)
    assert "the wrist's slider weighs 0.5 kg, not 0.7 as in the robot" in Scene(wrist=Wrist(mass=0.5)).notes
