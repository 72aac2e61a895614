"""What nothing damps runs back the way it came, through every touch; what something damps does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.multibody.integrate import integrate
from spacerobot.simulation.multibody.run import MultibodyRun, _scale, integrate_scene
from spacerobot.simulation.parts import ContactLaw, Motion, Target, Wrist
from spacerobot.simulation.scene import Scene

TUMBLING = Target(mass=9.0, speed=0.07, gap=0.001, contact_point=(0.12, 0.02, 0.01), spin=(0.02, -0.03, 0.05))
FREE = Scene("chaser_pa10_wrist", joints="free", wrist=Wrist(damping=0.0), target=TUMBLING, contact=ContactLaw(),
             motion=Motion(base_spin=(0.01, -0.02, 0.01), joint_rates={"S2": 0.02}))  # fmt: skip
HELD = Scene(wrist=Wrist(damping=0.0), target=TUMBLING, contact=ContactLaw())
END, TOLERANCE = 0.25, 1e-12


def run_back(scene: Scene, run: MultibodyRun) -> tuple[float, float]:
    """How far places and velocities are from the start's after as long with all velocities turned round."""
    dyn = run.dynamics
    nq, nv = dyn.nq, dyn.nv
    y = np.concatenate([run.steps.last[:nq], -run.steps.last[nq : nq + nv], np.zeros(dyn.size - nq - nv)])
    scale, _ = _scale(scene, dyn, TOLERANCE)
    clock = np.array([0.0, 1e-4, END, END, 0.0])
    back = integrate(dyn.machine, y, scale, clock, np.zeros((0, 2)), np.zeros(0, dtype=np.int64)).steps.last
    first = run.steps.state[0]
    return float(np.abs(back[:nq] - first[:nq]).max()), float(np.abs(back[nq : nq + nv] + first[nq : nq + nv]).max())


@pytest.mark.parametrize("scene", [HELD, FREE], ids=["held arm", "free chaser"])
def test_what_is_not_damped_runs_back(scene: Scene) -> None:
    run = integrate_scene(scene, END, tolerance=TOLERANCE)
    assert sum(e.kind == "touch" for e in run.events) > 1
    place, speed = run_back(scene, run)
    assert place < 1e-8
    assert speed < 1e-6
    damped = replace(scene, wrist=replace(scene.wrist, damping=5.0))
    assert run_back(damped, integrate_scene(damped, END, tolerance=TOLERANCE))[0] > 1e-5
