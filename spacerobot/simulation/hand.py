"""What the wrist feels of the arm behind it: the hand of the reduced model."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.dynamics.terms import terms_of
from spacerobot.dynamics.regime import regime_of
from spacerobot.support.errors import InputError

if TYPE_CHECKING:
    from spacerobot.simulation.scene import Scene


@dataclass(frozen=True)
class Hand:
    """One mass between the world and the wrist's guide.

    Attributes:
        mass: effective mass at the wrist mount along the approach, slider free [kg]; infinite where it is held.
        stiffness, damping: of the spring that ties it to the world [N/m, N s/m]; servo joints on a fixed base.
        note: how it was found.
    """

    mass: float
    stiffness: float = 0.0
    damping: float = 0.0
    note: str = ""


def hand_of(scene: Scene) -> Hand:
    """The hand of a scene: 1/(n^T J H_c^-1 J^T n) at the start pose, the slider eliminated (Schur).

    Servo joints: on a fixed base the hand has the mass of free joints and the spring K_tip = 1/(n^T J K^-1 J^T
    n), exact for slow and for fast motion; on a free base it has the apparent mass at the contact's frequency.

    Raises:
        InputError: servo joints on a free base that act as a spring at that frequency.
    """
    robot, pose = scene.prepared, np.array(scene.pose)
    if scene.base == "fixed" and scene.joints == "locked":
        return Hand(math.inf, note="the arm is held")
    options = {"base": scene.base, "direction": scene.approach}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoseLimitWarning)  # the scene has said so
        if scene.joints != "servo":
            found = effective_mass(robot, pose, joints=scene.joints, **options)  # type: ignore[arg-type]
            return Hand(found.effective_mass_kg, note=f"joints {scene.joints}, base {scene.base}")
        assert scene.servo is not None
        stiffness, damping = (np.array(c) for c in zip(*scene.servo.per_joint(robot.chain), strict=True))
        if scene.base == "free":
            held = effective_mass(
                robot,
                pose,
                joints="servo",
                stiffness=stiffness,
                damping=damping,
                wrist_stiffness=max(scene.wrist.stiffness, 1e-6),
                target_mass=scene.target.mass,
                **options,  # type: ignore[arg-type]
            )
            if abs(held.phase_rad) > 0.5 * math.pi and scene.backend == "reduced":
                raise InputError(
                    "servo joints act as a spring at the contact's frequency, not as a mass",
                    valid="backend multibody",
                    where="servo",
                )
            return Hand(held.effective_mass_kg, note="; ".join(held.notes))
        free = effective_mass(robot, pose, joints="free", **options)  # type: ignore[arg-type]
    terms = terms_of(robot, robot.configuration(pose), regime_of(robot, "fixed", "free"))
    row = np.array(scene.approach) @ terms.jacobian[:3][:, terms.arm]
    if (stiffness <= 0.0).any():
        return Hand(free.effective_mass_kg, note="a servo without stiffness: joints free")
    give = row / stiffness
    spring = 1.0 / float(row @ give)
    return Hand(
        free.effective_mass_kg,
        spring,
        spring**2 * float(give @ (damping * give)),
        note="servo joints: mass of free joints on the spring of the held ones",
    )
