"""verdict.json: the judgement in the words and numbers that users were promised."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.interval import Intervals, interval
from spacerobot.diagnosis.selection.judge import AMBIGUOUS, MOVED, NAMED, SETTLED, Judgement
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.parameters import TIMES_STATED, Free


def effect_entries(fit: Fit, inflation: float, profiled: Intervals | None = None) -> list[dict[str, Any]]:
    """The fit's effects with their values, intervals and units."""
    entries = []
    for site in sorted(fit.hypothesis.sites, key=lambda s: s.label):
        values = {}
        for parameter in site.effect.parameters:
            key = site.key(parameter.name)
            value, ci = interval(fit, key, inflation)
            ci = (profiled or {}).get(key, ci)
            values[parameter.name] = {"value": value, "ci95": list(ci), "unit": parameter.unit}
        entry: dict[str, Any] = {"effect": site.effect.name, "where": site.where, "parameters": values}
        if site.trials:
            entry["trials"] = list(site.trials)
        entries.append(entry)
    return entries


def alternative(fit: Fit, best: Fit, sigma: Mapping[str, float]) -> dict[str, Any]:
    """One of several sets that the data cannot tell apart; its score is -2 ln of the likelihood over the best's.

    One without an effect is told by the believed values that it moves.
    """
    stated = set() if fit.hypothesis.sites else _wrong(fit, sigma)
    return {
        "effects": [{"effect": e, "where": w} for e, w in fit.hypothesis.label],
        "parameters": {k: v for k, v in fit.values().items() if "@" in k or k in stated},
        "score": fit.cost - best.cost,
    }


def _wrong(fit: Fit, sigma: Mapping[str, float]) -> set[str]:
    """Believed values that a fit has beyond MOVED of their stated sigmas, whatever it was told of them."""
    pairs = [(f, f.value(float(z))) for f, z in zip(fit.hypothesis.free, fit.z, strict=True) if f.kind == "believed"]
    return {f.key for f, value in pairs if abs(value - f.centre) > MOVED * abs(f.centre) * sigma[f.key]}


def moved_values(
    fit: Fit,
    names: Sequence[str],
    sigma: Mapping[str, float],
    inflation: float,
    profiled: Intervals | None = None,
    *,
    settled: bool = True,
) -> dict[str, Any]:
    """Believed values beyond three of their sigmas; where the physics is not settled, without intervals."""
    out = {}
    for name in names:
        value, ci = interval(fit, name, inflation)
        ci = (profiled or {}).get(name, ci)
        free = fit.hypothesis.free[fit.hypothesis.keys.index(name)]
        out[name] = {
            "value": value,
            "ci95": list(ci) if settled else None,
            "unit": unit_of(free),
            "believed": free.centre,
            "sigma": abs(free.centre) * sigma[name],
        }
    return out


def unit_of(free: Free) -> str:
    """Unit of a believed value; of one that each trial states for itself, what its factor is counted in."""
    if not free.stated:
        return TIMES_STATED
    last = free.key.rsplit(".", 1)[-1]
    return {"mass": "kg", "stiffness": "N/m", "yaw_inertia": "kg m^2"}.get(last, "N s/m" if "damping" in last else "")


def verdict_dict(
    judgement: Judgement,
    *,
    version: str,
    input_hash: str,
    seed: int,
    study: str,
    seconds: float,
    sigma: Mapping[str, float],
    inflation: float,
    located: Sequence[Mapping[str, Any]],
    held_out: Mapping[str, Any],
    detectable_sizes: Sequence[Mapping[str, Any]],
    next_experiment: Mapping[str, Any] | None,
    profiled: Intervals | None = None,
) -> dict[str, Any]:
    """The whole of verdict.json."""
    chosen = judgement.chosen
    named = judgement.verdict == NAMED
    alternatives: list[dict[str, Any]] = []
    if judgement.verdict == AMBIGUOUS:
        alternatives = [alternative(f, judgement.alternatives[0], sigma) for f in judgement.alternatives]
    else:
        near = [r.fit for r in judgement.rivals if r.fit.hypothesis.sites][:5]
        alternatives = [alternative(f, chosen, sigma) for f in near]
    return {
        "format": 1,
        "spacerobot": version,
        "input_hash": input_hash,
        "seed": seed,
        "study": study,
        "seconds": round(seconds, 3),
        "verdict": judgement.verdict,
        "confidence": round(judgement.confidence, 4),
        "effects": effect_entries(chosen, inflation, profiled) if named else [],
        "alternatives": alternatives,
        "parameters": moved_values(
            chosen,
            [n for n in judgement.moved if n in chosen.hypothesis.keys],
            sigma,
            inflation,
            profiled,
            settled=judgement.verdict in SETTLED,
        ),
        "located": [dict(row) for row in located],
        "held_out": dict(held_out),
        "detectable": [dict(row) for row in detectable_sizes],
        "next_experiment": None if next_experiment is None else dict(next_experiment),
    }


def labels_of(judgement: Judgement) -> list[Label]:
    """Sets of effects worth a formula: the chosen one and what it could not be told from."""
    return [f.hypothesis.label for f in (judgement.chosen, *judgement.alternatives)]
