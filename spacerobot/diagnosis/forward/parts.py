"""A study's trials under the machines that a diagnosis fits, part by part: as believed, or as its model.toml has it."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Self

import numpy as np

from spacerobot.diagnosis.answer.mended_model import read_model
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.forward.base import ChannelOverlay, ForwardModel, TrialOverlay, Value, unit_of
from spacerobot.diagnosis.machines.choose import models_for, some_models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import STEPS
from spacerobot.diagnosis.selection.held_out import start_of
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis, hypothesis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.recordings.sigmas import TURNED
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError


@dataclass(frozen=True, eq=False)
class Parts(ForwardModel):
    """The model of every part.

    Attributes:
        study: whose recordings.
        parts: a model, the hypothesis that it is run with, and with which parameters.
    """

    kind = "the machines of a diagnosis, part by part, as they are believed"

    study: Study
    parts: tuple[tuple[Machine, Hypothesis, np.ndarray], ...]

    @classmethod
    def applies(cls, study: Study) -> bool:
        """A joint's position and torque, a body's track or its speeds about an impact are recorded."""
        return bool(models_for(study))

    @classmethod
    def of(cls, study: Study) -> Self:
        """As believed; what is unknown is fitted, without any effect.

        Raises:
            InputError: nothing that was recorded can be compared with the baseline.
            SimulationError: what is unknown cannot be fitted.
        """
        return cls(study, tuple(as_believed(m) for m in some_models_for(study)))

    @property
    def values(self) -> tuple[Value, ...]:
        """Of every part: those held as stated, and those that were fitted or found."""
        out = []
        for model, made, z in self.parts:
            free = {f.key: f.value(float(x)) for f, x in zip(made.free, z, strict=True)}
            held = {n: v for n, v in model.base.items() if n not in free and n not in model.relative_to}
            both = [(n, v, "believed") for n, v in held.items()] + [(n, v, self.source) for n, v in free.items()]
            plain = model.plain()
            out += [Value(f"{model.name}: {name}", value, _unit(name, plain), source) for name, value, source in both]
        return tuple(out)

    source: ClassVar[str] = "unknown to the study: fitted to all trials"
    """Of values that are not as believed."""

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        alike: dict[tuple[str, float], list[str]] = {}
        for model, _, _ in self.parts:
            alike.setdefault((model.metric, model.window), []).append(model.name)
        return tuple(
            f"Compared as {metric}, {_pieces(window)}, each from the start that fits it best: {', '.join(names)}."
            for (metric, window), names in alike.items()
        )

    @property
    def given(self) -> frozenset[str]:
        """What the models take as it was recorded."""
        return frozenset(c for model, _, _ in self.parts for c in model.given)

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


class AsDiagnosed(Parts):
    """The found model of every part."""

    kind = "the models that a diagnosis found, part by part"
    source = "found"

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
        return cls(study, tuple((models[n].everything(), *found[n].hypothesis(models[n])) for n in known))


def _pieces(window: float) -> str:
    if math.isinf(window):
        return "in the pieces that a diagnosis uses"
    return f"starting anew from the recording every {window:.3g} s as a diagnosis does"


def _unit(name: str, plain: Mechanism) -> str:
    """SI unit of a value that a study may state; none of an effect's."""
    port = name.rpartition(".")[0]
    with contextlib.suppress(InputError):
        unit = unit_of(name)
        return TURNED.get(unit, unit) if port in plain.ports and plain.angular(port) else unit
    return ""


def as_believed(model: Machine, found: Mapping[str, float] | None = None) -> tuple[Machine, Hypothesis, np.ndarray]:
    """A part without effects, its values as believed; those that are unknown as `found`, or else as they fit best."""
    unknown = found or model.believed.unknown
    made = hypothesis(replace(model.believed, sigma={}, zeros={}, unknown=unknown), ())
    if found or not made.free:
        return model.everything(), made, np.zeros(len(made.free))
    return model.everything(), made, Fitter(model, model.trials).fit(made, max_iterations=STEPS).z


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
