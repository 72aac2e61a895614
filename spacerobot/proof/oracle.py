"""The oracle: told what is hidden, it fits just that. What it cannot do, nobody can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import best, fit_from, fit_near, sized
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, folds
from spacerobot.diagnosis.selection.unseen import foretell, nothing_foretold
from spacerobot.diagnosis.terms.data import TrialData, trial_data
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import FORM
from spacerobot.effects.registry import effect
from spacerobot.effects.trend import SUFFIX, TREND
from spacerobot.recordings.study import load_study

Labels = Sequence[tuple[str, str]]


GOOD = 1.03
"""chi-squared per sample above which a fit is tried from another start."""

FAINT, GROWING = 0.1, 40
"""Share of its size at which a set begins to grow, and Gauss-Newton steps that it may take to."""

ITERATIONS = 8
"""Gauss-Newton steps of a fit that begins at one to more trials."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """One set of effects fitted to a study.

    Attributes:
        fit: to all trials.
        held_out: rms of the prediction of conditions not seen, in sensor sigmas; a trial's own start is found from the
            trial itself and its condition's scatter from the condition's other trials, as the diagnosis does it.
        channels: rms by channel, SI, where only the free approach tells how an unseen trial starts.
    """

    fit: Fit
    held_out: float
    channels: Mapping[str, float]


class Bench:
    """A study on the bench: any set of effects fitted, and judged on conditions that the fit has not seen."""

    def __init__(self, folder: Path) -> None:
        self.study = load_study(folder)
        self.trials = trial_data(self.study)
        self.model = RigModel(self.study, self.trials)
        self._done: dict[tuple[tuple[tuple[str, str], tuple[str, ...]], ...], Fitted] = {}

    def fitted(
        self,
        labels: Labels,
        starts: Mapping[str, float] | None = None,
        only: Mapping[tuple[str, str], tuple[str, ...]] | None = None,
    ) -> Fitted:
        """The effects of these names and places fitted from a start; made once for each set.

        Args:
            labels: effects and places.
            starts: start values by key.
            only: in which trials alone an effect acts.

        Raises:
            SimulationError: the start cannot be simulated.
        """
        some = only or {}
        key = tuple((label, some.get(label, ())) for label in sorted(labels))
        if key not in self._done:
            sites = [Site(effect(name), where, trials) for (name, where), trials in key]
            fit = self._fit(sites, dict(starts or {}))
            held_out, channels = self._held_out(fit)
            self._done[key] = Fitted(fit, held_out, channels)
        return self._done[key]

    def _fit(self, sites: Sequence[Site], starts: dict[str, float]) -> Fit:
        """From absorbing constants as stated or told; where effects take over from them, from zero too.

        Where neither explains the trials, grown from little beside the baseline as well: what moves every track, as a
        filter does, is far from where the free approaches lead.
        """
        fitter, believed = Fitter(self.model, self.trials), self.model.believed
        stated = {name: believed.values[name] for name in believed.absorbing if name in believed.values}
        first = fit_from(fitter, believed, sites, {**stated, **starts})
        takes_over = any(name in stated for s in sites for name in s.effect.replaced(s.where))
        if not sites or (first.chi2 < GOOD * first.samples and not takes_over):
            return first
        second = fit_from(fitter, believed, sites, {k: v for k, v in starts.items() if k not in stated})
        better = best([first, second])
        told = all(s.key(p.name) in starts for s in sites for p in s.effect.parameters)
        if not told or better.chi2 < GOOD * better.samples:
            return better
        faint = dict(starts)
        for site in sites:
            faint = sized(site, faint, FAINT)
        grown = fit_near(fitter, believed, sites, self.fitted(()).fit, faint, max_iterations=GROWING)
        return best([better, grown])

    def _held_out(self, fit: Fit) -> tuple[float, dict[str, float]]:
        """Leave one condition out in turn: fit the others from here, predict what was left out, in both ways."""
        total, samples = 0.0, 0
        errors: dict[str, list[np.ndarray]] = {}
        for _, unseen in folds(self.trials, MOST_FOLDS):
            seen = [t for t in self.trials if t.id not in unseen]
            own = {t.id: fit.initials()[t.id] for t in seen}
            part = Fitter(self.model, seen).fit(
                fit.hypothesis, warm=fit.values(), initials=own, max_iterations=ITERATIONS
            )
            fitter = Fitter(self.model, [t for t in self.trials if t.id in unseen])
            told = foretell(self.model, part, fitter.trials)
            for trial in fitter.trials:
                found = told.residual(self.model, trial)
                row = nothing_foretold(trial) if found is None else found
                total += float(row @ row) + told.paid.get(trial.id, 0.0)
                samples += trial.samples
                for channel, error in self._approached(fitter, part, trial).items():
                    errors.setdefault(channel, []).append(error)
        rms = {c: float(np.sqrt(np.mean(np.concatenate(e) ** 2))) for c, e in errors.items()}
        return float(np.sqrt(total / max(samples, 1))), rms

    def _approached(self, fitter: Fitter, part: Fit, trial: TrialData) -> dict[str, np.ndarray]:
        """Channel -> error of the prediction [SI], the trial started from its free approach alone."""
        guess = fitter.guess()[trial.id]
        residual, keep = fitter.residual(part.hypothesis, part.z, trial, guess)
        start = self.model.approach_start(trial, guess, residual)
        residual, keep = fitter.residual(part.hypothesis, part.z, trial, start)
        found, row = {}, 0
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                rows = slice(row, row + block.time.size)
                row += block.time.size
                good = keep[rows]
                found[channel] = residual[rows][good] / block.weight[c][good]
        return found


def in_form(item: Mapping[str, object]) -> str:
    """The name under which an effect of a seal, or of a verdict, is fitted: that of its form."""
    stated = item.get("parameters", item)
    assert isinstance(stated, Mapping)
    name = str(item["effect"])
    if "order" in stated:
        order = stated["order"]["value"] if isinstance(stated["order"], Mapping) else stated["order"]
        name += f"{FORM}{order:g}_{item['kind']}"
    return name + SUFFIX if TREND in stated else name


def fitted_labels(effects: Sequence[Mapping[str, object]]) -> tuple[tuple[str, str], ...]:
    """(effect in its form, place) of each, sorted."""
    return tuple(sorted((in_form(e), str(e["where"])) for e in effects))


def only_of(effects: Sequence[Mapping[str, object]], trials: Sequence[str]) -> dict[tuple[str, str], tuple[str, ...]]:
    """In which trials alone effects act; a seal counts trials from 0, a verdict names them."""
    found = {}
    for item in effects:
        some = item.get("trials")
        if isinstance(some, Sequence) and some:
            found[in_form(item), str(item["where"])] = tuple(trials[t] if isinstance(t, int) else str(t) for t in some)
    return found


def starts_of(effects: Sequence[Mapping[str, object]]) -> dict[str, float]:
    """Start values by key from the effects of a seal, or of a verdict."""
    found: dict[str, float] = {}
    for item in effects:
        parameters = item.get("parameters", {k: v for k, v in item.items() if k not in ("effect", "where", "trials")})
        assert isinstance(parameters, Mapping)
        for name, value in parameters.items():
            number = value.get("value") if isinstance(value, Mapping) else value
            if isinstance(number, int | float):
                found[f"{in_form(item)}@{item['where']}.{name}"] = float(number)
    return found
