"""Sets of effects fitted to joint logs, and judged on speeds that the fit has not seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spacerobot.diagnosis.fitting.noise import correlation_time, squares_of
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import SimulationError

Labels = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Fitted:
    """One set of effects, each at its joint.

    Attributes:
        cost: chi-squared over independent readings of all joints, by the stated noise.
        held_out: rms of the torques of unseen speeds over the stated noise.
        channels: the same by channel [N m].
        readings: independent ones.
    """

    cost: float
    held_out: float
    channels: Mapping[str, float]
    readings: float


class ArmBench:
    """A study of joint logs; what was fitted to a joint is kept."""

    def __init__(self, folder: Path) -> None:
        self.models = models_for(load_study(folder))
        self._done: dict[tuple[str, Labels], Fitted] = {}

    def fitted(self, labels: Labels, starts: Mapping[str, float]) -> Fitted:
        """All joints with these effects, those of each at it.

        Raises:
            SimulationError: an effect that its joint cannot have.
        """
        parts = []
        for model in self.models:
            own = tuple(label for label in labels if label[1] == f"joint.{model.name}")
            if (model.name, own) not in self._done:
                self._done[model.name, own] = _fitted(model, own, starts)
            parts.append(self._done[model.name, own])
        squares = sum(p.held_out**2 * p.readings for p in parts)
        readings = sum(p.readings for p in parts)
        channels = {c: v for p in parts for c, v in p.channels.items()}
        return Fitted(sum(p.cost for p in parts), float(np.sqrt(squares / readings)), channels, readings)


def _fitted(model: Machine, labels: Labels, starts: Mapping[str, float]) -> Fitted:
    bench = Bench(model)
    fit = bench.baseline()
    bench.sharpen(fit)
    fit = bench.again(fit)
    if labels:
        known = {s.label: s for s in model.sites()}
        absent = [label for label in labels if label not in known]
        if absent:
            raise SimulationError(f"{absent[0][0]} has no place at {absent[0][1]}")
        sites = [known[label] for label in labels]
        with_them = bench.fitted_as(fit, sites, _starts(sites, starts))
        if with_them is None:
            raise SimulationError(f"the fit of {' + '.join(e for e, _ in labels)} is no physics")
        fit = bench.again(with_them)
    unseen = bench.held_out(fit)
    if unseen is None:
        raise SimulationError("unseen trials cannot be predicted")
    ((channel, noise),) = model.expected({}).items()
    rms = unseen.rms(bench.trials)
    left = {k: f.residual for k, f in fit.trials.items()}
    square, readings = squares_of(left, bench.trials)[channel]
    independent = _independent(left, bench.trials)
    return Fitted(square / readings / noise**2 * independent, rms[channel] / noise, rms, independent)


def _starts(sites: list[Site], starts: Mapping[str, float]) -> dict[str, float]:
    """Start values of the effects' own parameters, which verdicts of joints call by their angular names."""
    found = {}
    for site in sites:
        own = [v for k, v in starts.items() if k.startswith(f"{site.effect.name}@{site.where}.")]
        found.update({site.key(p.name): v for p, v in zip(site.effect.parameters, own, strict=True)})
    return found


def _independent(left: Mapping[str, np.ndarray], trials: Sequence[TrialData]) -> float:
    """How many independent readings the residual of a joint's one channel counts for."""
    total = 0.0
    for trial in trials:
        (block,) = trial.blocks
        good = left[trial.id][block.weight[0] > 0.0]
        total += good.size / correlation_time(good)
    return total
