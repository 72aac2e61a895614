"""A stop that an axis meets on one side alone is found as that, wherever the axis has its zero."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_axis import HEAD, axis_urdf

STEP = 0.01
CATALOGUE = ("end_stop", "preload", "viscous_friction", "quadratic_damping")


def stopped(folder: Path, mass: float, centre: float, swing: float, sides: tuple[int, ...], stiffness: float) -> Study:
    """An axis that follows two waves about `centre`, with what a stop pushes with from 0.7 of the swing on in the log
    of its drive; its encoder counts a ten-thousandth of the swing."""
    random, count = np.random.default_rng(7), 1e-4 * swing
    text = HEAD
    for n, wave in enumerate((1.6, 2.1, 2.6)):
        time = np.arange(0.0, 6.0, STEP)
        place = centre + swing * (0.8 * np.sin(wave * time) + 0.2 * np.sin(2.7 * wave * time + n))
        bend = -swing * wave**2 * (0.8 * np.sin(wave * time) + 0.2 * 2.7**2 * np.sin(2.7 * wave * time + n))
        force = mass * bend
        for side in sides:
            force += side * stiffness * np.maximum(side * (place - centre) - 0.7 * swing, 0.0)
        force += 0.01 * np.std(force) * random.standard_normal(time.size)
        rows = np.column_stack([time, count * np.round(place / count), force])
        np.savetxt(folder / f"{n}.csv", rows, delimiter=",", header="t,q,u", comments="")
        text += f'[[trials]]\nid = "{n}"\ncondition = "{n}"\nlog = "{n}.csv"\n'
    (folder / "axis.urdf").write_text(axis_urdf(mass))
    (folder / "study.toml").write_text(text)
    return load_study(folder)


@pytest.mark.parametrize(
    ("mass", "centre", "swing", "sides", "stiffness", "form"),
    [
        (2.0, 0.0, 0.2, (1,), 4e3, "end_stop~above"),
        (0.02, 0.0, 0.05, (-1,), 8.0, "end_stop~below"),
        (60.0, 0.5, 0.25, (-1,), 3e4, "end_stop~below"),  # no place on the other side of zero: |d| says nothing of it
        (2.0, 0.0, 0.2, (1, -1), 4e3, "end_stop"),
    ],
)
def test_a_stop_is_found_on_its_side(
    tmp_path: Path, mass: float, centre: float, swing: float, sides: tuple[int, ...], stiffness: float, form: str
) -> None:
    (model,) = models_for(stopped(tmp_path, mass, centre, swing, sides, stiffness))
    growth = grow(model, effects=[effect(name) for name in CATALOGUE])
    assert growth.after.label == ((form, "joint.j"),)
    found = growth.after.fit.values()
    begins = centre + sides[0] * 0.7 * swing
    assert found[f"{form}@joint.j.travel_m"] == pytest.approx(begins, abs=0.01 * swing)
    assert found[f"{form}@joint.j.stiffness_N_m"] == pytest.approx(stiffness, rel=0.05)
