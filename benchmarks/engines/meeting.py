"""The two collisions, and what is read from each engine's record of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.simulation.parts import Target, Wrist
from spacerobot.simulation.scene import Scene

WRIST = Wrist(stiffness=530.0, equivalent_damping=9.69)
SCENES = {
    "ground arm, held": Scene("pa10_wrist", wrist=WRIST, target=Target(mass=9.0, speed=0.07)),
    "free chaser, joints free": Scene(
        "chaser_pa10_wrist", joints="free", wrist=WRIST, target=Target(mass=9.0, speed=0.07)
    ),
}
DURATION = 0.6
"""Of every run [s]: the contact is over by then."""


@dataclass(frozen=True)
class Outcome:
    """Restitution of the target alone, and first touch to last separation [s]."""

    restitution: float
    contact_time: float

    def error(self, of: Outcome) -> float:
        """The larger of the two relative errors."""
        return max(
            abs(self.restitution / of.restitution - 1.0),
            abs(self.contact_time / of.contact_time - 1.0),
        )


def read(scene: Scene, time: np.ndarray, depth: np.ndarray, last_velocity: float) -> Outcome:
    """The outcome from a record of penetrations; the last crossing is interpolated by a parabola.

    Args:
        scene: what was run; wrist and target touch at t = 0.
        time, depth: shape (T,) [s, m].
        last_velocity: of the target along the approach, at the end [m/s].
    """
    pressed = np.flatnonzero(depth > 0.0)
    last = int(pressed[-1]) if pressed.size else 0
    if not 1 <= last < depth.size - 1:
        return Outcome(-last_velocity / scene.target.speed, math.nan)
    t, d = time[last - 1 : last + 2], depth[last - 1 : last + 2]
    curve = np.polyfit(t - t[1], d, 2)
    roots = [r.real for r in np.roots(curve) if abs(r.imag) < 1e-12 and 0.0 <= r.real <= t[2] - t[1]]
    crossing = t[1] + (min(roots) if roots else (t[2] - t[1]) * d[1] / (d[1] - d[2]))
    return Outcome(-last_velocity / scene.target.speed, float(crossing))
