"""What notebooks show, and sliders without a browser."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.model.library import load
from spacerobot.simulation.parts import Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError
from spacerobot.view.notebook import Explorer, collision_explorer, mass_explorer, show
from spacerobot.view.notebook.explorer import Slide
from spacerobot.view.plotting import canvas
from spacerobot.view.scene3d.robot_film import robot_film

POSE = np.radians([0, 45, 0, 90, 0, -45, 0])


def test_a_film_is_a_frame_that_may_run_scripts_and_nothing_else() -> None:
    bundle = show(robot_film(load("wrist")))._repr_mimebundle_()
    frame = bundle["text/html"]
    assert frame.startswith("<iframe srcdoc=")
    assert frame.count("<iframe") == 1
    assert 'sandbox="allow-scripts"' in frame
    assert "<script" not in frame, "the page is inside an attribute"
    assert "wrist" in bundle["text/plain"]


def test_a_figure_is_a_picture() -> None:
    bundle = show(canvas(), title="nothing")._repr_mimebundle_()
    assert base64.b64decode(bundle["image/png"]).startswith(b"\x89PNG")
    assert bundle["text/plain"] == "nothing"


def test_dragging_a_joint_draws_anew() -> None:
    pytest.importorskip("ipywidgets", reason="extra 'notebooks' is not installed")
    robot = load("pa10_wrist")
    found = mass_explorer(robot, POSE, np.array([1.0, 0.0, 0.0]))
    before = bytes(found.picture.value)
    assert set(found.sliders) == set(robot.chain)
    found.sliders["E1"].value = 60.0
    assert bytes(found.picture.value) != before
    moved = POSE.copy()
    moved[3] = np.radians(60.0)
    expected = effective_mass(robot, moved, [1.0, 0.0, 0.0]).effective_mass_kg
    assert f"{expected:.4g} kg" in found.text.value
    bundle = found._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert base64.b64decode(bundle["image/png"]) == bytes(found.picture.value)


def test_dragging_the_spring_changes_the_collision() -> None:
    pytest.importorskip("ipywidgets", reason="extra 'notebooks' is not installed")
    scene = Scene(wrist=Wrist(stiffness=530.0, damping=11.0), target=Target(mass=9.0, speed=0.07))
    found = collision_explorer(scene)
    times = []
    for stiffness in (530.0, 2120.0):
        found.sliders["stiffness"].value = stiffness
        match = re.search(r"after ([\d.]+) s; Eqs", found.text.value)
        assert match is not None
        times.append(float(match[1]))
    assert times[0] == pytest.approx(2.0 * times[1], rel=0.15), "four times the spring, half the time"


def test_a_corner_that_physics_does_not_allow_is_told_in_words() -> None:
    pytest.importorskip("ipywidgets", reason="extra 'notebooks' is not installed")

    def draw(x: float):  # type: ignore[no-untyped-def]
        if x > 1.0:
            raise InputError("too far", given=x)
        return canvas(), "fine"

    found = Explorer(draw, {"x": Slide("x", 0.0, 0.0, 2.0, 0.1)})
    assert found.text.value == "fine"
    picture = bytes(found.picture.value)
    found.sliders["x"].value = 2.0
    assert "too far" in found.text.value
    assert bytes(found.picture.value) == picture
