"""Thrust along a body's own axes: a valve that leaks pushes along them as the body turns, and is no table's fault."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.windows import Turned, commanded
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.effects.primitives import ChannelMap
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_air_bed import LEVELS, flown, head

PLACES = ("command.force.x", "command.force.y", "command.torque.yaw")


def leaking(folder: Path, bias: tuple[float, float, float]) -> Study:
    """Three runs under commands that hold for half a second, with this added to thrust and torque [N, N, N m]."""
    random, text = np.random.default_rng(4), [head("An air bed that turns", ', frame = "body"')]

    def push(command: np.ndarray, yaw: float) -> np.ndarray:
        (ahead, aside, turning), cos, sin = command + np.array(bias), np.cos(yaw), np.sin(yaw)
        return np.array([cos * ahead - sin * aside, sin * ahead + cos * aside, turning])

    for run in range(3):
        level = random.choice([-1.0, 0.0, 1.0], (14, 3)) * LEVELS
        start = [0.0, 0.0, run - 1.0, 0.02, -0.03, 0.3 * (-1.0) ** run]
        text.append(flown(folder, run, level, push, start, 6.0, random))
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)


@pytest.mark.parametrize("bias", [(0.04, 0.0, 0.0), (0.0, -0.03, 0.0), (0.0, 0.0, 0.004), (0.0, 0.0, 0.0)])
def test_a_bias_of_thrust_is_found_along_the_bodys_axes(bias: tuple[float, float, float], tmp_path: Path) -> None:
    (model,) = models_for(leaking(tmp_path, bias))
    growth = grow(model, effects=[effect(n) for n in ("bias", "table_tilt", "table_curvature")], most=2)
    planted = {place: size for place, size in zip(PLACES, bias, strict=True) if size}
    assert growth.after.label == tuple(("bias", place) for place in planted)
    for place, size in planted.items():
        assert growth.after.fit.values()[f"bias@{place}.value"] == pytest.approx(size, rel=0.1)


def test_one_number_is_no_zero_of_forces_and_of_a_torque(tmp_path: Path) -> None:
    (model,) = models_for(leaking(tmp_path, (0.0, 0.0, 0.0)))
    places = {s.where for s in model.sites([effect("bias")])}
    assert set(PLACES) <= places
    assert "command" not in places
    text = (tmp_path / "study.toml").read_text().replace(', frame = "body"', "")
    (tmp_path / "study.toml").write_text(text)
    (model,) = models_for(load_study(tmp_path))
    assert {s.where for s in model.sites([effect("bias")])} & {*PLACES, "command"} == {"command.torque.yaw"}


def test_late_thrust_acts_along_the_axes_as_they_are_when_it_comes() -> None:
    """A body that turns at 1 rad/s under steady thrust ahead, which comes half a second late."""
    time = np.arange(0.0, 4.0, 0.05)
    yaw = 1.0 * time
    turned = Turned("x", "y", time, yaw)
    drive = commanded({"x": (time, np.cos(yaw)), "y": (time, np.sin(yaw))})
    late = [ChannelMap(c, "delay", 0.5) for c in "xy"]
    for told, behind in ((turned, 0.0), (None, 0.5)):
        out = type(drive)(drive.time, drive.value, drive.jumps, turned=told).through(late, 1.0, 3.0)
        inside = (out.time > 1.0) & (out.time < 3.0)
        np.testing.assert_allclose(out.value["x"][inside], np.cos(out.time[inside] - behind), atol=0.06)
