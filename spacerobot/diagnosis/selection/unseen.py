"""Prediction of trials that a fit has not seen, and what has to be taken from these trials themselves.

A trial's own start can be known from nothing else: it is found from all readings of the trial that is predicted. What
a condition has of its own (a spring that was put on anew) is found from its other trials. Where it has none, it is
found from the trial itself under its prior, and what that costs is counted: the least of chi-squared plus prior is the
chi-squared of the prediction with the condition's own marginalised, r^T (1 + J J^T)^-1 r.

Where bodies meet, a touch more or less may hang on values finer than the other trials tell them. A trial that is not
predicted at these values, and is within what the others leave open of them, is predicted there; that costs what it is
off by, in the others' own covariance, and what the trial itself tells of the values: ln det of it, before over after.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.workshop import Only
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import EARN
from spacerobot.diagnosis.terms.hypothesis import Hypothesis, Label, Site, hypothesis
from spacerobot.effects.registry import effect
from spacerobot.support.errors import InputError, SimulationError

STEPS = 20
"""Gauss-Newton steps to a trial's start; it moves the track nearly in proportion, and few are taken."""

WITHIN = 0.999
"""Probability of the region about the others' values that is within what they leave open: in one trial of a thousand a
model that is right has its values outside.
"""

NOT_FITTED = "could not be fitted to the other trials"


@dataclass(frozen=True)
class Foretold:
    """What a set of effects says of trials that it was not fitted to: all that a simulation of them needs.

    Attributes:
        label: effects and places.
        only: in which of the trials that were fitted an effect acted alone.
        freed: believed values that were set free.
        values: fitted to the other trials, by key.
        starts: initial values by trial, found from the trial itself, shape (N,).
        own: by trial, what its condition has of its own, or all values where the others leave them open.
        paid: by trial, what that costs where it was found from the trial itself.
        failed: by trial, why it could not be simulated.
    """

    label: Label
    only: Only = ()
    freed: tuple[str, ...] = ()
    values: Mapping[str, float] = field(default_factory=dict)
    starts: Mapping[str, np.ndarray] = field(default_factory=dict)
    own: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    paid: Mapping[str, float] = field(default_factory=dict)
    failed: Mapping[str, str] = field(default_factory=dict)

    def residual(self, model: RigModel, trial: TrialData) -> np.ndarray | None:
        """Weighted residual of a trial, shape (S,), zero where masked; None where it cannot be simulated."""
        if trial.id not in self.starts:
            return None
        some = dict(self.only)
        sites = [model.site(effect(n), w, some.get((n, w), ())) for n, w in self.label]
        values = {**self.values, **self.own.get(trial.id, {})}
        made = hypothesis(model.believed.free_of(self.freed), sites, values)
        raw, keep = Fitter(model, [trial]).residual(made, made.start(values), trial, self.starts[trial.id])
        return np.where(keep, raw, 0.0)


def frozen(made: Hypothesis, values: Mapping[str, float], free: tuple[str, ...]) -> Hypothesis:
    """The hypothesis with all but some parameters held at given values."""
    held = tuple(
        f if f.key in free else replace(f, lower=values[f.key], upper=values[f.key], prior=0.0) for f in made.free
    )
    return replace(made, free=held)


def nothing_foretold(trial: TrialData) -> np.ndarray:
    """Weighted residual where nothing is predicted but each channel's mean, shape (S,).

    What a trial counts for that a set cannot simulate: the worst that a prediction should be, and a finite one.
    """
    parts = []
    for block in trial.blocks:
        good = block.weight > 0.0
        mean = np.sum(block.value, axis=1, where=good) / np.maximum(good.sum(axis=1), 1)
        parts.append(((mean[:, None] - block.value) * block.weight).ravel())
    return np.concatenate(parts)


def foretell(model: RigModel, fit: Fit | None, unseen: Sequence[TrialData]) -> Foretold:
    """Predict trials by a fit to others; None for a set that could not be fitted to these."""
    if fit is None:
        return Foretold((), failed={t.id: NOT_FITTED for t in unseen})
    starts: dict[str, np.ndarray] = {}
    own: dict[str, dict[str, float]] = {}
    paid: dict[str, float] = {}
    failed: dict[str, str] = {}
    for trial in unseen:
        try:
            starts[trial.id], own[trial.id], paid[trial.id] = _one(model, fit, trial, unseen)
        except (SimulationError, InputError) as error:
            failed[trial.id] = str(error)
    made = fit.hypothesis
    return Foretold(made.label, made.only, made.freed, fit.values(), starts, own, paid, failed)


_Told = tuple[np.ndarray, dict[str, float], float]
"""A trial's start, its own values, and what these cost."""


def _one(model: RigModel, fit: Fit, trial: TrialData, unseen: Sequence[TrialData]) -> _Told:
    """How a trial is predicted by a fit to others."""
    values = fit.values()
    keys = tuple(_own_keys(fit.hypothesis, trial))
    others = [t for t in unseen if t.condition == trial.condition and t.id != trial.id]
    if keys and others:
        told = Fitter(model, others).fit(
            frozen(fit.hypothesis, values, keys), warm=values, max_iterations=STEPS, robust=False
        )
        values = {**values, **{k: told.values()[k] for k in keys}}
    free = () if others else keys
    found = Fitter(model, [trial]).fit(
        frozen(fit.hypothesis, values, free), warm=values, max_iterations=STEPS, robust=False
    )
    own = {k: found.values()[k] for k in keys}
    plain = found.trials[trial.id].initial, own, found.prior
    # a curve says nothing where no other trial has been: there it would tell a trial by itself
    if found.cost < found.samples + EARN or any(s.effect.learned for s in fit.hypothesis.sites):
        return plain
    within = _left_open(model, fit, trial, {**values, **own}, plain[0])
    return plain if within is None or within[1] > found.cost - EARN else within[0]


def _left_open(
    model: RigModel, fit: Fit, trial: TrialData, values: Mapping[str, float], start: np.ndarray
) -> tuple[_Told, float] | None:
    """A trial predicted within what the others leave open, and the prediction's cost; None where nothing tells that."""
    if fit.covariance is None:
        return None
    try:
        made = fit.hypothesis.about(fit.z, fit.covariance)
    except np.linalg.LinAlgError:
        return None
    fitter = Fitter(model, [trial])
    found = fitter.fit(made, warm=values, initials={trial.id: start}, max_iterations=STEPS, robust=False)
    if found.covariance is None or chi2.sf(found.prior, found.z.size) < 1.0 - WITHIN:
        return None
    _, before = np.linalg.slogdet(fit.covariance)
    _, after = np.linalg.slogdet(found.covariance)
    paid = found.prior + max(float(before - after), 0.0)
    return (found.trials[trial.id].initial, found.values(), paid), found.chi2 + paid


def _own_keys(made: Hypothesis, trial: TrialData) -> Iterator[str]:
    for f in made.free:
        if f.kind == "scatter" and f.key.split("|", 1)[0] == trial.condition:
            yield f.key


def seen_sites(sites: Sequence[Site], unseen: Sequence[str]) -> list[Site]:
    """The sites but for those that act in unseen trials alone: no other trial can foretell a knock in one."""
    left = [replace(s, trials=tuple(t for t in s.trials if t not in unseen)) if s.trials else s for s in sites]
    return [new for new, old in zip(left, sites, strict=True) if new.trials or not old.trials]
