"""Results at a prompt and in a notebook: one short line, small tables with nothing raw in them, tables of pandas."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spacerobot
from spacerobot import Scene, Servo
from spacerobot.diagnosis.answer.record import read
from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.support.errors import InputError
from spacerobot.support.showing import html_table
from spacerobot.support.tables import data_frame, data_set
from tests.view import helpers_report

POSE = np.radians([0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0])
X = [1.0, 0.0, 0.0]
LONGEST = 400
"""Characters of a line that a person still reads at a prompt: five lines of a terminal."""


@pytest.fixture(scope="module")
def results() -> dict[str, Any]:
    robot = spacerobot.load("pa10_wrist")
    study = spacerobot.load_study("guide-friction")
    short = replace(study, trials=study.trials[:1])
    scene = Scene(robot, duration=0.3)
    verdict = helpers_report.verdict("named")
    return {
        "robot": robot,
        "mass": spacerobot.effective_mass(robot, POSE, X),
        "batch": spacerobot.effective_mass_batch(robot, np.zeros((20, 7)), np.eye(3)),
        "apparent": spacerobot.apparent_mass(robot, POSE, X, np.geomspace(1.0, 100.0, 50), servo=Servo(1e4)),
        "impact": spacerobot.impact(robot, POSE, X, approach_speed=0.1, restitution=0.5, target_mass=9.0),
        "map": spacerobot.workspace_map(robot, POSE, X, axes=([0.7, 0.8], [0.0], [0.2, 0.3])),
        "scene": scene,
        "hit": spacerobot.simulate(scene, backend="reduced"),
        "study": study,
        "recording": study.recording(study.trials[0]),
        "overlay": spacerobot.overlay(short),
        "diagnosis": Diagnosis(read(verdict), {}),
        "soft": spacerobot.soft_capture(robot, POSE, X, tip_mass=9.7, tries=20),
    }


def test_reprs_are_short_lines(results: dict[str, Any]) -> None:
    series = next(iter(results["recording"].values()))
    channel = results["overlay"].trials[0].channels[0]
    for thing in (*results.values(), series, channel, results["overlay"].trials[0]):
        assert len(repr(thing)) < LONGEST
        assert "\n" not in repr(thing)


def test_notebooks_show_every_result(results: dict[str, Any]) -> None:
    for name, result in results.items():
        shown = result._repr_html_()
        assert shown.count("<tr>") > 1, name
        assert "&lt;array" not in shown, name


def test_a_scene_shows_what_it_states_with_its_units() -> None:
    wrist, friction = (
        spacerobot.Wrist(stiffness=530),
        spacerobot.EffectAt("coulomb_friction", "wrist", {"force_N": 0.4}),
    )
    scene = Scene("pa10_wrist", wrist=wrist, target=spacerobot.Target(mass=9.0, speed=0.07), effects=(friction,))
    shown = scene._repr_html_()
    for words in ("530", "N/m", "0.07", "m/s", "coulomb_friction at wrist", "force_N = 0.4"):
        assert words in shown
    assert "guide friction" not in shown  # what is nothing by default is not listed


def test_two_runs_side_by_side_show_where_they_differ(tmp_path: Path) -> None:
    for name, kind in (("one", "named"), ("two", "unknown")):
        spacerobot.save_diagnosis(Diagnosis(read(helpers_report.verdict(kind)), {}), tmp_path / name)
    found = spacerobot.compare(tmp_path / "one", tmp_path / "two")
    assert "differ" in repr(found)
    assert "<td" in found._repr_html_()
    assert "unknown" in found._repr_html_()


def test_what_others_wrote_is_escaped(results: dict[str, Any]) -> None:
    evil = "<script>alert(1)</script>"
    study = replace(results["study"], title=evil)
    verdict = {**results["diagnosis"].verdict, "study": evil}
    for shown in (
        study._repr_html_(),
        Diagnosis(read(verdict), {})._repr_html_(),
        html_table(evil, [(evil,)], (evil,), [evil]),
    ):
        assert "<script" not in shown
        assert "&lt;script" in shown


def test_tables_of_pandas(results: dict[str, Any]) -> None:
    pytest.importorskip("pandas", reason="extra 'tables' is not installed")
    hit = results["hit"].to_frame()
    assert list(hit.columns) == list(results["hit"].channels)
    assert hit.index.name == "time"
    assert hit.attrs["units"]["contact.force"] == "N"
    assert len(results["map"].to_frame()) == int(results["map"].reached.sum())
    assert results["batch"].to_frame().shape == (20, 3)
    joints = results["robot"].to_frame()
    assert list(joints.index) == [*results["robot"].chain, results["robot"].slider]
    assert (joints["lower"] < joints["upper"]).all()
    assert len(results["overlay"].to_frame()) == len(results["overlay"].trials[0].channels)
    assert list(results["study"].to_frame().index) == [t.id for t in results["study"].trials]
    assert len(results["diagnosis"].to_frame()) > 0
    whole = results["recording"].to_frame()
    for name, series in results["recording"].items():  # every sample of every channel is in the joined table
        assert whole[name].notna().sum() == int(series.valid.sum())


def test_data_sets_of_xarray(results: dict[str, Any]) -> None:
    pytest.importorskip("xarray", reason="extra 'tables' is not installed")
    hit = results["hit"].to_xarray()
    assert hit["contact.force"].attrs["units"] == "N"
    batch = results["batch"].to_xarray()
    assert dict(batch["effective_mass"].sizes) == {"pose": 20, "direction": 3}
    assert batch["mobility"].attrs["units"] == "1/kg"
    assert dict(results["map"].to_xarray().sizes) == {"x": 2, "y": 1, "z": 2, "joint": 7}
    recording = results["recording"].to_xarray()
    for name, series in results["recording"].items():
        assert recording[name].size == len(series)


def test_a_library_that_is_absent_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    import builtins
    import sys

    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.split(".")[0] in ("pandas", "xarray"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    for name in ("pandas", "xarray"):
        monkeypatch.setitem(sys.modules, name, None)
    for make in (lambda: data_frame({"a": [1.0]}), lambda: data_set({}, {})):
        with pytest.raises(InputError, match=r"spacerobot\[tables\]"):
            make()


def test_a_pose_is_a_pose_everywhere() -> None:
    """Functions of a pose take the whole configuration too, and say the same of both."""
    robot = spacerobot.load("chaser_pa10_wrist")
    whole = robot.configuration(POSE)
    servo = Servo(1e4, 50.0)

    def said(pose: np.ndarray) -> list[float]:
        return [
            spacerobot.effective_mass(robot, pose, X).effective_mass_kg,
            float(spacerobot.apparent_mass(robot, pose, X, 20.0, servo=servo).magnitude[0]),
            spacerobot.impact(robot, pose, X, approach_speed=1.0, restitution=1.0, target_mass=9.0).impulse_Ns,
            float(spacerobot.wall_limit(robot, pose, X, 9.7, [10.0]).reduced_mass_kg[0]),
        ]

    assert said(POSE) == said(whole)
    for wrong in (POSE[:-1], whole[:-1]):
        with pytest.raises(InputError, match="wrong length"):
            spacerobot.impact(robot, wrong, X, approach_speed=1.0, restitution=1.0, target_mass=9.0)


def test_a_servo_is_a_servo_everywhere() -> None:
    """A scene's servo and the same one asked for its apparent mass; the two numbers of old are told to change."""
    robot = spacerobot.load("chaser_pa10_wrist")
    servo = Servo([1e4] * 7, 50.0)
    asked = {"joints": "servo", "omega": 20.0}
    new = spacerobot.effective_mass(robot, POSE, X, servo=servo, **asked)
    with pytest.warns(DeprecationWarning, match="servo=Servo"):
        old = spacerobot.effective_mass(robot, POSE, X, stiffness=1e4, damping=50.0, **asked)
    assert new.effective_mass_kg == old.effective_mass_kg
    with pytest.raises(InputError, match="servo"):
        spacerobot.effective_mass(robot, POSE, X, servo=servo, stiffness=1e4, **asked)


def test_what_commands_write_is_written_from_python_too(results: dict[str, Any], tmp_path: Path) -> None:
    made = results["overlay"]
    page = spacerobot.write_overlay(made, tmp_path / "overlay")
    assert page.name == "overlay.html"
    assert (tmp_path / "overlay" / "overlay.json").is_file()
    assert spacerobot.write_overlay(made, tmp_path / "overlay") == page  # the same again
    film = spacerobot.film(results["robot"], pose=POSE)
    assert "<html" in spacerobot.write_page(film, tmp_path / "robot.html").read_text()
    with pytest.raises(InputError, match="Study"):
        spacerobot.film(results["robot"], trial="01")
    with pytest.raises(InputError, match="no film"):
        spacerobot.film(3)  # type: ignore[arg-type]
