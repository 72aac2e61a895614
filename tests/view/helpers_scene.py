"""Captures and films that several tests look at."""

from __future__ import annotations

import functools

from spacerobot.simulation.parts import Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory


@functools.cache
def held() -> tuple[Scene, Trajectory]:
    """A held arm on the ground, reduced backend: the target would come through the arm, as studies have it."""
    scene = Scene(
        approach=(1.0, 0.0, 0.0),
        wrist=Wrist(stiffness=530.0, damping=2.0),
        target=Target(mass=9.0, speed=0.1, gap=0.02, contact_point=(0.15, 0.0)),
        backend="reduced",
    )
    return scene, simulate(scene)


@functools.cache
def free() -> tuple[Scene, Trajectory]:
    """A free chaser whose joints give way, hit off its axis."""
    scene = Scene(
        robot="chaser_pa10_wrist",
        base="free",
        joints="free",
        approach=(-1.0, 0.0, 0.0),
        wrist=Wrist(stiffness=530.0, damping=4.0),
        target=Target(mass=40.0, speed=0.12, gap=0.03, contact_point=(0.15, 0.02, 0.0), spin=(0.0, 0.0, 0.1)),
        duration=1.5,
    )
    return scene, simulate(scene, tolerance=1e-6)
