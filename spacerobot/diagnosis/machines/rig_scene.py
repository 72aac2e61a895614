"""A trial of a rig as a scene that `spacerobot simulate` runs: the whole robot, at the values and start of a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.machines.rig_values import together
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.contact import ContactLaw
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.parts.target import Target
from spacerobot.simulation.parts.wrist import Wrist
from spacerobot.simulation.rig import DEFAULTS
from spacerobot.simulation.scene import Scene


def rig_scene(
    study: Study,
    model: RigModel,
    trial: TrialData,
    values: Mapping[str, float],
    mechanism: Mechanism,
    initial: np.ndarray,
    effects: Sequence[EffectAt] = (),
    title: str = "",
) -> Scene:
    """The scene of one trial.

    Args:
        study: what the lab believes.
        model: the rig.
        trial: which.
        values: of the rig in this trial, by name.
        mechanism: of this trial with its effects: they may have moved the contact point.
        initial: one value a nuisance of the trial.
        effects: what acts beside the baseline.
        title: one line.
    """
    values = together({**DEFAULTS, **values})
    chosen = study.trial(trial.recorded)
    start = {(n.coordinate, n.rate): float(v) for n, v in zip(model.nuisances(trial), initial, strict=True)}
    ahead, lateral = values["target.contact_point.ahead"], values["target.contact_point.lateral"]
    yaw = start.get(("target.yaw", False), 0.0)
    assert mechanism.contact is not None
    turned, _ = mechanism.contact.turned(yaw)  # of the point as effects have moved it
    inertia = values["target.yaw_inertia"]
    scene = Scene(
        pose=study.pose(chosen),
        approach=study.baseline.approach,
        gravity=study.baseline.gravity,
        wrist=Wrist(
            mass=values["wrist.mass"],
            stiffness=values["wrist.stiffness"],
            damping=values["wrist.damping"],
            equivalent_damping=values["wrist.equivalent_damping"],
        ),
        contact=ContactLaw(stiffness=values["contact.stiffness"], damping=values["contact.damping"]),
        target=Target(
            mass=values["target.mass"],
            yaw_inertia=inertia if inertia == inertia else None,
            contact_point=(ahead, lateral, 0.0),
            attitude=(0.0, 0.0, yaw),
            speed=start["target", True],
            drift=start.get(("target.y", True), 0.0),
            gap=max(float(-start["target", False] - turned), 0.0),
        ),
        duration=trial.end - trial.start,
        effects=tuple(effects),
        title=title,
        **model.robot_in(study, values, trial, initial),
    )
    spin = start.get(("target.yaw", True), 0.0)
    up = scene.axes[:, 2]
    return replace(scene, target=replace(scene.target, spin=tuple(float(spin * a) for a in up))) if spin else scene
