"""What the report of a study is made from that was diagnosed part by part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from spacerobot.diagnosis.answer.evidence import POINTS, formulas, names_of
from spacerobot.diagnosis.answer.part_verdict import balance
from spacerobot.diagnosis.answer.record import Verdict, written
from spacerobot.diagnosis.answer.verdict import pattern
from spacerobot.diagnosis.fitting.noise import split
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.recordings.study import Study

SHOWN = 40
"""Located patterns that a report lists."""

DRAWN = 4
"""Parts whose residuals a report draws; the others are in its table."""

_NOWHERE = Located((), (), ())

SCREENED = 60
"""Explanations that a report lists of those that were only screened."""


def evidence_of(study: Study, parts: Sequence[Part], verdict: Verdict) -> dict[str, Any]:
    """Traces, rivals, balances and checks of all parts, ready for JSON."""
    units = _units(study)
    rows = [(p, r) for p in parts if p.located is not None for r in p.located.rows]
    rows.sort(key=lambda pair: (pair[1].p, -abs(pair[1].score)))
    clear = dict.fromkeys(id(p) for p, _ in rows)  # the parts, the clearest mismatch first
    by_part = {id(p): p for p in parts}
    surfaces = [(by_part[k], s) for k in list(clear)[:DRAWN] for s in (by_part[k].located or _NOWHERE).surfaces]
    return {
        "study": {
            "title": study.title,
            "trials": [
                {"id": t.id, "condition": study.condition(t), "overrides": dict(t.overrides)} for t in study.trials
            ],
            "channels": _channels(parts, units),
            "body": _body(study),
        },
        "traces": [t for p in parts for t in _traces(p, units, len(parts))],
        "hypotheses": [h for p in parts for h in _hypotheses(p, len(parts))],
        "located": [
            {**written(pattern(r, balance(p, r.balance, parts))), "significance": r.score} for p, r in rows[:SHOWN]
        ],
        "surfaces": [{**asdict(s), "balance": balance(p, s.balance, parts)} for p, s in surfaces],
        "whiteness": [],
        "formulas": formulas([p.fit.hypothesis.label for p in parts]),
        "checks": [asdict(c) for p in parts for c in p.checks],
        "timing": {"seconds": verdict.seconds},
        "parts": [written(p) for p in verdict.parts or ()],
    }


def _body(study: Study) -> str:
    """What a body that floats is called here; catalogues know it as the target."""
    groups = {name.split(".")[0] for name in study.channels()}
    return "target" if "target" in groups else "body"


def _units(study: Study) -> dict[str, str]:
    """Channel -> SI unit."""
    return {s.name: s.unit for t in study.trials for s in study.recording(t).series.values()}


def _channels(parts: Sequence[Part], units: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    out: dict[str, dict[str, Any]] = {}
    for part in parts:
        for trial in part.model.trials:
            for block in trial.blocks:
                for channel, weight in zip(block.channels, block.weight, strict=True):
                    sigma = 1.0 / float(weight.max()) if channel in part.model.stated and weight.any() else None
                    out.setdefault(channel, {"unit": units.get(channel, ""), "sigma": sigma, "stream": block.stream})
    return out


def _traces(part: Part, units: Mapping[str, str], count: int) -> list[dict[str, Any]]:
    """Measured and predicted, every piece of every trial joined again, as predicted without having been fitted."""
    joined: dict[tuple[str, str], list[dict[str, np.ndarray]]] = {}
    about: dict[tuple[str, str], tuple[str, float | None]] = {}
    for trial in part.trials:
        if trial.id not in part.before.residual or trial.id not in part.after.residual:
            continue
        before, after = (split(h.residual[trial.id], trial) for h in (part.before, part.after))
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                good = block.weight[c] > 0.0
                size = np.where(good, 1.0 / np.where(good, block.weight[c], 1.0), np.nan)
                piece = {
                    "time": block.time,
                    "measured": np.where(good, block.value[c], np.nan),
                    "before": block.value[c] + before[channel] * size,
                    "after": block.value[c] + after[channel] * size,
                }
                key = (trial.recorded, channel)
                joined.setdefault(key, []).append(piece)
                sigma = float(np.nanmin(size)) if channel in part.model.stated and good.any() else None
                about[key] = (trial.condition, sigma)
    out = []
    for (trial_id, channel), pieces in joined.items():
        whole = {k: np.concatenate([p[k] for p in pieces]) for k in pieces[0]}
        order = np.argsort(whole["time"], kind="stable")
        pick = order[:: max(1, order.size // POINTS)]
        condition, sigma = about[trial_id, channel]
        out.append(
            {
                "trial": trial_id,
                "condition": condition if condition != trial_id else "",
                "channel": channel,
                "unit": units.get(channel, ""),
                "sigma": sigma,
                "held_out": True,
                **{k: v[pick] for k, v in whole.items()},
            }
        )
    return out


def _hypotheses(part: Part, count: int) -> list[dict[str, Any]]:
    """Every candidate that was tried on unseen data with why it lost, then what was only screened."""
    growth = part.growth
    best = growth.considered[0].error
    rows = [
        {
            "part": part.name if count > 1 else "",
            "effects": names_of(c.label),
            "stage": "fitted",
            "ratio": c.error / growth.considered_baseline.error,
            "held_out": -float(np.log(c.error / best)) if np.isfinite(c.error) else None,
            "chi2": None,
            "chi2_per_sample": None,
            "parameters": {k: v for k, v in c.fit.values().items() if "@" in k},
            "lost": _lost(c, part),
        }
        for c in growth.considered
    ]
    tried = {c.label for c in growth.considered}
    base = growth.considered_baseline.cost
    rest = sorted(((cost, label) for label, cost in growth.screened if label not in tried), key=lambda pair: pair[0])
    rows += [
        {
            "part": part.name if count > 1 else "",
            "effects": names_of(label),
            "stage": "screened",
            "ratio": None,
            "held_out": None,
            "chi2": None,
            "chi2_per_sample": None,
            "parameters": {},
            "lost": f"only screened: promised {100.0 * float(np.sqrt(max(cost, 0.0) / base)):.3g} % of the error",
        }
        for cost, label in rest[:SCREENED]
    ]
    return rows


def _lost(one: Candidate, part: Part) -> str:
    growth = part.growth
    chosen = next((c for c in growth.considered if c.label == growth.after.label), growth.considered_baseline)
    if one.label == chosen.label:
        return ""
    if one.label in growth.refused:
        return growth.refused[one.label]
    if one in growth.rivals:
        return "not told apart: predicts as well, and is no more complicated"
    if not np.isfinite(one.error):
        return "could not predict unseen data"
    more = 100.0 * (one.error / chosen.error - 1.0)
    if one.error < chosen.error:
        return f"predicts {-more:.2g} % better, too little for {one.size - chosen.size} more parameters"
    if one.simplicity > chosen.simplicity and more < 1.0:
        return "predicts no better, and is more complicated"
    return f"predicts unseen data {more:.3g} % worse"
