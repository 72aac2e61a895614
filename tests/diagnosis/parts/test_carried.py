"""A body on a turntable whose angle is known: its camera shows that angle, late or enlarged, or it shows more."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import signal

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


Motion = Callable[[np.ndarray], np.ndarray]
"""Angle [rad] by time [s]."""


def filtered(cutoff: float, order: int) -> Callable[[np.ndarray, Motion], np.ndarray]:
    """A camera whose readings went through a Bessel filter, long before they were recorded."""

    def shown(time: np.ndarray, angle: Motion) -> np.ndarray:
        step = 1e-3
        fine = np.arange(-5.0, float(time[-1]) + step, step)
        poles = signal.bessel(order, 2.0 * np.pi * cutoff, analog=True, norm="mag")
        b, a = signal.bilinear(*poles, fs=1.0 / step)
        path = angle(fine)
        out, _ = signal.lfilter(b, a, path, zi=signal.lfilter_zi(b, a) * path[0])
        return np.interp(time, fine, out)

    return shown


def turned(folder: Path, shown: Callable[[np.ndarray, Motion], np.ndarray]) -> Study:
    """Three runs of 12 s; `shown` is what the camera would read without noise."""
    random = np.random.default_rng(3)
    text = HEAD
    for n in range(3):
        rates, sizes = random.uniform(0.3, 3.0, 3), random.uniform(0.1, 0.5, 3)

        def angle(t: np.ndarray, rates: np.ndarray = rates, sizes: np.ndarray = sizes) -> np.ndarray:
            return np.asarray(np.sin(np.outer(t, rates)) @ sizes)

        for name, head, rate in (("servo", "angle", 100.0), ("camera", "yaw", 60.0)):
            time = np.arange(0.0, 12.0, 1.0 / rate)
            value = angle(time) if name == "servo" else shown(time, angle) + SIGMA * random.standard_normal(time.size)
            np.savetxt(folder / f"{name}{n}.csv", np.c_[time, value], "%.8f", ",", header=f"t,{head}", comments="")
        text += f'[[trials]]\nid = "{n}"\nservo = "servo{n}.csv"\ncamera = "camera{n}.csv"\n'
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return load_study(folder)


@pytest.mark.parametrize(
    ("shown", "expected", "effects"),
    [
        (lambda t, angle: angle(t), "nothing_missing", []),
        (lambda t, angle: 1.02 * angle(t), "named", ["scale"]),
        (lambda t, angle: angle(t - 0.05), "named", ["time_offset"]),
        (lambda t, angle: angle(t) + 1.5e-3 * t, "unknown", []),  # it slips on the table
        (filtered(1.5, 2), "named", ["low_pass"]),
        pytest.param(filtered(0.15, 1), "unknown", [], marks=pytest.mark.slow),  # what is left is another motion
    ],
    ids=["as it is", "enlarged", "late", "slipping", "filtered", "blurred"],
)
def test_what_a_camera_shows_of_a_known_motion(
    shown: Callable[[np.ndarray, Motion], np.ndarray], expected: str, effects: list[str], tmp_path: Path
) -> None:
    verdict = diagnose(turned(tmp_path, shown), jobs=1).verdict
    assert verdict["verdict"] == expected
    assert [e["effect"] for e in verdict["effects"]] == effects
