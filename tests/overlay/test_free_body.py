"""The free body: falls and pushes in closed form come back as noise; drag in a real drop does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.parts import Parts
from spacerobot.diagnosis.forward.residuals import by_channel
from spacerobot.recordings.study import load_study
from tests.overlay.studies import needs_real, write_csv


def study(folder: Path, mass: str = "2.0", drag: float = 0.0, pushed: bool = True) -> Path:
    """A body that glides along x under a sine of force; left alone it falls along z, and turns evenly."""
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(0.0, 12.0, 0.01)
    force = 3.0 * np.cos(1.7 * time)
    x = 0.4 + 0.2 * time - 3.0 / (2.0 * 1.7**2) * np.cos(1.7 * time)
    z = 100.0 - 0.5 * 9.81 * time**2 + drag * time**3
    write_csv(folder / "log.csv", {"t": time, "f": force, "x": x, "z": z, "yaw": 0.3 - 0.05 * time})
    along = """f = { is = "body.force.x", use = "input" }
x = { is = "body.position.x", sigma = 1e-4 }"""
    alone = """z = { is = "body.position.z", sigma = 1e-4 }
yaw = { is = "body.yaw", sigma = 1e-4 }"""
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
{along if pushed else alone}
[[trials]]
id = "a"
log = "log.csv"
"""
    )
    return folder


def worst(folder: Path) -> dict[str, float]:
    found = load_study(folder)
    model = forward_model(found)
    assert isinstance(model, Parts)
    return {c.channel: float(np.abs(c.residual).max()) for c in model.simulate(found.trials[0]).channels}


def test_a_right_body_shows_no_residual(tmp_path: Path) -> None:
    found = worst(study(tmp_path / "pushed"))
    assert found["body.position.x"] < 3e-3, "a force holds until its next sample, a sine does not"
    found = worst(study(tmp_path / "left alone", pushed=False))
    assert set(found) == {"body.position.z", "body.yaw"}
    assert max(found.values()) < 1e-6


def test_a_wrong_mass_and_what_slows_a_fall_are_seen(tmp_path: Path) -> None:
    assert worst(study(tmp_path / "mass", mass="2.4"))["body.position.x"] > 0.03
    assert worst(study(tmp_path / "drag", drag=0.05, pushed=False))["body.position.z"] > 0.1


def test_a_mass_that_is_unknown_is_found(tmp_path: Path) -> None:
    found = load_study(study(tmp_path, mass='"unknown"'))
    (mass,) = (v for v in forward_model(found).values if v.name.endswith("body.mass"))
    assert mass.value == pytest.approx(2.0, rel=5e-3)
    assert mass.source == Parts.source


def test_a_pushed_body_starts_anew_and_says_so(tmp_path: Path) -> None:
    folder = study(tmp_path)
    path = folder / "study.toml"
    path.write_text(path.read_text().replace("format = 1", "format = 1\nhorizon = 3.0"))
    found = load_study(folder)
    model = forward_model(found)
    restarts = model.simulate(found.trials[0])["body.position.x"].restarts
    assert restarts is not None
    assert np.diff(restarts) == pytest.approx(3.0)
    assert any("every 3 s" in text for text in model.assumptions)


@pytest.mark.real
@needs_real("balldrop")
def test_free_fall_misses_light_balls_most() -> None:
    found = load_study("real/balldrop")
    model = forward_model(found)

    def missed(name: str) -> float:
        trials = [model.simulate(t) for t in found.trials if found.condition(t) == name]
        return by_channel(trials)["body.position.z"].rms

    assert missed("whiffle_ball_1") > missed("green_basketball") > 0.1
