"""What a well-made sensor does by itself is no missing physics: readings that end near half of their rate.

Before a signal is sampled it is cut off there, or it would be read wrongly. On a quiet channel a fit sees that as a
filter without delay. It is then taken as the sensor's own, as if the study had stated it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.nested_laws import inherited
from spacerobot.diagnosis.selection.search_state import Found, Report, run_tasks
from spacerobot.diagnosis.terms.candidates import exchanged
from spacerobot.diagnosis.terms.decision import MARGIN
from spacerobot.diagnosis.terms.hypothesis import Site
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
    tasks = []
    for site in _free_of_stated(workshop, fit):
        for new in workshop.model.in_forms(effect(site.effect.name), site.where):
            if new.effect.innate({p.name: p.null for p in new.effect.parameters}, _rate_of(workshop, site)):
                label = exchanged(fit.hypothesis.label, site.label, new.label)
                tasks.append(Task(label, inherited(new, site, fit), near=fit))
    run_tasks(pool, found, tasks, report, "filters that are a sensor's own")
    others = sorted((found.fits[t.label] for t in tasks if t.label in found.fits), key=lambda f: f.cost)
    return next((o for f in others if f.cost < fit.cost + MARGIN and (o := own_filters(workshop, f))), {})


def own_filters(workshop: Workshop, fit: Fit) -> dict[str, SensorFilter]:
    """Channel -> the filter of a fit that is its sensor's own."""
    found: dict[str, SensorFilter] = {}
    for site in _own(workshop, fit):
        plain = workshop.model.plain()
        added = site.effect.edit(plain, site.where, site.own(fit.values())).maps[len(plain.maps) :]
        found |= {m.channel: SensorFilter(m.value, *m.form) for m in added}
    return found


def own_labels(workshop: Workshop, fit: Fit) -> set[tuple[str, str]]:
    """The effects and places of a fit that are its sensors' own."""
    return {site.label for site in _own(workshop, fit)}


def with_filters(workshop: Workshop, filters: Mapping[str, SensorFilter]) -> Workshop:
    """The workshop of the same study, in which these are stated."""
    study = workshop.study
    for channel, own in filters.items():
        study = study.with_filter(channel, own)
    return Workshop(study, workshop.make_model)


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
    values, sites = fit.values(), _free_of_stated(workshop, fit)
    return [site for site in sites if site.effect.innate(site.own(values), _rate_of(workshop, site))]


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
