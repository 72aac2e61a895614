"""The free body: falls and pushes in closed form come back as noise; drag in a real drop does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.free_body import RESTART, FreeBody
from spacerobot.diagnosis.forward.residuals import by_channel
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.overlay.studies import needs_real, write_csv


def study(folder: Path, mass: str = "2.0", drag: float = 0.0) -> Path:
    """A body that glides along x under a sine of force, falls along z, and turns evenly."""
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(0.0, 12.0, 0.01)
    force = 3.0 * np.cos(1.7 * time)
    x = 0.4 + 0.2 * time - 3.0 / (2.0 * 1.7**2) * np.cos(1.7 * time)
    z = 100.0 - 0.5 * 9.81 * time**2 + drag * time**3
    write_csv(folder / "log.csv", {"t": time, "f": force, "x": x, "z": z, "yaw": 0.3 - 0.05 * time})
    (folder / "study.toml").write_text(
        f"""format = 1
[baseline]
base = "free"
gravity = [0, 0, -9.81]
[baseline.body]
mass = {mass}
[streams.log]
time = "t"
[streams.log.channels]
f = {{ is = "body.force.x", use = "input" }}
x = {{ is = "body.position.x", sigma = 1e-4 }}
z = {{ is = "body.position.z", sigma = 1e-4 }}
yaw = {{ is = "body.yaw", sigma = 1e-4 }}
[[trials]]
id = "a"
log = "log.csv"
"""
    )
    return folder


def worst(folder: Path) -> dict[str, float]:
    found = load_study(folder)
    model = forward_model(found)
    assert isinstance(model, FreeBody)
    return {c.channel: float(np.abs(c.residual).max()) for c in model.simulate(found.trials[0]).channels}


def test_a_right_body_shows_no_residual(tmp_path: Path) -> None:
    found = worst(study(tmp_path))
    assert set(found) == {"body.position.x", "body.position.z", "body.yaw"}
    assert found["body.position.x"] < 1e-3, "the force is linear between its samples, a sine is not"
    assert max(found["body.position.z"], found["body.yaw"]) < 1e-6


def test_a_wrong_mass_and_what_slows_a_fall_are_seen(tmp_path: Path) -> None:
    assert worst(study(tmp_path / "mass", mass="2.4"))["body.position.x"] > 0.1
    assert worst(study(tmp_path / "drag", drag=0.05))["body.position.z"] > 1.0


def test_a_pushed_body_needs_its_mass(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"needs its body\.mass"):
        worst(study(tmp_path, mass='"unknown"'))


def test_a_pushed_body_starts_anew_and_says_so(tmp_path: Path) -> None:
    found = load_study(study(tmp_path))
    model = forward_model(found)
    channels = {c.channel: c for c in model.simulate(found.trials[0]).channels}
    assert channels["body.position.z"].restarts is None
    restarts = channels["body.position.x"].restarts
    assert restarts is not None
    assert np.diff(restarts) == pytest.approx(RESTART)
    assert any("starts anew every 5 s" in text for text in model.assumptions)


@pytest.mark.real
@needs_real("balldrop")
def test_light_balls_fall_behind() -> None:
    found = load_study("real/balldrop")
    model = forward_model(found)

    def behind(name: str) -> float:
        trials = [model.simulate(t) for t in found.trials if found.condition(t) == name]
        return by_channel(trials)["body.position.z"].mean

    assert behind("whiffle_ball_1") < behind("green_basketball") < 0.0, (
        "free fall is below the ball, most for light ones"
    )
