"""What a sensor does from some trial on: another day, another amplifier."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.screen import FAINT
from spacerobot.diagnosis.fitting.starts import effect_starts
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.one_trial import promise, seen
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT
from spacerobot.diagnosis.terms.hypothesis import Believed, Site

FEWEST = 2
"""Trials before it and after it, at least: one alone is a trial's own affair."""

TRIED = 3
"""Effects that are fitted, those that promise most."""


def since(fitter: Fitter, believed: Believed, near: Fit, sites: tuple[Site, ...]) -> list[Task]:
    """Fits to make: a sensor's effect from one trial on, in the order in which they were taken.

    Each trial says for itself how strong the effect would be in it; where it begins is where a step explains that best.

    Args:
        fitter: of all trials.
        believed: what the study says.
        near: the best fit so far without it.
        sites: all that may be missing.
    """
    trials = seen(fitter, near)
    if len(trials) < 2 * FEWEST:
        return []
    found: list[tuple[float, Task]] = []
    for site in sites:
        if site.effect.kind != "sensor" or len(site.effect.parameters) > 1 or site.label in near.hypothesis.label:
            continue
        key, null = site.key(site.effect.strength.name), site.effect.strength.null
        if not np.isfinite(null):
            continue
        start = effect_starts([site])[0]
        faint = {key: null + FAINT * (start[key] - null)}
        gains, sizes = np.array([promise(fitter, believed, near, site, faint, t) for t in trials]).T
        weights = np.divide(gains, sizes**2, out=np.zeros_like(gains), where=sizes != 0.0)
        steps = []
        for k in range(FEWEST, len(trials) - FEWEST + 1):
            total = float(weights[k:].sum())
            mean = float(weights[k:] @ sizes[k:]) / total if total > 0.0 else 0.0
            steps.append((mean**2 * total, k, mean))
        if not steps:
            continue
        gain, k, mean = max(steps)
        if gain > WORTH_A_FIT:
            label = tuple(sorted((*near.hypothesis.label, site.label)))
            only = ((site.label, tuple(t.trial.id for t in trials[k:])),)
            size = {key: null + float(np.clip(mean, -1e3, 1e3)) * (faint[key] - null)}
            found.append((gain, Task(label, size, near=near, max_iterations=30, only=only)))
    return [task for _, task in sorted(found, key=lambda f: -f[0])[:TRIED]]
