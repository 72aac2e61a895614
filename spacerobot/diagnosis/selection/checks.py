"""A fit's own checks, of a wrist rig or of a part; where one fails, nothing is concluded."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.profile import LEVEL_95, profile_interval
from spacerobot.diagnosis.fitting.starts import effect_starts
from spacerobot.diagnosis.fitting.workshop import Only, Task, Workshop
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.candidate import words
from spacerobot.diagnosis.selection.check import Check, agreed
from spacerobot.diagnosis.selection.nameable import implausible, nameable
from spacerobot.diagnosis.selection.search_state import effect_values
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import FRACTION, MISSED, ROUGH, SLACK
from spacerobot.support.errors import SimulationError

SECOND = 2
"""Seeds from one copy's to the next: each may need a second copy of its own."""

WIDER = 2.0
"""Half width of such an interval, in what the copy missed by."""

STEPS = 30
"""Of each fit that goes on with a copy where another has ended."""

AWAY = 0.5
"""A part's copy is fitted from every strength at this share of its value."""


def nested(fits: Iterable[Fit], chosen: Fit) -> Check:
    """A model with an effect more never costs more than the one without."""
    bad = []
    chosen_label = set(chosen.hypothesis.label)
    for fit in fits:
        less = set(fit.hypothesis.label) < chosen_label and set(fit.hypothesis.freed) <= set(chosen.hypothesis.freed)
        if less and fit.cost < chosen.cost - SLACK:
            bad.append(fit.hypothesis.label)
    detail = "no smaller model costs less" if not bad else f"a smaller model costs less: {words(bad[0])}"
    return Check("nested cost", not bad, detail)


def copied(model: Machine, trials: Sequence[TrialData], fit: Fit, seed: int) -> tuple[TrialData, ...]:
    """The trials as the fit shows them, with white noise as their weights state it."""
    random = np.random.default_rng(seed)
    out = []
    for trial in trials:
        mechanism = model.trial_mechanism(fit.hypothesis, fit.z, trial)
        shown = model.predict(mechanism, trial, fit.trials[trial.id].initial)
        blocks = []
        for block, value in zip(trial.blocks, shown.blocks, strict=True):
            good = block.weight > 0.0
            sigma = np.where(good, 1.0 / np.where(good, block.weight, 1.0), 0.0)
            blocks.append(replace(block, value=value + sigma * random.standard_normal(value.shape)))
        out.append(replace(trial, blocks=tuple(blocks)))
    return tuple(out)


def cost_of(truth: Fit, fitter: Fitter) -> float | None:
    """What the model that a copy was made from costs on it; None where it cannot be simulated there."""
    state = fitter.state(truth.hypothesis, truth.z, truth.initials())
    return None if state is None else state.chi2() + float(state.z @ truth.hypothesis.precision @ state.z)


def at_truth(again: Fit, truth: float, lead: float = 0.0) -> Check:
    """Whether the fit of a copy ends no worse than what the copy was made from; `lead` as in `synthetic`."""
    passed = again.cost <= truth + max(SLACK, FRACTION * lead)
    return Check(
        "cost at truth", bool(passed), f"on a synthetic copy the fit costs {again.cost:.1f}, its truth {truth:.1f}"
    )


NO_COPY = Check("cost at truth", False, "a synthetic copy could not be simulated")


def synthetic(workshop: Workshop, chosen: Fit, lead: float = 0.0) -> list[Check]:
    """On a copy of the study made from the chosen model, the fit ends no worse than the truth, and near it.

    The copies' noise is always the same: what is concluded hangs on no seed.

    Args:
        workshop: of the study.
        chosen: the model.
        lead: by how much the chosen model's cost is below its nearest rival's; a fit of the copy that stops short of
            the truth by less than FRACTION of it, in one of the many minima that bounces make, endangers no verdict.
    """
    return list(agreed(lambda copy: _on_copy(workshop, chosen, SECOND * copy, lead)))


def _on_copy(workshop: Workshop, chosen: Fit, seed: int, lead: float) -> list[Check]:
    done = _copied_fit(workshop, chosen, seed)
    if done is None:
        return [NO_COPY]
    fitter, again, truth = done
    cost = at_truth(again, truth, lead)
    first = calibration(chosen, again, interval=lambda key: profile_interval(fitter, again, key, 1.0))
    if first.passed or first.worst > ROUGH:
        return [cost, first]
    missed = misses(chosen, again)
    second = _copied_fit(workshop, chosen, seed + 1)
    if second is None:
        return [cost, first]
    then = calibration(chosen, second[1], known=missed)
    if then.passed:
        said = f"{first.detail}: interval widened to that, and right on a second copy"
        return [cost, replace(first, passed=True, detail=said, missed=missed)]
    return [cost, first]


