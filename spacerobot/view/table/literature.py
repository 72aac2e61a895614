"""Figures that others state for the same recordings, and the same measure of what a diagnosis predicts unseen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.noise import split
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.candidate import Candidate, tried
from spacerobot.diagnosis.selection.held_out import FAINTLY, HEAD, HeldOut, predict_held_out
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.recordings.document import read_document
from spacerobot.support.errors import InputError

FILE = "quick_fits.toml"
"""Beside study.toml; the diagnosis never reads it."""


@dataclass(frozen=True)
class Figure:
    """One error that somebody states, with and without the physics that they found.

    Attributes:
        what: in words.
        channels: those that it is taken over, each with a factor (m/s a rad/s, say) that makes them one unit.
        unit, scale: of the figure, and how many of it are one SI unit.
        before, after: as stated; two numbers are a range over trials.
        part: whose channel, where several parts have it.
        trials: recorded trials that count; all if empty.
        window: length of the pieces that are predicted, each from a start of its own [s]; as diagnosed if None.
        read_start: whether a piece starts as its first readings say; else as its own readings, all of them, fit best.
        still: channels that stay within so much in the pieces that count, in the channel's unit.
        moving: channels of which one at least changes by so much in them.
        relative: whether in units of the measured channel's own rms.
        alone: whether the found physics is fitted anew to pieces that count, and to nothing else.
        interleaved: whether, with `alone`, every other piece is left out instead of recordings.
        note: what must be said with it.
    """

    what: str
    channels: Mapping[str, float]
    unit: str
    before: tuple[float, ...]
    after: tuple[float, ...]
    scale: float = 1.0
    part: str = ""
    trials: tuple[str, ...] = ()
    window: float | None = None
    read_start: bool = False
    still: Mapping[str, float] = field(default_factory=dict)
    moving: Mapping[str, float] = field(default_factory=dict)
    relative: bool = False
    alone: bool = False
    interleaved: bool = False
    note: str = ""


@dataclass(frozen=True)
class Quoted:
    """What a study's file of figures says."""

    origin: str
    figures: tuple[Figure, ...]


def quoted(folder: Path) -> Quoted | None:
    """The figures stated beside a study; None where there are none.

    Raises:
        InputError: the file is no such list.
    """
    path = folder / FILE
    if not path.exists():
        return None
    document = read_document(path).data
    try:
        return Quoted(str(document["origin"]), tuple(_figure(f) for f in document["figures"]))
    except (KeyError, TypeError, ValueError) as error:
        valid = ", ".join(f.name for f in fields(Figure))
        raise InputError(f"no list of figures: {error}", valid=valid, where=str(path)) from None


def _figure(entry: Mapping[str, Any]) -> Figure:
    values = dict(entry)
    if not isinstance(values["channels"], dict):
        values["channels"] = dict.fromkeys(values["channels"], 1.0)
    for name in ("before", "after"):
        stated = values[name]
        values[name] = tuple(float(x) for x in (stated if isinstance(stated, list) else [stated]))
    return Figure(**{**values, "trials": tuple(values.get("trials", ()))})


def measured(figure: Figure, parts: Sequence[Part]) -> dict[str, list[float]]:
    """The same figure of these parts' predictions of unseen trials: "before" and "after", a number or a range each."""
    squares: dict[str, dict[str, list[float]]] = {"before": {}, "after": {}}
    for part in parts:
        if (figure.part and part.name != figure.part) or not set(figure.channels) & set(part.trials[0].channels):
            continue
        for key, candidate in (("before", part.growth.before), ("after", part.chosen)):
            trials, found = _predicted(figure, part, candidate)
            for trial in trials:
                for group, square, count in _squares(figure, trial, found):
                    sums = squares[key].setdefault(group, [0.0, 0.0])
                    sums[0] += square
                    sums[1] += count
    out = {}
    for key, groups in squares.items():
        if len(figure.after) > 1:
            each = [figure.scale * float(np.sqrt(s / n)) for s, n in groups.values()]
            out[key] = [min(each), max(each)]
        else:
            total, count = (sum(g[i] for g in groups.values()) for i in range(2))
            out[key] = [figure.scale * float(np.sqrt(total / count))] if count else []
    return out


def _predicted(figure: Figure, part: Part, candidate: Candidate) -> tuple[tuple[TrialData, ...], HeldOut]:
    if figure.window is None and not figure.read_start and not figure.alone:
        return part.trials, tried(candidate)
    model: Machine = part.model
    if figure.window is not None:
        if not hasattr(model, "in_windows"):
            raise InputError("this model cannot be cut anew", given=figure.what, where=part.name)
        model = model.in_windows(figure.window)
    fit = candidate.fit
    if figure.alone:
        pieces = tuple(t for t in model.trials if _among(figure, t))
        left_out = _folds(figure, part, pieces)
        head = 0.0 if figure.read_start else HEAD
        return pieces, predict_held_out(model, pieces, fit.hypothesis, fit.values(), left_out, head=head, trust=FAINTLY)
    return model.trials, predict_held_out(
        part.model,
        part.trials,
        fit.hypothesis,
        fit.values(),
        part.growth.bench.left_out,
        fit.initials(),
        shown=model,
        head=0.0 if figure.read_start else HEAD,
        trust=FAINTLY,
    )


def _folds(figure: Figure, part: Part, pieces: Sequence[TrialData]) -> list[tuple[str, tuple[str, ...]]]:
    if figure.interleaved:
        return [(f"every other piece, from {k + 1}", tuple(t.id for t in pieces[k::2])) for k in range(2)]
    folds = []
    for name, ids in part.growth.bench.left_out:
        whole = {i.split("@")[0] for i in ids}
        inside = tuple(t.id for t in pieces if t.recorded in whole)
        if inside:
            folds.append((name, inside))
    return folds


def _squares(figure: Figure, trial: TrialData, found: HeldOut) -> list[tuple[str, float, float]]:
    """(recorded trial, sum of squares, number) of one piece, in the figure's unit before its scale."""
    if trial.id not in found.residual or not _among(figure, trial):
        return []
    errors, counted = (split(x[trial.id], trial) for x in (found.residual, found.counted))
    out = []
    for block in trial.blocks:
        for c, channel in enumerate(block.channels):
            if channel in figure.channels:
                good = counted[channel].astype(bool)
                error = errors[channel][good] / block.weight[c][good]
                total = float(np.sum(np.square(block.value[c][good]))) if figure.relative else float(good.sum())
                out.append((trial.recorded, figure.channels[channel] ** 2 * float(error @ error), total))
    return out


def _among(figure: Figure, trial: TrialData) -> bool:
    return (not figure.trials or trial.recorded in figure.trials) and _counts(figure, trial)


def _counts(figure: Figure, trial: TrialData) -> bool:
    def spread(channel: str) -> float:
        return float(np.ptp(trial.channel(channel)[1]))

    calm = all(spread(c) <= most for c, most in figure.still.items())
    return calm and (not figure.moving or any(spread(c) >= least for c, least in figure.moving.items()))
