"""A study's trials under the models that a diagnosis found: its model.toml, run again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from spacerobot.diagnosis.answer.mended_model import read_model
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.forward.base import ChannelOverlay, ForwardModel, TrialOverlay, Value
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.machine import Model
from spacerobot.diagnosis.selection.held_out import start_of
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError


@dataclass(frozen=True, eq=False)
class AsDiagnosed(ForwardModel):
    """The found model of every part.

    Attributes:
        study: whose recordings.
        parts: a model, what was found of it, and with which parameters.
    """

    kind = "the models that a diagnosis found, part by part"

    study: Study
    parts: tuple[tuple[Model, Hypothesis, np.ndarray], ...]

    @classmethod
    def applies(cls, study: Study) -> bool:
        """A model.toml is given."""
        return False

    @classmethod
    def of(cls, study: Study) -> Self:
        """Without a file there is nothing found."""
        raise InputError("no model was given", valid="--model FILE", where=str(study.path))

    @classmethod
    def read(cls, study: Study, path: Path) -> Self:
        """The models of a file.

        Raises:
            InputError: no such file, or none of its parts is one of this study.
        """
        found = {f.part: f for f in read_model(path)}
        models = {m.name: m for m in models_for(study)}
        known = [name for name in found if name in models]
        if not known:
            raise InputError(
                "the model has no part of this study", given=", ".join(found), valid=", ".join(models), where=str(path)
            )
        return cls(study, tuple((models[n], *found[n].hypothesis(models[n])) for n in known))

    @property
    def values(self) -> tuple[Value, ...]:
        """Of the baselines and the effects, as found."""
        return tuple(
            Value(f"{model.name}: {f.key}", f.value(float(x)), "", "found")
            for model, made, z in self.parts
            for f, x in zip(made.free, z, strict=True)
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        return tuple(
            f"{model.name} is compared as {model.metric}, in the pieces that the diagnosis used; each starts as fits "
            "it best."
            for model, _, _ in self.parts
        )

    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial, all its parts."""
        channels: list[ChannelOverlay] = []
        for model, made, z in self.parts:
            pieces = [t for t in model.trials if t.recorded == trial.id]
            fitter = Fitter(model, pieces)
            joined: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
            for piece in pieces:
                start = start_of(fitter, model, made, z, piece)
                shown = model.predict(model.trial_mechanism(made, z, piece), piece, start)
                for channel, rows in _rows(piece, shown.blocks):
                    joined.setdefault(channel, []).append(rows)
            begins = np.array([p.start for p in pieces])
            channels += [self._overlay(trial, c, rows, begins) for c, rows in joined.items()]
        return TrialOverlay(trial.id, self.study.condition(trial), tuple(channels))

    def _overlay(
        self, trial: Trial, channel: str, rows: list[tuple[np.ndarray, np.ndarray, np.ndarray]], begins: np.ndarray
    ) -> ChannelOverlay:
        series = self.study.recording(trial)[channel]
        time, measured, simulated = (np.concatenate([r[i] for r in rows]) for i in range(3))
        order = np.argsort(time, kind="stable")
        return ChannelOverlay(
            channel,
            series.unit,
            time[order],
            measured[order],
            simulated[order],
            series.sigma,
            series.sigma_stated,
            restarts=begins if begins.size > 1 else None,
        )


def _rows(
    piece: TrialData, shown: tuple[np.ndarray, ...]
) -> list[tuple[str, tuple[np.ndarray, np.ndarray, np.ndarray]]]:
    """By channel: time, measured, simulated of the readings that count."""
    out = []
    for block, predicted in zip(piece.blocks, shown, strict=True):
        for c, channel in enumerate(block.channels):
            good = block.weight[c] > 0.0
            out.append((channel, (block.time[good], block.value[c][good], predicted[c][good])))
    return out
