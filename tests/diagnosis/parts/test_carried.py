"""A body on a turntable whose angle is known: its camera shows that angle, late or enlarged, or it shows more."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.recordings.study import Study, load_study

SIGMA = 5e-4

HEAD = f"""format = 1
title = "Turntable"
[baseline]
base = "free"
gravity = [0, 0, -9.80665]
[baseline.body]
mass = 2.0
[streams.servo]
time = "t"
[streams.servo.channels]
angle = {{ is = "joint.table.position", use = "input" }}
[streams.camera]
time = "t"
[streams.camera.channels]
yaw = {{ is = "body.yaw", sigma = {SIGMA} }}
"""


def turned(folder: Path, shown: Callable[[np.ndarray], np.ndarray]) -> Study:
    """Three runs of 12 s; `shown` is what the camera would read without noise, by time and angle at each."""
    random = np.random.default_rng(3)
    text = HEAD
    for n in range(3):
        rates, sizes = random.uniform(0.3, 3.0, 3), random.uniform(0.1, 0.5, 3)

        def angle(t: np.ndarray, rates: np.ndarray = rates, sizes: np.ndarray = sizes) -> np.ndarray:
            return np.asarray(np.sin(np.outer(t, rates)) @ sizes)

        for name, head, time in (
            ("servo", "angle", np.arange(0.0, 12.0, 0.01)),
            ("camera", "yaw", np.arange(0, 12.0, 1 / 60)),
        ):
            value = angle(time) if name == "servo" else shown(np.array([time, angle(time), angle(time - 0.05)]))
            value = value + SIGMA * random.standard_normal(time.size) * (name == "camera")
            np.savetxt(folder / f"{name}{n}.csv", np.c_[time, value], "%.8f", ",", header=f"t,{head}", comments="")
        text += f'[[trials]]\nid = "{n}"\nservo = "servo{n}.csv"\ncamera = "camera{n}.csv"\n'
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return load_study(folder)


@pytest.mark.parametrize(
    ("shown", "expected", "effects"),
    [
        (lambda seen: seen[1], "nothing_missing", []),
        (lambda seen: 1.02 * seen[1], "named", ["scale"]),
        (lambda seen: seen[2], "named", ["time_offset"]),
        (lambda seen: seen[1] + 1.5e-3 * seen[0], "unknown", []),  # it slips on the table
    ],
    ids=["as it is", "enlarged", "late", "slipping"],
)
def test_what_a_camera_shows_of_a_known_motion(
    shown: Callable[[np.ndarray], np.ndarray], expected: str, effects: list[str], tmp_path: Path
) -> None:
    verdict = diagnose(turned(tmp_path, shown), jobs=1).verdict
    assert verdict["verdict"] == expected
    assert [e["effect"] for e in verdict["effects"]] == effects