def _copied_fit(workshop: Workshop, chosen: Fit, seed: int) -> tuple[Fitter, Fit, float] | None:
    """A synthetic copy of the study fitted: (its fitter, the fit, cost of the truth); None where that cannot be."""
    copy = Workshop(workshop.study, workshop.make_model)
    copy.trials = copied(workshop.model, workshop.trials, chosen, seed)
    copy.model = workshop.make_model(workshop.study, copy.trials)
    fitter: Fitter = copy.fitter()
    truth = cost_of(chosen, fitter)
    start = {f.key: f.centre for f in chosen.hypothesis.free if f.kind == "effect" and f.log}
    start = {**effect_values(chosen), **start}
    only = chosen.hypothesis.only
    again = copy.run(Task(chosen.hypothesis.label, start, only=only, freed=chosen.hypothesis.freed))
    if truth is None or again is None:
        return None

    def rank(fit: Fit) -> tuple[bool, float]:
        return _refused(fit, workshop.model), fit.cost

    for task in _other_starts(copy, chosen, again, only):  # a search begins more than once too
        if rank(again) <= (False, truth + SLACK):
            break
        other = copy.run(task)
        if other is not None and rank(other) < rank(again):
            again = other
    return fitter, again, truth


def _refused(fit: Fit, model: Machine) -> bool:
    """Whether a search would pass by a fit: its numbers are not what its effects' names say."""
    return not nameable(fit) or bool(implausible(fit.hypothesis.sites, fit.values(), model.size_at))


def _other_starts(copy: Workshop, chosen: Fit, ended: Fit, only: Only) -> Iterator[Task]:
    """Where else a fit of the copy begins: where the first one ended, the effects' own starts, their true values, and
    as a search finds them: beside the fit without effects, and one effect after the other.
    """
    label, freed = chosen.hypothesis.label, chosen.hypothesis.freed
    yield Task(label, {}, near=ended, max_iterations=STEPS, freed=freed)
    for start in effect_starts(chosen.hypothesis.sites)[:2]:
        yield Task(label, start, only=only, freed=freed)
    values = effect_values(chosen)
    yield Task(label, values, only=only, freed=freed)
    plain = copy.run(Task((), {}, freed=freed))
    if plain is not None:
        yield Task(label, values, near=plain, max_iterations=STEPS, only=only, freed=freed)
    for one in label if len(label) > 1 else ():
        alone = copy.run(Task((one,), {}, near=_part(chosen, one), only=only, freed=freed))
        if alone is not None:
            yield Task(label, values, near=alone, max_iterations=STEPS, only=only, freed=freed)


def _part(fit: Fit, one: tuple[str, str]) -> Fit:
    """A fit without all but one of its effects."""
    made = fit.hypothesis
    keys = {s.key(p.name) for s in made.sites if s.label != one for p in s.effect.parameters}
    kept = [k for k, f in enumerate(made.free) if f.key not in keys]
    sites = tuple(s for s in made.sites if s.label == one)
    return replace(fit, hypothesis=replace(made, sites=sites, free=tuple(made.free[k] for k in kept)), z=fit.z[kept])


def checks_of_part(model: Machine, trials: Sequence[TrialData], base: Fit, chosen: Fit) -> tuple[Check, ...]:
    """Whether more freedom costs more, and whether a synthetic copy of a part's model is fitted as well as it is.

    Args:
        model: of the part.
        trials: of the part, under the weights of its fits.
        base, chosen: what was fitted to them, without any effect and as chosen.
    """
    if not chosen.hypothesis.sites:
        return ()
    checks = (nested([base], chosen), *agreed(lambda copy: _on_copy_of_part(model, trials, chosen, copy)))
    return tuple(replace(c, name=f"{c.name}, {model.name}") for c in checks)


