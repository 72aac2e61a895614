"""Servos that hold an arm against gravity: deflected from the start by what they carry there."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force
from spacerobot.simulation.multibody.assembly import Assembly
from spacerobot.simulation.multibody.ports import PULL
from spacerobot.simulation.scene import Scene


def balanced(scene: Scene, mechanism: Mechanism, assembly: Assembly) -> Mechanism:
    """The mechanism with the load that its servos carry at the start, payloads and riders included.

    The pose of a scene is where the arm stands, so its servos aim beyond it by load over stiffness. On a free base
    everything falls alike and nothing is carried; a servo without stiffness carries nothing.
    """
    if scene.servo is None or scene.base == "free" or not np.any(assembly.model.gravity.linear):
        return mechanism
    model = assembly.model
    weight = pin.computeGeneralizedGravity(model, model.createData(), assembly.start)
    loads = []
    chain = scene.prepared.chain
    for joint, (stiffness, _) in zip(chain, scene.servo.per_joint(chain), strict=True):
        name = f"joint.{joint}"
        load = float(weight[model.joints[assembly.joints[name]].idx_v])
        if stiffness > 0.0 and load:
            loads.append(Force(f"{name}.servo_load", name, PULL, (load,)))
    return mechanism.with_force(*loads)
