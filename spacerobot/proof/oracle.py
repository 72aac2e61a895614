"""The oracle: told what is hidden, it fits just that. What it cannot do, nobody can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spacerobot.diagnosis.data import trial_data
from spacerobot.diagnosis.fit import Fit, Fitter
from spacerobot.diagnosis.hypothesis import Site
from spacerobot.diagnosis.rig_model import RigModel
from spacerobot.diagnosis.starts import fit_from
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study

Labels = Sequence[tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Fitted:
    """One set of effects fitted to a study.

    Attributes:
        fit: to all trials.
        held_out: rms of the prediction of conditions not seen, in sensor sigmas.
        channels: the same by channel, SI.
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
        self._done: dict[tuple[tuple[str, str], ...], Fitted] = {}

    def fitted(self, labels: Labels, starts: Mapping[str, float] | None = None) -> Fitted:
        """The effects of these names and places fitted from a start; made once for each set.

        Raises:
            SimulationError: the start cannot be simulated.
        """
        key = tuple(sorted(labels))
        if key not in self._done:
            sites = [Site(effect(name), where) for name, where in key]
            fit = fit_from(Fitter(self.model, self.trials), self.model.believed, sites, dict(starts or {}))
            held_out, channels = self._held_out(fit)
            self._done[key] = Fitted(fit, held_out, channels)
        return self._done[key]

    def _held_out(self, fit: Fit) -> tuple[float, dict[str, float]]:
        """Leave one condition out: fit the others from here, then start each unseen trial from its free approach."""
        squares: dict[str, float] = {}
        counts: dict[str, int] = {}
        total, samples = 0.0, 0
        for _, unseen in self._folds():
            seen = [t for t in self.trials if t.id not in unseen]
            own = {t.id: fit.initials()[t.id] for t in seen}
            part = Fitter(self.model, seen).fit(fit.hypothesis, warm=fit.values(), initials=own, max_iterations=12)
            fitter = Fitter(self.model, [t for t in self.trials if t.id in unseen])
            guess = fitter.guess()
            for trial in fitter.trials:
                residual, keep = fitter.residual(part.hypothesis, part.z, trial, guess[trial.id])
                start = self.model.approach_start(trial, guess[trial.id], residual)
                residual, keep = fitter.residual(part.hypothesis, part.z, trial, start)
                total += float(np.square(residual[keep]).sum())
                samples += int(keep.sum())
                row = 0
                for block in trial.blocks:
                    for c, channel in enumerate(block.channels):
                        rows = slice(row, row + block.time.size)
                        row += block.time.size
                        good = keep[rows]
                        error = residual[rows][good] / block.weight[c][good]
                        squares[channel] = squares.get(channel, 0.0) + float(error @ error)
                        counts[channel] = counts.get(channel, 0) + int(good.sum())
        rms = {c: float(np.sqrt(s / max(counts[c], 1))) for c, s in squares.items()}
        return float(np.sqrt(total / max(samples, 1))), rms

    def _folds(self) -> list[tuple[str, set[str]]]:
        conditions: dict[str, set[str]] = {}
        for trial in self.trials:
            conditions.setdefault(trial.condition, set()).add(trial.id)
        return list(conditions.items())


def starts_of(effects: Sequence[Mapping[str, object]]) -> dict[str, float]:
    """Start values by key from the effects of a seal, or of a verdict."""
    found: dict[str, float] = {}
    for item in effects:
        parameters = item.get("parameters", {k: v for k, v in item.items() if k not in ("effect", "where", "trials")})
        assert isinstance(parameters, Mapping)
        for name, value in parameters.items():
            number = value.get("value") if isinstance(value, Mapping) else value
            if isinstance(number, int | float):
                found[f"{item['effect']}@{item['where']}.{name}"] = float(number)
    return found