def _on_copy_of_part(model: Machine, trials: Sequence[TrialData], chosen: Fit, seed: int) -> list[Check]:
    """As `_on_copy`, of a part, whose fits begin from afar.

    Where that ends in another minimum, as with a resonance, they begin at the true values too: a search that found
    these began at many places.
    """
    trials = copied(model, trials, chosen, seed)
    fitter = Fitter(model, trials)
    truth = cost_of(chosen, fitter)
    again = _on(fitter, chosen, _away(chosen))
    if truth is None or again is None:
        return [NO_COPY]
    if again.cost > truth + SLACK:  # once more from where it ended, as fits that grow are
        more = _on(fitter, again, again.values())
        again = more if more is not None and more.cost < again.cost else again
    if again.cost > truth + SLACK:
        again = _to_the_last_digit(model, trials, again)
    if again.cost > truth + SLACK or _refused(again, model):
        again = _on(fitter, chosen, chosen.values()) or again
    sizes = calibration(chosen, again)
    if not sizes.passed:
        sizes = calibration(chosen, _to_the_last_digit(model, trials, again))
    return [at_truth(again, truth), sizes]


def _on(fitter: Fitter, near: Fit, warm: Mapping[str, float], steps: int = STEPS) -> Fit | None:
    """A fit's hypothesis from these values; None where it cannot be simulated."""
    with contextlib.suppress(SimulationError):
        return fitter.fit(near.hypothesis, warm=warm, initials=near.initials(), max_iterations=steps, robust=False)
    return None


def _to_the_last_digit(model: Machine, trials: Sequence[TrialData], ended: Fit) -> Fit:
    """Differences to one side lead to a place beside the best one; those to both sides do not."""
    return _on(Fitter(model, trials, careful=True), ended, ended.values(), STEPS // 2) or ended


def _away(fit: Fit) -> dict[str, float]:
    out = fit.values()
    for site in fit.hypothesis.sites:
        for parameter in site.effect.parameters:
            key = site.key(parameter.name)
            if not parameter.shape and not parameter.log and np.isfinite(parameter.null):
                out[key] = parameter.null + AWAY * (out[key] - parameter.null)
    return out


def misses(truth: Fit, again: Fit) -> dict[str, float]:
    """Effects' key -> what a fit of a copy missed its size by, in units of the parameter's scale."""
    sizes = truth.values()
    return {
        f.key: float(abs(z - f.z(sizes[f.key])))
        for f, z in zip(again.hypothesis.free, again.z, strict=True)
        if f.kind == "effect" and f.key in sizes
    }


def widened(fit: Fit, key: str, interval: tuple[float, float], missed: float) -> tuple[float, float]:
    """An interval that also holds what a synthetic copy says of the cost's further minima; never a narrower one."""
    index = fit.hypothesis.keys.index(key)
    free, best = fit.hypothesis.free[index], float(fit.z[index])
    low, high = free.bounds
    ends = [free.value(min(max(best + side * WIDER * missed, low), high)) for side in (-1.0, 1.0)]
    return min(*ends, interval[0]), max(*ends, interval[1])


def calibration(
    truth: Fit,
    again: Fit,
    interval: Callable[[str], tuple[float, float]] | None = None,
    known: Mapping[str, float] = MappingProxyType({}),
) -> Check:
    """Whether the effects' sizes that a synthetic copy was made with lie where the fit of it claims.

    Args:
        truth: what the copy was made from.
        again: fitted to the copy.
        interval: 95 % interval of a key, asked for where the curvature alone claims too much: a verdict states it.
        known: least standard errors by key, in units of the parameter's scale.
    """
    sizes = truth.values()
    worst, key = 0.0, ""
    covariance = again.covariance
    errors = np.zeros(again.z.size) if covariance is None else np.sqrt(np.maximum(np.diag(covariance), 0.0))
    for free, z, curved in zip(again.hypothesis.free, again.z, errors, strict=True):
        error = max(float(curved), known.get(free.key, 0.0))
        if free.kind == "effect" and free.key in sizes and error > 0.0:
            wanted = free.z(sizes[free.key])
            off = abs(z - wanted) / error
            if off > MISSED and interval is not None:
                end = max((free.z(v) for v in interval(free.key)), key=lambda e: (e - z) * (wanted - z))
                off = abs(z - wanted) / max(error, abs(end - z) / math.sqrt(LEVEL_95))
            if off > worst:
                worst, key = float(off), free.key
    said = f"{key} {worst:.1f} standard errors" if key else "nothing"
    return Check("calibration", bool(worst <= MISSED), f"on a synthetic copy {said} off what it was made with", worst)
