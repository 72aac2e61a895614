"""The chosen model as a scene that `spacerobot simulate` runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.rig_scene import rig_scene
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.filters import PLAIN
from spacerobot.effects.trend import Trend
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.scene import Scene


def _as_it_is(site: Site, free: Mapping[str, float], number: int) -> EffectAt:
    """An effect with its fitted values; one that changes over the trials as strong as it is in this one."""
    values = site.own(free)
    if isinstance(site.effect, Trend):
        return EffectAt(site.effect.steady.name, site.where, site.effect.in_trial(values, number))
    return EffectAt(site.effect.name, site.where, values)


def _own_filters(model: RigModel) -> Iterator[EffectAt]:
    """The filter that a sensor is known to have on all its channels."""
    own = {m.channel: (m.value, *m.form) for m in model.filters}
    for sensor, channels in model.sensors.items():
        known = {own.get(channel) for channel in channels}
        if len(known) == 1 and (stated := known.pop()) is not None:
            cutoff, order, kind = stated
            yield EffectAt(PLAIN, sensor, {"cutoff_Hz": cutoff, "order": order, "kind": kind})


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
    names = model.names(study)
    base = {n: v for n, v in study.values().items() if n in names}
    overrides = {n: v for n, v in chosen.overrides.items() if n in names}
    values = fit.hypothesis.trial_values(fit.z, {**model.base, **base}, study.condition(chosen), overrides)
    free = fit.values()
    effects = (*_own_filters(model), *(_as_it_is(s, free, numbers[trial]) for s in fit.hypothesis.acting(trial)))
    data = model.trial(chosen.id)
    mechanism = model.trial_mechanism(fit.hypothesis, fit.z, data)
    title = f"{study.title}, trial {chosen.id}, as diagnosed"
    return rig_scene(study, model, data, values, mechanism, fit.trials[chosen.id].initial, effects, title)
