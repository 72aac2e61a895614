"""What reports are made from: traces, rivals, checks, all ready for JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.study import Study

POINTS = 400
UNITS = {"x": "m", "y": "m", "yaw": "rad", "force": "N"}


def unit_of(channel: str) -> str:
    """SI unit of a channel."""
    return UNITS.get(channel.split(".")[-1], "")


def study_evidence(study: Study, trials: Sequence[TrialData]) -> dict[str, Any]:
    """Title, trials and channels."""
    channels: dict[str, dict[str, Any]] = {}
    for trial in trials:
        for block in trial.blocks:
            for c, name in enumerate(block.channels):
                good = block.weight[c] > 0.0
                sigma = float(1.0 / block.weight[c].max()) if good.any() else None
                channels.setdefault(name, {"unit": unit_of(name), "sigma": sigma, "stream": block.stream})
    return {
        "title": study.title,
        "trials": [{"id": t.id, "condition": t.condition, "overrides": dict(t.overrides)} for t in trials],
        "channels": channels,
    }


def traces(
    trials: Sequence[TrialData],
    before: Mapping[str, np.ndarray],
    after: Mapping[str, np.ndarray],
    held_out: bool,
) -> list[dict[str, Any]]:
    """Measured, before and after, per trial and channel, thinned to POINTS around where things happen.

    Args:
        trials: the data.
        before, after: weighted residuals by trial, shape (S,).
        held_out: whether they are predictions of trials that were not fitted.
    """
    out = []
    for trial in trials:
        if trial.id not in before or trial.id not in after:
            continue
        row = 0
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                rows = slice(row, row + block.time.size)
                row += block.time.size
                good = block.weight[c] > 0.0
                weight = block.weight[c]
                each = np.divide(1.0, weight, out=np.zeros_like(weight), where=good)  # one sigma for each reading
                step = max(1, block.time.size // POINTS)
                pick = slice(None, None, step)
                measured = block.value[c]
                out.append(
                    {
                        "trial": trial.id,
                        "condition": trial.condition,
                        "channel": channel,
                        "unit": unit_of(channel),
                        "sigma": float(1.0 / block.weight[c].max()),
                        "held_out": held_out,
                        "time": block.time[pick],
                        "measured": measured[pick],
                        "before": (measured + before[trial.id][rows] * each)[pick],
                        "after": (measured + after[trial.id][rows] * each)[pick],
                    }
                )
    return out


def hypotheses(found: Found, judgement: Judgement, unseen: Mapping[Label, float]) -> list[dict[str, Any]]:
    """Every rival with its score and why it lost; then what was only screened.

    Args:
        found: every fit.
        judgement: what was chosen.
        unseen: rms of trials that were kept aside [sensor sigmas], by set; of those that were tried on them.
    """
    lost = {r.fit.hypothesis.label: r.lost for r in judgement.rivals}
    above = {r.fit.hypothesis.label: r.score for r in judgement.rivals}
    rows = []
    for fit in sorted([found.baseline, *found.fits.values()], key=lambda f: f.cost):
        label = fit.hypothesis.label
        chosen = label == judgement.chosen.hypothesis.label
        rows.append(
            {
                "effects": names_of(label),
                "stage": "fitted",
                "chi2": fit.chi2,
                "chi2_per_sample": fit.chi2 / max(fit.samples, 1),
                "held_out": None,
                "unseen": unseen.get(label),
                "above": None if chosen else above.get(label),
                "chosen": chosen,
                "parameters": {k: v for k, v in fit.values().items() if "@" in k},
                "lost": "" if chosen else lost.get(label, "its sign makes no physical sense"),
            }
        )
    fitted = set(found.fits)
    rest = sorted(((g, k) for k, g in found.screened.items() if k not in fitted), key=lambda p: -p[0])
    for gain, label in rest[:60]:
        rows.append(
            {
                "effects": names_of(label),
                "stage": "screened",
                "chi2": found.baseline.chi2 - gain,
                "chi2_per_sample": (found.baseline.chi2 - gain) / max(found.baseline.samples, 1),
                "held_out": None,
                "parameters": {},
                "lost": "only screened: others promised more",
            }
        )
    return rows


def whiteness(before: Left, after: Left) -> list[dict[str, Any]]:
    """Level and colour of what each channel leaves over, before and after."""
    later = {c.channel: c for c in after.channels}
    return [
        {
            "channel": c.channel,
            "before": {"lag1": c.lag1, "chi2_per_sample": c.level},
            "after": {"lag1": later[c.channel].lag1, "chi2_per_sample": later[c.channel].level},
        }
        for c in before.channels
    ]


def formulas(labels: Sequence[Label]) -> list[dict[str, str]]:
    """Formula and source of every effect named."""
    known = all_effects()
    out = []
    for name, where in dict.fromkeys(pair for label in labels for pair in label):
        effect = known[name]
        out.append(
            {"effect": name, "where": where, "title": effect.title, "latex": effect.formula, "source": effect.source}
        )
    return out


def names_of(label: Label) -> list[dict[str, str]]:
    """A set of effects, each at its place, ready for JSON."""
    return [{"effect": e, "where": w} for e, w in label]
