"""What a table says of a robot: degrees of freedom, masses, limits, frames, or why it is refused."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.model import examples
from spacerobot.model.library import bundled, load
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError

NOTES = {
    "pa10": "PA10-7: lengths 0.315, 0.450, 0.500, 0.080 m",
    "pa10c": "PA10-7C: lengths 0.317, 0.450, 0.480, 0.070 m",
    "pa10_wrist": "PA10-7 with the compliant wrist on its flange",
    "pa10c_wrist": "PA10-7C with the compliant wrist on its flange",
    "chaser_pa10_wrist": "the PA10-7 with wrist on a 500 kg spacecraft",
    "chaser": "500 kg spacecraft for float_base",
    "target": "9 kg satellite",
    "wrist": "the compliant wrist alone",
}


def summary(name: str) -> dict[str, Any]:
    """One row about a robot known by name; a robot that cannot be loaded says why under `refused`."""
    ours = name in bundled()
    row: dict[str, Any] = {
        "name": name,
        "source": "spacerobot" if ours else "example-robot-data",
        "notes": NOTES.get(name, "") if ours else examples.NOTES.get(name, ""),
        "refused": None,
    }
    try:
        return row | figures(load(name))
    except InputError as error:
        return row | {"refused": str(error)}


def figures(robot: Robot) -> dict[str, Any]:
    """What a robot is: degrees of freedom of the chain and of all, mass [kg], frames, base."""
    return {
        "dof": len(robot.chain),
        "dof_total": int(robot.model.nv),
        "mass_kg": total_mass(robot),
        "tip": robot.tip,
        "base": "free" if robot.floating else "fixed",
        "wrist": robot.slider is not None,
        "rotor_inertia": bool(np.any(robot.model.armature > 0)),
    }


def total_mass(robot: Robot) -> float:
    """Mass of everything, a fixed base's own links included [kg]."""
    return float(sum(inertia.mass for inertia in robot.model.inertias))


def other_joints(robot: Robot) -> list[str]:
    """Joints that belong neither to the chain nor to the wrist: fingers, wheels, other arms."""
    own = {*robot.chain, robot.slider}
    return [name for name in list(robot.model.names)[2 if robot.floating else 1 :] if name not in own]


def held_words(robot: Robot) -> str:
    """A sentence on the joints that stay where they are although the arm moves; empty if there are none."""
    held = other_joints(robot)
    if not held:
        return ""
    many = f"{', '.join(held[:4])} and {len(held) - 4} more" if len(held) > 5 else ", ".join(held)
    return f"held still, being no joints of the arm from base to tip: {many}"
