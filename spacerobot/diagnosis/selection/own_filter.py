"""What a well-made sensor does by itself is no missing physics: readings that end near half of their rate.

Before a signal is sampled it is cut off there, or it would be read wrongly. On a quiet channel a fit sees that as a
filter without delay. It is then taken as the sensor's own, as if the study had stated it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.beyond import AGAIN
from spacerobot.diagnosis.selection.search_state import Found, Report, implausible_of, noise_of, run_tasks
from spacerobot.diagnosis.terms.decision import MARGIN
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.effects.effect import FORM
from spacerobot.effects.registry import effect
from spacerobot.recordings.sensor_filter import SensorFilter
from spacerobot.recordings.study import Study


def sought(pool: Pool, found: Found, fit: Fit, report: Report) -> dict[str, SensorFilter]:
    """Channel -> the filter that is its sensor's own, of a fit or of another that no more costs than it.

    A faint filter without delay is told from a late one by little: the sensor's own is there in any case.

    Args:
        pool: of the rig.
        found: by the search; takes what is fitted.
        fit: the chosen set.
        report: told of progress.
    """
    workshop = pool.workshop
    own = own_filters(workshop, fit)
    if own:
        return own
    tasks = [
        Task(tuple(sorted(new.label if one == site.label else one for one in fit.hypothesis.label)), start, near=fit)
        for site in _free_of_stated(workshop, fit)
        for form in site.effect.forms
        for new in [workshop.model.site(effect(site.effect.name + FORM + form), site.where)]
        if new.effect.innate({p.name: p.null for p in new.effect.parameters}, _rate_of(workshop, site))
        for start in [{new.key(p.name): fit.values()[site.key(p.name)] for p in site.effect.parameters}]
    ]
    run_tasks(pool, found, tasks, report, "filters that are a sensor's own")
    others = sorted((found.fits[t.label] for t in tasks if t.label in found.fits), key=lambda f: f.cost)
    return next((o for f in others if f.cost < fit.cost + MARGIN and (o := own_filters(workshop, f))), {})


def own_filters(workshop: Workshop, fit: Fit) -> dict[str, SensorFilter]:
    """Channel -> the filter of a fit that is its sensor's own."""
    plain = workshop.model.plain()
    found: dict[str, SensorFilter] = {}
    for site in _own(workshop, fit):
        values = {p.name: fit.values()[site.key(p.name)] for p in site.effect.parameters}
        added = site.effect.edit(plain, site.where, values).maps[len(plain.maps) :]
        found |= {m.channel: SensorFilter(m.value, *m.form) for m in added}
    return found


def with_filters(workshop: Workshop, filters: Mapping[str, SensorFilter]) -> Workshop:
    """The workshop of the same study, in which these are stated."""
    study = workshop.study
    for channel, own in filters.items():
        study = study.with_filter(channel, own)
    return Workshop(study, workshop.make_model)


def beside(pool: Pool, found: Found, before: Workshop, report: Report) -> Found:
    """The baseline and the best sets of a search fitted again, without the filters that are their sensors' own.

    Args:
        pool: of the workshop in which these are stated.
        found: by the search, before they were.
        before: its workshop.
        report: told of progress.
    """
    fits = sorted(found.fits.values(), key=lambda f: f.cost)[:AGAIN]
    rest: dict[Label, Fit] = {}
    for fit in fits:
        own = {site.label for site in _own(before, fit)}
        rest.setdefault(tuple(x for x in fit.hypothesis.label if x not in own), fit)
    base = pool.here(Task((), {}, near=rest.pop((), found.baseline)))
    workshop = pool.workshop
    new = replace(
        found,
        baseline=found.baseline if base is None else base,
        fits={},
        noise=noise_of(workshop),
        implausible=implausible_of(workshop),
    )
    tasks = [Task(label, {}, near=fit) for label, fit in rest.items()]
    run_tasks(pool, new, tasks, report, "the best sets, beside the sensor's own filter")
    return new


def told(study: Study, workshop: Workshop) -> list[str]:
    """What is said of sensors' own filters that a study does not state, a sentence each."""
    return [
        f"{channel} ends at {own.cutoff:.4g} Hz, near half of the rate at which it is read: taken as its sensor's own"
        f" filter, not as missing physics; to state it, filter = {{ cutoff = {own.cutoff:.4g}, order = {own.order}, "
        f'kind = "{own.kind}" }}'
        for channel, own in workshop.study.filters().items()
        if channel not in study.filters()
    ]


def _own(workshop: Workshop, fit: Fit) -> list[Site]:
    """The effects of a fit that are their sensors' own."""
    values = fit.values()
    return [
        site
        for site in _free_of_stated(workshop, fit)
        if site.effect.innate(
            {p.name: values[site.key(p.name)] for p in site.effect.parameters}, _rate_of(workshop, site)
        )
    ]


def _free_of_stated(workshop: Workshop, fit: Fit) -> list[Site]:
    """The effects of a fit at sensors of which no filter is stated, in all trials."""
    stated = workshop.study.filters().keys()
    sensors = {s for s, channels in workshop.model.sensors.items() if stated.isdisjoint(channels)}
    return [site for site in fit.hypothesis.sites if site.where in sensors and not site.trials]


def _rate_of(workshop: Workshop, site: Site) -> float:
    """The highest rate at which a sensor was read [1/s]."""
    channels = {*workshop.model.sensors[site.where]}
    times = [b.time for t in workshop.trials for b in t.blocks if channels & {*b.channels} and b.time.size > 1]
    return max((1.0 / float(np.median(np.diff(time))) for time in times), default=np.inf)
