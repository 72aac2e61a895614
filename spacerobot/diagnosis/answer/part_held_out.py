"""Errors on what was kept aside, of a study that is diagnosed part by part."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.answer.held_out import errors, fold, overall
from spacerobot.diagnosis.answer.record import Errors, HeldOut, NotForetold
from spacerobot.diagnosis.selection import part_held_out
from spacerobot.diagnosis.selection.part_fold import MOST_FOLDS
from spacerobot.diagnosis.selection.part_held_out import scheme_of
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.kinds import SAME, TOLD


def of_parts(parts: Sequence[Part]) -> HeldOut:
    """Held-out errors by channel in SI, and over all in "unit": "sigma" where the noise is stated, else "spread"."""
    sums: dict[str, np.ndarray] = {}
    for part in parts:
        for channel, row in part.errors().items():
            sums[channel] = sums.get(channel, np.zeros(len(TOLD) + 1)) + np.array(row, dtype=float)
    scale = sizes(parts)
    stated = _stated(parts)
    total = sum((row[:-1] / scale[c] ** 2 for c, row in sums.items()), np.zeros(len(TOLD)))
    said = [(p, f) for p in parts if p.unseen is not None for f in p.unseen.folds]
    return HeldOut(
        scheme=scheme_of(parts[0].trials, MOST_FOLDS),
        unit="sigma" if stated else "spread",
        channels={c: errors(row[:-1], row[-1]) for c, row in sums.items()},
        overall=overall(
            errors(total, sum(row[-1] for row in sums.values())), [float(x) for x in total] if stated else None
        ),
        decided="effects chosen among those in play, weights and all values, without the trials that are predicted",
        taken_from_unseen=["each piece's own start, from its readings and the sensor's noise"],
        same_set=sum(f.leads_to == SAME for _, f in said),
        folds=[fold(f.out, f.selected, f.leads_to, _of_fold(p, f.out), p.name) for p, f in said],
        failed=[NotForetold(part=p.name, trial=t, model=n, why=w) for p, f in said for t, n, w in f.failed],
    )


def _stated(parts: Sequence[Part]) -> bool:
    """Whether the noise of every channel is."""
    return all(c in p.model.stated for p in parts for t in p.trials for c in t.channels)


def sizes(parts: Sequence[Part]) -> dict[str, float]:
    """By channel, what errors are measured by over all: its stated noise where every channel's is, else its spread."""
    if _stated(parts):
        return {c: 1.0 / float(w.max()) for p in parts for t in p.model.trials for c, w in _weights(t)}
    values: dict[str, list[np.ndarray]] = {}
    for part in parts:
        for trial in part.trials:
            for channel in trial.channels:
                values.setdefault(channel, []).append(trial.channel(channel)[1])
    return {c: float(np.std(np.concatenate(v))) or 1.0 for c, v in values.items()}


def _weights(trial: TrialData) -> list[tuple[str, np.ndarray]]:
    return [(c, w) for b in trial.blocks for c, w in zip(b.channels, b.weight, strict=True)]


def _of_fold(part: Part, out: Sequence[str]) -> Errors:
    """Weighted rms of a fold's trials, in the part's own weights."""
    told = [
        part_held_out.HeldOut({t: h.residual[t] for t in out}, {t: h.counted[t] for t in out}).mean_square
        for h in (part.before, part.after, part.selected)
    ]
    return errors(told, 1)
