"""The chosen model as a scene that `spacerobot simulate` runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.wrist_rig import RigModel, together
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.trend import Trend
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.contact import ContactLaw
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.parts.target import Target
from spacerobot.simulation.parts.wrist import Wrist
from spacerobot.simulation.rig import DEFAULTS
from spacerobot.simulation.scene import Scene


def _as_it_is(site: Site, free: Mapping[str, float], number: int) -> EffectAt:
    """An effect with its fitted values; one that changes over the trials as strong as it is in this one."""
    values = {p.name: free[site.key(p.name)] for p in site.effect.parameters}
    if isinstance(site.effect, Trend):
        return EffectAt(site.effect.steady.name, site.where, site.effect.in_trial(values, number))
    return EffectAt(site.effect.name, site.where, values)


def scene_of(study: Study, model: RigModel, fit: Fit, trial: str | None = None) -> Scene:
    """The scene of one trial at the values, from the start and with the effects of a fit.

    Args:
        study: what the lab believes.
        model: that the fit was made with.
        fit: what was found.
        trial: which; if none is named, the first in which every effect acts, or the first of all.
    """
    numbers = {t.id: number for number, t in enumerate(study.trials) if t.id in fit.trials}
    if trial is None:
        sites = fit.hypothesis.sites
        trial = next((t for t in numbers if len(fit.hypothesis.acting(t)) == len(sites)), next(iter(numbers)))
    chosen = study.trial(trial)
    base = {n: v for n, v in study.values().items() if n in DEFAULTS}
    overrides = {n: v for n, v in chosen.overrides.items() if n in DEFAULTS}
    values = together(
        {**DEFAULTS, **fit.hypothesis.trial_values(fit.z, {**model.base, **base}, study.condition(chosen), overrides)}
    )
    free = fit.values()
    effects = tuple(_as_it_is(s, free, numbers[trial]) for s in fit.hypothesis.acting(trial))
    data = model.trial(chosen.id)
    start = {
        (n.coordinate, n.rate): float(v)
        for n, v in zip(model.nuisances(data), fit.trials[chosen.id].initial, strict=True)
    }
    ahead, lateral = values["target.contact_point.ahead"], values["target.contact_point.lateral"]
    yaw = start.get(("target.yaw", False), 0.0)
    contact = model.trial_mechanism(fit.hypothesis, fit.z, data).contact
    assert contact is not None
    turned, _ = contact.turned(yaw)  # of the point as effects have moved it
    inertia = values["target.yaw_inertia"]
    scene = Scene(
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
            yaw_inertia=inertia if inertia == inertia else None,
            contact_point=(ahead, lateral, 0.0),
            attitude=(0.0, 0.0, yaw),
            speed=start["target", True],
            drift=start.get(("target.y", True), 0.0),
            gap=max(float(-start["target", False] - turned), 0.0),
        ),
        duration=data.end - data.start,
        effects=effects,
        title=f"{study.title}, trial {chosen.id}, as diagnosed",
    )
    spin = start.get(("target.yaw", True), 0.0)
    up = scene.axes[:, 2]
    return replace(scene, target=replace(scene.target, spin=tuple(float(spin * a) for a in up))) if spin else scene
