"""How wide a torque balance's test function must be for the motion's noise not to drown the torque's.

An acceleration is taken from positions, and inertia makes a torque of its noise. Where that is what a balance leaves,
whatever smooths the motion predicts better, be it a link on a spring that the machine does not have.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.effects.sizes import Sizes

LITTLE = 0.005
"""Share of a torque's rms that its balance is not trusted to anyway: models of arms are off by more."""

WIDTH, WIDEST = 0.1, 0.35
"""Half width of the balance's test functions, as a share of the motion's own time (its length over its speed): at
least, and at most where the motion's noise asks for more. A sine of that time passes the widest by 99 %."""

SWUNG = 1.0
"""The same at most where nothing drives the joint: nothing there is faster than its own swing, of which inertia and
weight are the most and all but cancel. What is fitted to the little that is left would be fitted to their noise."""

FINE = Bump.of(200, 1.0)
"""A test function of which sums are integrals."""


def half_width(
    grids: Sequence[Grid],
    inertia: Mapping[str, Mapping[str, float]],
    sizes: Mapping[str, Sizes],
    idle: Collection[str],
) -> float:
    """Half width of a balance's test functions [s].

    Args:
        grids: of the trials.
        inertia: joint whose balance is compared -> joint -> torque at the one by the acceleration of the other [kg m^2
            or kg].
        sizes: of every joint.
        idle: joints that nothing drives.
    """
    wide = 0.0
    for joint, row in inertia.items():
        wide = max(wide, clear_width(grids, joint, row, sizes[joint].force if joint in idle else None))
    time = min(sizes[joint].time for joint in inertia)
    return float(np.clip(wide, WIDTH * time, (SWUNG if set(inertia) <= set(idle) else WIDEST) * time))


def clear_width(grids: Iterable[Grid], joint: str, inertia: Mapping[str, float], level: float | None = None) -> float:
    """Least half width [s] at which the motion's noise asks for little torque, or no more than is that of its own log.

    Args:
        grids: of the trials.
        joint: whose balance it is.
        inertia: joint -> torque at this one by its acceleration [kg m^2 or kg].
        level: of what inertia and weight ask for, where nothing drives the joint [N m or N]; else its log tells.
    """
    every = list(grids)
    rates = all(f"joint.{j}.velocity" in g.value for j in inertia for g in every)
    kernel, power, read = (FINE.slope, 1, "velocity") if rates else (FINE.curve, 2, "position")
    shaken = float(np.sqrt(sum((m * logged_noise(every, f"joint.{j}.{read}")) ** 2 for j, m in inertia.items())))
    torque = f"joint.{joint}.torque"
    shown = 0.0
    if level is None:
        shown = logged_noise(every, torque)
        level = float(np.sqrt(np.mean(np.concatenate([g.value[torque] for g in every]) ** 2)))
    # white noise passes a kernel by its norm, which goes as a power of its width
    bent, seen = (float(np.linalg.norm(k)) * FINE.half**p for k, p in ((kernel, power + 0.5), (FINE.weight, 0.5)))
    step, little = every[0].step, LITTLE * level
    ends = ((shaken * bent, shown * seen, power), (shaken * bent * step**0.5, little, power + 0.5))
    return min((asked / told) ** (1.0 / p) if told > 0.0 else float("inf") for asked, told, p in ends)


def logged_noise(grids: Iterable[Grid], channel: str) -> float:
    """How a channel scatters in the middle one of some trials."""
    return float(np.median([g.scatter[channel] for g in grids]))
