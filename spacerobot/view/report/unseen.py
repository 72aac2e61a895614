"""What was done with the trials that were kept aside, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.view.report.words import number

_MODELS = {"before": "baseline", "after": "chosen model", "selected": "model chosen without it"}


def unseen(verdict: Mapping[str, Any]) -> list[str]:
    """Sentences: what each part of the trials leads to, what was taken from the others, what could not be predicted."""
    held_out = verdict.get("held_out") or {}
    folds = held_out.get("folds") or ()
    decided = str(held_out.get("decided") or "")
    taken = "; ".join(held_out.get("taken_from_unseen") or ())
    given = [f"Taken from the trials that are predicted: {taken}."] if taken else []
    if not folds:
        return [*([f"{decided[0].upper()}{decided[1:]}."] if decided else []), *given]
    same = f"the same set {held_out.get('same_set')} of {len(folds)} times"
    said = [f"Chosen and fitted again without each part of the trials: {same}."]
    for fold in folds:
        if fold["leads_to"] != "the same set":
            names = " + ".join(f"{e['effect']} at {e['where']}" for e in fold["selected"]) or "the baseline"
            error = f", which predicts them to {number(fold.get('rms_selected'))} times the noise"
            said.append(f"Without {_trials(fold['left_out'])}: {fold['leads_to']}, {names}{error}.")
    said += given
    for one in held_out.get("failed") or ():
        model = _MODELS.get(one["model"], one["model"])
        why = f"is not predicted by the {model} ({one['why']})"
        said.append(f"Trial {one['trial']} {why}; it counts as if predicted by its mean.")
    return said


def _trials(names: list[str]) -> str:
    return f"trial {names[0]}" if len(names) == 1 else f"trials {', '.join(names)}"
