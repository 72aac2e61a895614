"""What the reduced model does not hold, said before anything is simulated with it.

It moves along the approach, with the target's sideways motion and yaw, and knows the arm at its start pose alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.outline import Outline
from spacerobot.support.errors import InputError

SMALL = 1e-12
"""Share of a vector, or of a moment of inertia, that is rounding."""


def require_planar(scene: Outline, mechanism: Mechanism) -> None:
    """Refuse what moves out of the plane of approach and lateral, or away from the pose.

    Raises:
        InputError: with the reason.
    """
    gravity = scene.axes.T @ np.array(scene.gravity)
    pulled = np.abs(gravity) > SMALL * np.linalg.norm(gravity)
    rubs = any(f.port == "contact.slide" for f in mechanism.frictions)
    moves = scene.base == "free" or scene.joints != "locked"
    if scene.base != "free" and scene.joints != "locked" and pulled.any():
        stiff = scene.servo is not None and all(k > 0.0 for k, _ in scene.servo.per_joint(scene.prepared.chain))
        if not stiff:
            _refuse("joints that nothing holds fall under gravity, away from the pose", scene.gravity, "gravity")
    if scene.base == "free" and pulled[1]:
        _refuse("a free chaser falls sideways, which its hand does not", scene.gravity, "gravity")
    if rubs and moves:
        _refuse(
            "friction at the tip moves the hand of a moving arm sideways, which it does not", scene.joints, "joints"
        )
    if rubs and pulled[2]:
        _refuse("friction meets a fall out of its plane", scene.gravity, "gravity")
    if scene.motion.moves_robot:
        _refuse("it knows the arm and its base at rest in the pose alone", scene.motion, "motion")
    turned = scene.axes.T @ scene.level
    target = scene.target
    point = turned @ np.array(target.contact_point)
    if abs(point[2]) > SMALL * np.linalg.norm(point):
        _refuse("a contact point above or below the centre pitches the target", target.contact_point, "target")
    spin = scene.axes.T @ np.array(target.spin)
    if (np.abs(spin[:2]) > SMALL * np.linalg.norm(spin)).any():
        _refuse("a spin that is not about the upright axis leaves the plane", target.spin, "target.spin")
    inertia = turned @ target.inertia_matrix() @ turned.T
    contact = mechanism.contact
    turns = bool(spin[2]) or rubs or (contact is not None and contact.lateral != 0.0) or bool(target.attitude[2])
    slid = [n for n, c in mechanism.coordinates.items() if not c.angular and mechanism.carrier_of(n) == "target"]
    if turns and slid:
        _refuse("what slides in a target that turns pulls it sideways", ", ".join(slid), "effects")
    if turns and np.abs(inertia[2, :2]).max() > SMALL * inertia[2, 2]:
        _refuse(
            "a yaw about an axis that is no principal one makes the target wobble", target.inertia, "target.inertia"
        )


def _refuse(why: str, given: Any, where: str) -> None:
    raise InputError(
        f"the reduced model does not hold this: {why}", given=given, valid="backend multibody", where=where
    )
