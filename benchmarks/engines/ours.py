"""spacerobot: where the arm is held, exact propagation and the reduced backend, which is then exact too; the multibody
backend in both scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.engines.meeting import DURATION, SCENES, Outcome
from spacerobot.simulation.events import contact_intervals
from spacerobot.simulation.exact.batch import collide
from spacerobot.simulation.exact.structure import piecewise_linear
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.reduced.forces import PRESSED
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import reduced_start

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)
REFERENCE = 1e-12


def multibody(scene: Scene, tolerance: float) -> Outcome:
    """The multibody backend."""
    run = integrate_scene(scene, DURATION, tolerance=tolerance)
    intervals = contact_intervals(run.events, run.starts_pressed, 0.0, DURATION)
    velocity = run.port("target", run.sample(np.array([intervals[-1][1]])).velocity)[0]
    return Outcome(-float(velocity) / scene.target.speed, intervals[-1][1] - intervals[0][0])


def reduced(scene: Scene, tolerance: float) -> Outcome:
    """The reduced backend: of a held arm nothing moves but wrist and target."""
    position, velocity = reduced_start(scene)
    run = simulate(scene.mechanism("reduced"), position=position, velocity=velocity, end=DURATION, tolerance=tolerance)
    intervals = contact_intervals(run.events, bool(run.steps.modes[0, 0] == PRESSED), 0.0, DURATION)
    _, speeds = run.states(np.array([intervals[-1][1]]))
    speed = speeds[0, run.layout.coordinates.index("target")]
    return Outcome(-float(speed) / scene.target.speed, intervals[-1][1] - intervals[0][0])


def exact(scene: Scene) -> Outcome:
    """Matrix exponentials between events, the scene's numbers taken anew each time."""
    structure, numbers = piecewise_linear(scene)
    found = collide(structure, numbers[None], DURATION)
    return Outcome(float(found.restitution_target[0]), float(found.contact_time[0]))


def runs(name: str, quick: bool) -> Iterator[tuple[str, str, Callable[[], Outcome]]]:
    """(engine, setting, run)."""
    scene = SCENES[name]
    for tolerance in TOLERANCES[2:3] if quick else TOLERANCES:
        yield "spacerobot, multibody", f"{tolerance:g}", lambda tolerance=tolerance: multibody(scene, tolerance)
    if scene.joints == "locked":
        structure, numbers = piecewise_linear(scene)
        collide(structure, numbers[None], DURATION)
        for tolerance in TOLERANCES[2:3] if quick else TOLERANCES:
            yield "spacerobot, reduced", f"{tolerance:g}", lambda tolerance=tolerance: reduced(scene, tolerance)
        yield "spacerobot, exact", "one", lambda: exact(scene)


def reference(name: str) -> Outcome:
    """What all are compared with."""
    return multibody(SCENES[name], REFERENCE)
