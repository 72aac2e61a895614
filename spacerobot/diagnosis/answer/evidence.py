"""What reports are made from, ready for JSON: traces, rivals, balances, checks; of a wrist rig, or of every part."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from spacerobot.diagnosis.answer.record import Verdict, written
from spacerobot.diagnosis.answer.verdict import labels_of, pattern
from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.noise import split
from spacerobot.diagnosis.locate.located import Located, Row, Surface
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.nameable import why_nameless
from spacerobot.diagnosis.selection.part_result import Part, balance
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.effects.effect import said_name
from spacerobot.effects.registry import effect as effect_of
from spacerobot.recordings.study import Study

POINTS = 400
"""Readings of a channel that a report draws."""

SHOWN = 40
"""Located patterns that a report lists."""

DRAWN = 4
"""Parts whose residuals a report draws; the others are in its table."""

NOT_WEIGHED = "explains less"
"""Why a set lost that the judge did not set against the chosen one."""

SCREENED = 60
"""Explanations that a report lists of those that were only screened."""

_NOWHERE = Located((), (), ())


def evidence_of_rig(
    study: Study,
    trials: Sequence[TrialData],
    found: Found,
    judgement: Judgement,
    verdict: Verdict,
    *,
    before: Mapping[str, np.ndarray],
    after: Mapping[str, np.ndarray],
    held_out: bool,
    unseen: Mapping[Label, float],
    left: tuple[Left, Left],
    located: Located,
    checks: Sequence[Check],
    withdrawn: Mapping[Label, str] | None = None,
) -> dict[str, Any]:
    """Of a wrist rig.

    Args:
        study, trials, found, judgement, verdict: its data, fits and answer.
        before, after: weighted residuals by trial, shape (S,).
        held_out: whether they are predictions of trials that were not fitted.
        unseen: rms of trials that were kept aside [sensor sigmas], by set; of those that were tried on them.
        left: what baseline and choice leave over.
        located, checks: balances, and checks of the fit.
        withdrawn: sets that were not named, each with the reason.
    """
    units = _units(study)
    stated = {c for t in trials for c in t.channels}
    return _whole(
        verdict,
        study={
            "title": study.title,
            "trials": [{"id": t.id, "condition": t.condition, "overrides": dict(t.overrides)} for t in trials],
            "channels": _channels(trials, units, stated),
        },
        traces=_traces(trials, before, after, units, stated, held_out),
        hypotheses=_of_rig(found, judgement, unseen, withdrawn or {}),
        located=[(r.balance, r) for r in located.rows],
        surfaces=[(s.balance, s) for s in located.surfaces],
        whiteness=_whiteness(*left),
        labels=labels_of(judgement),
        checks=checks,
    )


def evidence_of_parts(study: Study, parts: Sequence[Part], verdict: Verdict) -> dict[str, Any]:
    """Of all parts of a study."""
    units = _units(study)
    rows = [(p, r) for p in parts if p.located is not None for r in p.located.rows]
    rows.sort(key=lambda pair: (pair[1].p, -abs(pair[1].score)))
    clear = dict.fromkeys(id(p) for p, _ in rows)  # the parts, the clearest mismatch first
    by_part = {id(p): p for p in parts}
    surfaces = [(by_part[k], s) for k in list(clear)[:DRAWN] for s in (by_part[k].located or _NOWHERE).surfaces]
    channels: dict[str, Any] = {}
    for part in parts:
        channels = {**_channels(part.model.trials, units, part.model.stated), **channels}
    trials = [{"id": t.id, "condition": study.condition(t), "overrides": dict(t.overrides)} for t in study.trials]
    told = _whole(
        verdict,
        study={"title": study.title, "trials": trials, "channels": channels, "body": _body(study)},
        traces=[
            t
            for p in parts
            for t in _traces(p.trials, p.before.residual, p.after.residual, units, p.model.stated, held_out=True)
        ],
        hypotheses=[h for p in parts for h in _of_part(p, p.name if len(parts) > 1 else "")],
        located=[(balance(p, r.balance, parts), r) for p, r in rows],
        surfaces=[(balance(p, s.balance, parts), s) for p, s in surfaces],
        whiteness=[],
        labels=[p.fit.hypothesis.label for p in parts],
        checks=[c for p in parts for c in p.checks],
    )
    return {**told, "parts": [written(p) for p in verdict.parts or ()]}


def _whole(
    verdict: Verdict,
    *,
    study: dict[str, Any],
    traces: list[dict[str, Any]],
    hypotheses: list[dict[str, Any]],
    located: Sequence[tuple[str, Row]],
    surfaces: Sequence[tuple[str, Surface]],
    whiteness: list[dict[str, Any]],
    labels: Sequence[Label],
    checks: Sequence[Check],
) -> dict[str, Any]:
    return {
        "study": study,
        "traces": traces,
        "hypotheses": hypotheses,
        "located": [{**written(pattern(r, name)), "significance": r.score} for name, r in located[:SHOWN]],
        "surfaces": [{**asdict(s), "balance": name} for name, s in surfaces],
        "whiteness": whiteness,
        "formulas": _formulas(labels),
        "checks": [asdict(c) for c in checks],
        "timing": {"seconds": verdict.seconds},
    }


def _body(study: Study) -> str:
    """What a body that floats is called here; catalogues know it as the target."""
    groups = {name.split(".")[0] for name in study.channels()}
    return "target" if "target" in groups else "body"


def _units(study: Study) -> dict[str, str]:
    """Channel -> SI unit."""
    return {s.name: s.unit for t in study.trials for s in study.recording(t).series.values()}


def _channels(
    trials: Sequence[TrialData], units: Mapping[str, str], stated: Collection[str]
) -> dict[str, dict[str, Any]]:
    """Unit, noise (where it is stated) and stream of every channel that is compared."""
    out: dict[str, dict[str, Any]] = {}
    for trial in trials:
        for block in trial.blocks:
            for channel, weight in zip(block.channels, block.weight, strict=True):
                sigma = 1.0 / float(weight.max()) if channel in stated and weight.any() else None
                out.setdefault(channel, {"unit": units.get(channel, ""), "sigma": sigma, "stream": block.stream})
    return out


def _traces(
    trials: Sequence[TrialData],
    before: Mapping[str, np.ndarray],
    after: Mapping[str, np.ndarray],
    units: Mapping[str, str],
    stated: Collection[str],
    held_out: bool,
) -> list[dict[str, Any]]:
    """Measured and predicted, every piece of every trial joined again, thinned to POINTS.

    Args:
        trials: the data.
        before, after: weighted residuals by trial, shape (S,).
        units: SI, by channel.
        stated: channels whose noise is.
        held_out: whether the residuals are of trials that were not fitted.
    """
    joined: dict[tuple[str, str], list[dict[str, np.ndarray]]] = {}
    about: dict[tuple[str, str], tuple[str, float | None]] = {}
    for trial in trials:
        if trial.id not in before or trial.id not in after:
            continue
        told = [split(r[trial.id], trial) for r in (before, after)]
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                good = block.weight[c] > 0.0
                size = np.where(good, 1.0 / np.where(good, block.weight[c], 1.0), np.nan)
                piece = {
                    "time": block.time,
                    "measured": np.where(good, block.value[c], np.nan),
                    "before": block.value[c] + told[0][channel] * size,
                    "after": block.value[c] + told[1][channel] * size,
                }
                key = (trial.recorded, channel)
                joined.setdefault(key, []).append(piece)
                sigma = float(np.nanmin(size)) if channel in stated and good.any() else None
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
                "held_out": held_out,
                **{k: v[pick] for k, v in whole.items()},
            }
        )
    return out


def _of_rig(
    found: Found, judgement: Judgement, unseen: Mapping[Label, float], withdrawn: Mapping[Label, str]
) -> list[dict[str, Any]]:
    """Every rival with its score and why it lost; then what was only screened."""
    lost = {**withdrawn} | {r.fit.hypothesis.label: r.lost for r in judgement.rivals}
    above = {r.fit.hypothesis.label: r.score for r in judgement.rivals}
    rows = []
    fits = {id(f): f for f in (judgement.chosen, found.baseline, *found.fits.values())}
    for fit in sorted(fits.values(), key=lambda f: f.cost):
        label = fit.hypothesis.label
        chosen = label == judgement.chosen.hypothesis.label
        rows.append(
            _fitted(
                fit,
                "" if chosen else lost.get(label) or why_nameless(fit, found.implausible) or NOT_WEIGHED,
                chi2=fit.chi2,
                chi2_per_sample=fit.chi2 / max(fit.samples, 1),
                unseen=unseen.get(label),
                above=None if chosen else above.get(label),
                chosen=chosen,
            )
        )
    rest = sorted(((g, k) for k, g in found.screened.items() if k not in found.fits), key=lambda p: -p[0])
    for gain, label in rest[:SCREENED]:
        chi2 = found.baseline.chi2 - gain
        per_sample = chi2 / max(found.baseline.samples, 1)
        why = "only screened: others promised more"
        rows.append(_row(label, "screened", why, chi2=chi2, chi2_per_sample=per_sample))
    return rows


def _row(label: Label, stage: str, lost: str, **figures: Any) -> dict[str, Any]:
    """What a table says of a set of effects, each at its place."""
    unknown: dict[str, Any] = {"chi2": None, "chi2_per_sample": None, "held_out": None, "parameters": {}}
    effects = [{"effect": said_name(e), "where": w} for e, w in label]
    return {"effects": effects, "stage": stage, **unknown, **figures, "lost": lost}


def _fitted(fit: Fit, lost: str, **figures: Any) -> dict[str, Any]:
    own = {k: v for k, v in fit.values().items() if "@" in k}
    return _row(fit.hypothesis.label, "fitted", lost, parameters=own, **figures)


def _whiteness(before: Left, after: Left) -> list[dict[str, Any]]:
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


def _formulas(labels: Sequence[Label]) -> list[dict[str, str]]:
    """Formula and source of every effect named."""
    out = []
    for name, where in dict.fromkeys(pair for label in labels for pair in label):
        effect = effect_of(name)
        out.append(
            {
                "effect": said_name(name),
                "where": where,
                "title": effect.title,
                "latex": effect.formula,
                "source": effect.source,
            }
        )
    return out


def _of_part(part: Part, name: str) -> list[dict[str, Any]]:
    """Every candidate that was tried on unseen data with why it lost, then what was only screened."""
    growth = part.growth
    best = growth.considered[0].error
    base = growth.considered_baseline
    rows = [
        _fitted(
            c.fit,
            _lost(c, part),
            part=name,
            ratio=c.error / base.error,
            held_out=-float(np.log(c.error / best)) if np.isfinite(c.error) else None,
        )
        for c in growth.considered
    ]
    tried = {c.label for c in growth.considered}
    rest = sorted(((left, label) for label, left in growth.screened if label not in tried), key=lambda pair: pair[0])
    for left, label in rest[:SCREENED]:
        share = 100.0 * float(np.sqrt(left))
        rows.append(
            _row(label, "screened", f"only screened: promised {share:.3g} % of the error", part=name, ratio=None)
        )
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
