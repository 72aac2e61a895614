"""Effective mass as pictures, pages and scenes, and the options that make them."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.model.library import load
from spacerobot.simulation.parts import Servo
from spacerobot.view.mass.choose import mass_film
from spacerobot.view.mass.films import map_film, path_film
from spacerobot.view.mass.frequency_figure import responses, ringing
from spacerobot.view.mass.map_figure import map_figure, slice_map
from spacerobot.view.mass.path_figure import masses_along, straight

POSE = np.radians([0, 45, 0, 90, 0, -45, 0])
END = np.radians([0, 10, 0, 60, 0, 20, 0])
X = np.array([1.0, 0.0, 0.0])
Q = ["--deg", "--q", "0", "45", "0", "90", "0", "-45", "0"]
TO = ["--to", "0", "10", "0", "60", "0", "20", "0"]


def test_a_path_has_the_mass_of_its_poses() -> None:
    robot = load("pa10_wrist")
    poses = straight(POSE, END, 9)
    np.testing.assert_allclose(poses[[0, -1]], [POSE, END])
    curves = {name: mass for name, mass, _, _ in masses_along(robot, poses, X)}
    alone = [effective_mass(robot, p, X).effective_mass_kg for p in poses]
    np.testing.assert_allclose(curves["fixed base, joints free"], alone)
    assert np.all(curves["floating base, joints free"] < curves["fixed base, joints free"])
    assert np.all(curves["floating base, joints free"] < curves["floating base, joints locked"])


def test_servos_let_go_at_high_frequency_and_hold_at_low() -> None:
    found = responses(load("pa10_wrist"), POSE, X, servo=Servo(3e3, 5.0))
    for response in found.values():
        assert response.magnitude[-1] == pytest.approx(1.0 / response.free_mobility, rel=0.02)
    floating, fixed = found["floating"], found["fixed"]
    assert floating.magnitude[0] == pytest.approx(1.0 / floating.locked_mobility, rel=0.02)
    assert abs(fixed.phase[0]) == pytest.approx(math.pi, abs=0.05), "a held arm on the ground is a spring"
    stiff = responses(load("pa10_wrist"), POSE, X, servo=Servo(1e7, 5e3))["fixed"]
    assert ringing(stiff, 530.0, 9.7) == pytest.approx(math.sqrt(530.0 / 9.7) / (2.0 * math.pi), rel=1e-3)


def test_the_slice_goes_through_the_hand_and_marks_it() -> None:
    robot = load("pa10_wrist")
    found = slice_map(robot, POSE, X, fine=16)
    nearest = np.abs(found.axes[0] - found.place[0]).min(), np.abs(found.axes[2] - found.place[2]).min()
    assert max(nearest) < 1e-9
    assert found.axes[1].tolist() == [found.place[1]]
    figure = map_figure(robot, POSE, {"fixed": found})
    assert figure.axes[0].get_xlabel() == "x [m]"
    assert slice_map(robot, POSE, np.array([0.0, 1.0, 0.0]), fine=8).axes[0].size == 1


def test_films_show_the_mass_of_what_they_show() -> None:
    robot = load("pa10_wrist")
    film = path_film(robot, POSE, END, X)
    assert [m.label for m in film.marks] == ["start", "end"]
    at = np.array([0, len(film.time) // 2])
    expected = [effective_mass(robot, p, X).effective_mass_kg for p in (POSE, END)]
    np.testing.assert_allclose(film.readouts[0].values[at], expected, rtol=1e-3)
    full = map_film(load("chaser_pa10_wrist"), POSE, X, joints="locked")
    cloud = next(b for b in full.bodies if b.name == "workspace")
    assert len(cloud.pieces) > 4
    masses = full.readouts[0].values
    soft, hard = (np.interp(m.time, full.time, masses) for m in full.marks)
    assert soft < 0.4 * hard
    assert soft == pytest.approx(masses.min(), rel=0.02)


@pytest.mark.slow
def test_mass_pictures_from_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["mass", "pa10_wrist", *Q, *TO, "--out", str(out), "--pictures", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    text = (out / "mass.html").read_text()
    assert f"{answer['effective_mass_kg']:.3g}" in text
    assert text.count('src="data:image/svg+xml;base64,') == 4
    assert "http" not in text.split("<body>")[1].replace("data:image/svg+xml", "")[:400]
    for name in ("ellipsoid_along_path", "workspace_map", "apparent_mass", "soft_capture"):
        assert (out / f"{name}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "arguments",
    [
        ["mass", "pa10_wrist", *Q, "--pictures"],
        ["mass", "pa10_wrist", *Q, *TO, "--out", "unused"],
        ["mass", "pa10_wrist", *Q, "--pictures", "--out", "unused", "--frame", "W2"],
        ["mass", "pa10_wrist", *Q, "--pictures", "--out", "unused", "--to", "1", "2"],
        ["view", "pa10_wrist", "--map", "--to", "1", "2", "3", "4", "5", "6", "7"],
        ["view", "pa10_wrist", "--direction", "1", "0", "0"],
        ["view", "pa10_wrist", "--joints", "free"],
        ["view", "pa10_wrist", "--map", "--joints", "locked"],
        ["view", "pa10_wrist", "--map", "--joints", "servo"],
        ["view", "pa10_wrist", "--to", "1", "2"],
        ["view", "pa10_wrist", "--q", *["0"] * 7, "--to", *["0"] * 7],
        ["view", "wrist", "--map"],
        ["view", "guide-friction/study.toml", "--map"],
    ],
)
def test_what_does_not_fit_is_refused_in_a_line(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not any(tmp_path.iterdir())


def test_any_robot_with_joints_has_its_map() -> None:
    film = mass_film("ur5", None, None, [0.0, 0.0, 1.0])
    assert any(b.name == "workspace" for b in film.bodies)
