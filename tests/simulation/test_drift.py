"""A target that drifts across the approach: both backends, the scene file, symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.parts.contact import ContactLaw
from spacerobot.simulation.parts.target import Target
from spacerobot.simulation.parts.wrist import Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.simulate import simulate

SCENE = Scene(
    wrist=Wrist(stiffness=1020.0, equivalent_damping=5.0),
    contact=ContactLaw(stiffness=68000.0, damping=60.0),
    target=Target(mass=9.0, yaw_inertia=0.45, contact_point=(0.15, -0.02), speed=0.08, drift=-0.004, gap=0.01),
    duration=0.8,
)


def mirrored(scene: Scene) -> Scene:
    ahead, lateral, up = scene.target.contact_point
    spin = tuple(-s for s in scene.target.spin)
    target = replace(scene.target, drift=-scene.target.drift, contact_point=(ahead, -lateral, up), spin=spin)
    return replace(scene, target=target)


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_nothing_pushes_sideways_without_friction(backend: str) -> None:
    run = simulate(SCENE, backend=backend)
    assert run.restitution.touches > 0
    y = run.channels["target.y"]
    np.testing.assert_allclose(y - y[0], -0.004 * run.time, atol=1e-10)
    still = simulate(replace(SCENE, target=replace(SCENE.target, drift=0.0)), backend=backend)
    assert run.restitution.target == pytest.approx(still.restitution.target, abs=1e-7)


def test_the_backends_agree_where_the_surface_rubs() -> None:
    scene = replace(SCENE, contact=replace(SCENE.contact, mu=0.3))
    runs = [simulate(scene, backend=b) for b in ("reduced", "multibody")]
    for channel in ("target.x", "target.y", "target.yaw", "wrist.x"):
        one, other = (r.channels[channel] for r in runs)
        np.testing.assert_allclose(one - one[0], other - other[0], atol=1e-7)
    y, yaw = (runs[0].channels[c] for c in ("target.y", "target.yaw"))
    assert abs(y[-1] - y[0] + 0.004 * runs[0].time[-1]) > 1e-5  # friction did push
    image = simulate(mirrored(scene), backend="reduced")
    np.testing.assert_allclose(image.channels["target.y"], -y, atol=1e-9)
    np.testing.assert_allclose(image.channels["target.yaw"], -yaw, atol=1e-9)


def test_the_scene_file_keeps_it() -> None:
    assert scene_from_text(SCENE.to_toml()).target.drift == -0.004
