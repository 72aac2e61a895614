"""The chosen model as a scene that `spacerobot simulate` runs."""

from __future__ import annotations

from spacerobot.diagnosis.fit import Fit
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.contact import ContactLaw
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.parts.target import Target
from spacerobot.simulation.parts.wrist import Wrist
from spacerobot.simulation.rig import DEFAULTS
from spacerobot.simulation.scene import Scene


def scene_of(study: Study, fit: Fit, trial: str | None = None) -> Scene:
    """The scene of one trial (the first if none is named), at the values and with the effects of a fit."""
    chosen = study.trial(trial) if trial is not None else study.trials[0]
    base = {n: v for n, v in study.values().items() if n in DEFAULTS}
    overrides = {n: v for n, v in chosen.overrides.items() if n in DEFAULTS}
    values = {**DEFAULTS, **fit.hypothesis.trial_values(fit.z, base, study.condition(chosen), overrides)}
    free = fit.values()
    effects = tuple(
        EffectAt(s.effect.name, s.where, {p.name: free[s.key(p.name)] for p in s.effect.parameters})
        for s in fit.hypothesis.sites
        if "mocap" not in s.where and s.effect.kind != "sensor"
    )
    yaw = values["target.yaw_inertia"]
    initial = fit.trials[chosen.id].initial
    return Scene(
        robot=study.robot_source or "pa10_wrist",
        base=study.baseline.base,
        joints=study.baseline.joints,
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
            yaw_inertia=yaw if yaw == yaw else None,
            contact_point=(values["target.contact_point.ahead"], values["target.contact_point.lateral"], 0.0),
            speed=float(abs(initial[1])),
            gap=float(max(-initial[0], 0.0)),
        ),
        duration=float(max(series.time[-1] for series in study.recording(chosen).outputs())),
        effects=effects,
        title=f"{study.title}, trial {chosen.id}, as diagnosed",
    )
