"""Whether the target is where the arm is when a scene begins: a picture of what cannot be built.

The arm is no obstacle to the simulation, which knows the contact at the wrist's tip alone: this is said, not
refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from spacerobot.simulation.parts.target import TARGET_EDGE

if TYPE_CHECKING:
    from spacerobot.simulation.scene import Scene

CLEAR = 0.01
"""How far inside the target's cube the arm's line must be [m]; a tip that touches its face does not count."""


class StartWarning(UserWarning):
    """Target and arm are in one place at the start."""


def cube_centre(point: np.ndarray) -> np.ndarray:
    """Centre of the cube that a target is taken for, shape (3,), body axes from the centre of mass [m].

    Args:
        point: shape (3,), the contact point alike. Its front is there if the point lies within it; no scene says how
            large its target is.
    """
    half = TARGET_EDGE / 2.0
    sideways = np.sign(point[1:]) * np.maximum(np.abs(point[1:]) - half, 0.0)
    return np.array([min(0.0, point[0] - half), *sideways])


def met_at_start(scene: Scene) -> str | None:
    """A sentence where a line between two joints runs through the target's cube at the start; None where none does."""
    if scene.base == "fixed" and scene.joints == "locked":
        return None  # a held arm is a wall from whichever side: pictures turn it half around
    robot, body = scene.prepared, scene.attitude
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, scene.start)
    tip = data.oMf[robot.frame_id(str(robot.contact))].translation + scene.wrist.deflection * np.array(scene.approach)
    gap = scene.target.gap + scene.wrist.deflection
    mass_at = tip - gap * np.array(scene.approach) - scene.lever
    centre = mass_at + body @ cube_centre(scene.attitude.T @ scene.lever)
    half = TARGET_EDGE / 2.0 - CLEAR
    slider = robot.joint_id(str(robot.slider))
    for joint in range(1, model.njoints):
        parent = model.parents[joint]
        if parent == 0:
            continue
        ends = np.array([data.oMi[k].translation for k in (parent, joint)])
        if _crosses((ends - centre) @ body, half):
            part = "the wrist" if joint == slider else f"joint {model.names[joint]}"
            along = scene.along_the_hand
            turned = np.dot(along, scene.approach) < 1.0 - 1e-6
            way = f"approach ({', '.join(f'{x:.3g}' for x in along)}), along the hand, or another pose"
            advice = way if turned else "another pose"
            return (
                f"at the start the target (drawn as a cube of {TARGET_EDGE:g} m) stands where the arm is, between "
                f"joint {model.names[parent]} and {part}; only the tip touches it. Try {advice}"
            )
    return None


def _crosses(ends: np.ndarray, half: float) -> bool:
    """Whether a segment, shape (2, 3), meets the cube |x|, |y|, |z| < half."""
    start, way = ends[0], ends[1] - ends[0]
    low, high = 0.0, 1.0
    for k in range(3):
        if abs(way[k]) < 1e-12:
            if abs(start[k]) >= half:
                return False
            continue
        a, b = sorted(((-half - start[k]) / way[k], (half - start[k]) / way[k]))
        low, high = max(low, a), min(high, b)
    return low < high
