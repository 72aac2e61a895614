"""Errors on what was kept aside, as the verdict states them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from msgspec import UNSET, UnsetType, structs

from spacerobot.diagnosis.answer.record import Errors, Fold, HeldOut, NotForetold, Overall, placed
from spacerobot.diagnosis.fitting.noise import squares_of
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, scheme_of
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.kinds import SAME, TOLD


def of_rig(trials: Sequence[TrialData], unseen: Unseen | None) -> HeldOut:
    """Held-out errors per channel in SI and over all in sensor sigmas; what each fold chose, and what failed."""
    if unseen is None:
        nothing = Overall(rms_before=None, rms_after=None, noise_floor=None, chi2_before=None, chi2_after=None)
        return HeldOut(scheme=None, channels={}, overall=nothing)
    sums = [squares_of(h.residual, trials) for h in unseen.told]
    chi2 = [h.total for h in unseen.told]
    return HeldOut(
        scheme=unseen.scheme,
        channels={c: _errors([s[c][0] for s in sums], count) for c, (_, count) in sums[0].items()},
        overall=_overall(_errors(chi2, sum(t.samples for t in trials)), chi2),
        decided="effects chosen among those in play, and all values fitted, without the trials that are predicted",
        taken_from_unseen=list(unseen.taken),
        same_set=len(unseen.leading_to(SAME)),
        folds=_folds(unseen),
        failed=_failed(unseen),
    )


def of_parts(parts: Sequence[Part]) -> HeldOut:
    """Held-out errors by channel in SI, and over all in "unit": "sigma" where the noise is stated, else "spread"."""
    sums: dict[str, np.ndarray] = {}
    for part in parts:
        for channel, row in part.errors().items():
            sums[channel] = sums.get(channel, np.zeros(len(TOLD) + 1)) + np.array(row, dtype=float)
    scale = sizes(parts)
    stated = _stated(parts)
    told = {c for p in parts if not p.model.not_measured for t in p.trials for c in t.channels} or set(sums)
    total = sum((row[:-1] / scale[c] ** 2 for c, row in sums.items() if c in told), np.zeros(len(TOLD)))
    every = _errors(total, sum(row[-1] for c, row in sums.items() if c in told))
    tried = [(p.unseen, p.name) for p in parts if p.unseen is not None]
    return HeldOut(
        scheme=scheme_of(parts[0].trials, MOST_FOLDS),
        unit="sigma" if stated else "spread",
        channels={c: _errors(row[:-1], row[-1]) for c, row in sums.items()},
        overall=_overall(every, [float(x) for x in total] if stated else None),
        decided="effects chosen among those in play, weights and all values, without the trials that are predicted",
        taken_from_unseen=list(dict.fromkeys(said for unseen, _ in tried for said in unseen.taken)),
        same_set=sum(len(unseen.leading_to(SAME)) for unseen, _ in tried),
        folds=[f for unseen, name in tried for f in _folds(unseen, name)],
        failed=[f for unseen, name in tried for f in _failed(unseen, name)],
    )


def of_rivals(trials: Sequence[TrialData], unseen: Unseen | None) -> dict[Label, float]:
    """rms of the trials that were kept aside [sensor sigmas], by further set that the folds chose among."""
    count = sum(t.samples for t in trials)
    return {} if unseen is None else {k: math.sqrt(e.total / max(count, 1)) for k, e in unseen.rivals.items()}


def _errors(squares: Iterable[float], count: float = 1) -> Errors:
    """Root mean squares before, after and as selected, of sums of squares over so many readings."""
    before, after, selected = (math.sqrt(x / max(count, 1)) for x in squares)
    return Errors(rms_before=before, rms_after=after, rms_selected=selected)


def _overall(errors: Errors, chi2: Iterable[float] | None) -> Overall:
    """Of all channels together; in sensor sigmas, of which the noise alone leaves one, where chi-squared is known."""
    before, after, selected = chi2 if chi2 is not None else (None, None, None)
    return Overall(
        **structs.asdict(errors),
        noise_floor=None if chi2 is None else 1.0,
        chi2_before=before,
        chi2_after=after,
        chi2_selected=selected,
    )


def _folds(unseen: Unseen, part: str | UnsetType = UNSET) -> list[Fold]:
    """What was decided without some of the trials, and how well they are then predicted, in the fit's own weights."""
    return [
        Fold(
            **structs.asdict(_errors(h.of(f.out).mean_square for h in unseen.told)),
            left_out=list(f.out),
            selected=placed(f.selected),
            leads_to=f.leads_to,
            part=part,
        )
        for f in unseen.folds
    ]


def _failed(unseen: Unseen, part: str | UnsetType = UNSET) -> list[NotForetold]:
    """Trials that could not be predicted."""
    return [
        NotForetold(trial=trial, model=name, why=why, part=part)
        for name, told in zip(TOLD, unseen.told, strict=True)
        for trial, why in told.failed.items()
    ]


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
