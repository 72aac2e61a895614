"""Errors on what was kept aside, as the verdict states them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from msgspec import UNSET, UnsetType

from spacerobot.diagnosis.answer.record import Errors, Fold, HeldOut, NotForetold, Overall, placed
from spacerobot.diagnosis.fitting.noise import squares_of
from spacerobot.diagnosis.selection import held_out
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.kinds import SAME, TOLD, LeadsTo


def errors(squares: Iterable[float], count: float) -> Errors:
    """Root mean squares before, after and as selected, of sums of squares over so many readings."""
    before, after, selected = (math.sqrt(x / max(count, 1)) for x in squares)
    return Errors(rms_before=before, rms_after=after, rms_selected=selected)


def overall(errors: Errors, chi2: Iterable[float] | None) -> Overall:
    """Of all channels together; in sensor sigmas, of which the noise alone leaves one, where chi-squared is known."""
    before, after, selected = chi2 if chi2 is not None else (None, None, None)
    return Overall(
        rms_before=errors.rms_before,
        rms_after=errors.rms_after,
        rms_selected=errors.rms_selected,
        noise_floor=None if chi2 is None else 1.0,
        chi2_before=before,
        chi2_after=after,
        chi2_selected=selected,
    )


def fold(out: Sequence[str], selected: Label, leads_to: LeadsTo, errors: Errors, part: str | UnsetType = UNSET) -> Fold:
    """What was decided without some of the trials, and how well they are then predicted."""
    return Fold(
        rms_before=errors.rms_before,
        rms_after=errors.rms_after,
        rms_selected=errors.rms_selected,
        left_out=list(out),
        selected=placed(selected),
        leads_to=leads_to,
        part=part,
    )


def of_rig(trials: Sequence[TrialData], held: held_out.HeldOut | None) -> HeldOut:
    """Held-out errors per channel in SI and over all in sensor sigmas; what each fold chose, and what failed."""
    if held is None:
        nothing = Overall(rms_before=None, rms_after=None, noise_floor=None, chi2_before=None, chi2_after=None)
        return HeldOut(scheme=None, channels={}, overall=nothing)
    said = (held.before, held.after, held.selected)
    sums = [squares_of(e.residuals, trials) for e in said]
    chi2 = [e.total for e in said]
    counts = {t.id: t.samples for t in trials}
    return HeldOut(
        scheme=held.scheme,
        channels={c: errors([s[c][0] for s in sums], count) for c, (_, count) in sums[0].items()},
        overall=overall(errors(chi2, sum(counts.values())), chi2),
        decided="effects chosen among those in play, and all values fitted, without the trials that are predicted",
        taken_from_unseen=taken(held),
        same_set=len(held.leading_to(SAME)),
        folds=[
            fold(
                f.out,
                f.selected.label,
                f.leads_to,
                errors([sum(e.chi2[t] for t in f.out) for e in said], sum(counts[t] for t in f.out)),
            )
            for f in held.folds
        ],
        failed=[
            NotForetold(trial=t, model=n, why=w) for n, e in zip(TOLD, said, strict=True) for t, w in e.failed.items()
        ],
    )


def of_rivals(trials: Sequence[TrialData], held: held_out.HeldOut | None) -> dict[Label, float]:
    """rms of the trials that were kept aside [sensor sigmas], by further set that the folds chose among."""
    count = sum(t.samples for t in trials)
    return {} if held is None else {k: math.sqrt(e.total / max(count, 1)) for k, e in held.rivals.items()}


def taken(held: held_out.HeldOut) -> list[str]:
    """What was found from the unseen trials themselves, in words."""
    said = ["each trial's own start, from its readings"]
    own = sorted({k.split("|", 1)[1] for f in held.folds for v in f.after.own.values() for k in v})
    alone = any(x > 0.0 for f in held.folds for x in f.after.paid.values())
    if own:
        where = "from its other trials, where it has none from the trial itself under its prior, whose cost counts"
        said.append(f"each condition's own {', '.join(own)}, {where if alone else 'from its other trials'}")
    return said
