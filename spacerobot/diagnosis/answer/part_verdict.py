"""verdict.json of a study that is diagnosed part by part."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spacerobot.diagnosis.answer import evidence
from spacerobot.diagnosis.answer.alternatives import alternatives
from spacerobot.diagnosis.answer.events import clocks, touches
from spacerobot.diagnosis.answer.mended_model import FILE, RUNS
from spacerobot.diagnosis.answer.not_predicted import not_predicted
from spacerobot.diagnosis.answer.part_next_trial import next_trial
from spacerobot.diagnosis.answer.verdict import effect_entries, moved_values
from spacerobot.diagnosis.locate.located import LEVEL
from spacerobot.diagnosis.selection.agreed import why_not
from spacerobot.diagnosis.selection.fold import SAME
from spacerobot.diagnosis.selection.judge import (
    AMBIGUOUS,
    NAMED,
    NOT_TRUSTED,
    NOTHING_MISSING,
    SETTLED,
    UNKNOWN,
    WRONG_PARAMETER,
)
from spacerobot.diagnosis.selection.part_fold import MOST_FOLDS, TOLD
from spacerobot.diagnosis.selection.part_held_out import HeldOut, scheme_of
from spacerobot.diagnosis.selection.part_limits import PartLimits
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.recordings.study import Study

PRECEDENCE = (NOT_TRUSTED, NAMED, AMBIGUOUS, UNKNOWN, WRONG_PARAMETER, NOTHING_MISSING)
"""Of the parts' verdicts, the first that occurs is the study's: what is named at one joint stays named whatever is
said of another. Only where noise is stated is it certain that the other lacks something, and no set without it whole.
"""


def verdict_of(study: Study, parts: Sequence[Part], *, version: str, seed: int, seconds: float) -> dict[str, Any]:
    """The whole of verdict.json; beside what every verdict has, "parts" with each part's own."""
    own = [p.verdict for p in parts]
    verdict = next(v for v in PRECEDENCE if v in own)
    if verdict == NAMED and any(v == AMBIGUOUS and p.loudness for p, v in zip(parts, own, strict=True)):
        verdict = AMBIGUOUS
    said = (AMBIGUOUS, NAMED) if verdict == AMBIGUOUS else (verdict,)
    speaking = [p for p, v in zip(parts, own, strict=True) if v in said]
    effects = [e for p in speaking for e in entries(p, len(parts))] if verdict == NAMED else []
    further = [next_trial(p) for p, v in zip(parts, own, strict=True) if v == AMBIGUOUS]
    seen = touches([p.model for p in parts])
    return {
        "format": 1,
        "spacerobot": version,
        "input_hash": study.input_hash,
        "seed": seed,
        "study": study.title,
        "seconds": round(seconds, 3),
        "verdict": verdict,
        "confidence": float(np.mean([p.confidence for p in speaking])),
        "why": [line for p in parts for line in why_not(p.checks)],
        "effects": effects,
        "alternatives": alternatives(speaking, verdict),
        "parameters": _all_moved(parts),
        "exact": exact(study, parts),
        "moved": moved(parts),
        "located": [
            {**r.entry(), "balance": balance(p, r.balance, parts)}
            for p in parts
            if p.located is not None
            for r in p.located.rows
            if r.p < LEVEL
        ],
        "not_located": {p.name: why for p in parts if (why := _not_located(p))},
        "held_out": held_out(parts),
        "not_predicted": not_predicted(study, _known(parts)),
        "detectable": _detectable(parts),
        "next_experiment": next((n for n in further if n is not None), None),
        "model": {"file": FILE, "run": RUNS},
        "events": [t.entry() for t in seen],
        "clocks": clocks(study, seen),
        "parts": [_entry(p, v) for p, v in zip(parts, own, strict=True)],
    }


def _known(parts: Sequence[Part]) -> set[str]:
    """Channels that some part predicts, or takes as they were recorded."""
    return {c for p in parts for c in (*p.model.given, *(c for t in p.model.trials for c in t.channels))}


def _not_located(part: Part) -> str:
    """Why nothing is located in a part; nothing to say where something is."""
    if part.located is None:
        return part.model.no_balance
    if any(r.p < LEVEL for r in part.located.rows):
        return ""
    pieces = len({t.recorded for t in part.trials})
    return (
        f"no pattern of its balance agrees over {pieces} recorded {'trial' if pieces == 1 else 'trials'} to a level of "
        f"{LEVEL:g}, or it closes"
    )


def entries(part: Part, count: int) -> list[dict[str, Any]]:
    """The effects that a part lacks; of several bodies each says which one it is."""
    found = named_entries(part)
    return [{**e, "part": part.name} for e in found] if count > 1 else found


def named_entries(part: Part) -> list[dict[str, Any]]:
    """The effects that a part lacks, with their values; what turns has its parameters named and counted in angles."""
    turning = part.turning
    out = []
    for entry in effect_entries(part.fit, 1.0):
        parameters = entry["parameters"]
        if entry["where"] in turning:
            parameters = {of_turning(n): {**p, "unit": turning_unit(p["unit"])} for n, p in parameters.items()}
        out.append({**entry, "parameters": parameters})
    return out


def of_turning(name: str) -> str:
    """A parameter's name where its effect sits on something that turns: force_N is force_Nm."""
    for pattern, by in _TURNED:
        if re.search(pattern, name):
            return re.sub(pattern, by, name)
    return name


_TURNED = (
    (r"_Ns2_m2$", "_Nms2_rad2"),
    (r"_Ns_m$", "_Nms_rad"),
    (r"_N_m3$", "_Nm_rad3"),
    (r"_N_m$", "_Nm_rad"),
    (r"_m_s$", "_rad_s"),
    (r"_Ns$", "_Nms"),
    (r"_kg$", "_kgm2"),
    (r"_N$", "_Nm"),
    (r"_m$", "_rad"),
)


def turning_unit(unit: str) -> str:
    """The unit of the same law about an axis: N is N m, m is rad, kg is kg m^2."""
    above, _, below = unit.partition("/")
    above = {"N": "N m", "kg": "kg m^2", "m": "rad"}.get(above, above.replace("N s", "N m s"))
    return f"{above}/{below.replace('m', 'rad')}" if below else above


def balance(part: Part, name: str, parts: Sequence[Part]) -> str:
    """Name of a balance; where another part calls one of its own alike, with the part's name."""
    others = [r.balance for p in parts if p is not part and p.located is not None for r in p.located.rows]
    return f"{part.name}: {name}" if name in others else name


def _moved(part: Part) -> dict[str, Any]:
    return moved_values(part.fit, part.moved, part.model.believed.sigma, 1.0, settled=part.verdict in SETTLED)


def _all_moved(parts: Sequence[Part]) -> dict[str, Any]:
    """Of a value that several parts judge, the one that moves it furthest."""
    out: dict[str, Any] = {}
    for part in parts:
        for name, entry in _moved(part).items():
            if name not in out or _far(entry) > _far(out[name]):
                out[name] = entry
    return out


def moved(parts: Sequence[Part]) -> dict[str, dict[str, Any]]:
    """How far every believed value that was free moved; of one that several parts judge, the furthest."""
    out: dict[str, dict[str, Any]] = {}
    for part in parts:
        for name, entry in evidence.moved(part.fit).items():
            if name not in out or abs(entry["in_sigmas"] or 0.0) > abs(out[name]["in_sigmas"] or 0.0):
                out[name] = entry
    return dict(sorted(out.items(), key=lambda item: -abs(item[1]["in_sigmas"] or 0.0)))


def exact(study: Study, parts: Sequence[Part]) -> list[str]:
    """Stated values that every part that has them holds as they are stated: those without a sigma."""
    free = {f.key for p in parts for f in p.fit.hypothesis.free}
    used = {n for p in parts for n in (*p.model.believed.values, *(v for t in p.trials for v in t.overrides))}
    stated = dict.fromkeys(n for t in study.trials for n in study.values(t))
    return [n for n in stated if n in used and n not in free and n not in study.sigma]


def _far(entry: Mapping[str, Any]) -> float:
    return float(abs(entry["value"] - entry["believed"]) / entry["sigma"])


def sizes(parts: Sequence[Part]) -> dict[str, float]:
    """By channel, what errors are measured by over all: its stated noise where every channel's is, else its spread."""
    if all(c in p.model.stated for p in parts for t in p.trials for c in t.channels):
        return {c: 1.0 / float(w.max()) for p in parts for t in p.model.trials for c, w in _weights(t)}
    values: dict[str, list[np.ndarray]] = {}
    for part in parts:
        for trial in part.trials:
            for channel in trial.channels:
                x = trial.channel(channel)[1]
                values.setdefault(channel, []).append(x)
    return {c: float(np.std(np.concatenate(v))) or 1.0 for c, v in values.items()}


def _weights(trial: Any) -> list[tuple[str, np.ndarray]]:
    return [(c, w) for b in trial.blocks for c, w in zip(b.channels, b.weight, strict=True)]


def held_out(parts: Sequence[Part]) -> dict[str, Any]:
    """Held-out errors by channel in SI, and over all in "unit": "sigma" where the noise is stated, else "spread"."""
    sums: dict[str, np.ndarray] = {}
    for part in parts:
        for channel, row in part.errors().items():
            sums[channel] = sums.get(channel, np.zeros(len(TOLD) + 1)) + np.array(row, dtype=float)
    scale = sizes(parts)
    stated = all(c in p.model.stated for p in parts for t in p.trials for c in t.channels)
    total = sum((row[:-1] / scale[c] ** 2 for c, row in sums.items()), np.zeros(len(TOLD)))
    count = max(sum(row[-1] for row in sums.values()), 1.0)
    said = [(p, f) for p in parts if p.unseen is not None for f in p.unseen.folds]
    return {
        "scheme": scheme_of(parts[0].trials, MOST_FOLDS),
        "unit": "sigma" if stated else "spread",
        "channels": {
            c: {f"rms_{n}": math.sqrt(x / max(row[-1], 1.0)) for n, x in zip(TOLD, row[:-1], strict=True)}
            for c, row in sums.items()
        },
        "overall": {
            **{f"rms_{n}": math.sqrt(x / count) for n, x in zip(TOLD, total, strict=True)},
            "noise_floor": 1.0 if stated else None,
            **{f"chi2_{n}": float(x) if stated else None for n, x in zip(TOLD, total, strict=True)},
        },
        "decided": "effects chosen among those in play, weights and all values, without the trials that are predicted",
        "taken_from_unseen": ["each piece's own start, from its readings and the sensor's noise"],
        "same_set": sum(f.leads_to == SAME for _, f in said),
        "folds": [
            {
                "part": p.name,
                "left_out": list(f.out),
                "selected": [{"effect": e, "where": w} for e, w in f.selected],
                "leads_to": f.leads_to,
                **_fold_rms(p, f.out),
            }
            for p, f in said
        ],
        "failed": [{"part": p.name, "trial": t, "model": n, "why": w} for p, f in said for t, n, w in f.failed],
    }


def _fold_rms(part: Part, out: Sequence[str]) -> dict[str, float]:
    """Weighted rms of a fold's trials, in the part's own weights."""
    return {
        f"rms_{n}": HeldOut({t: h.residual[t] for t in out}, {t: h.counted[t] for t in out}).mean_square ** 0.5
        for n, h in zip(TOLD, (part.before, part.after, part.selected), strict=True)
    }


def _detectable(parts: Sequence[Part]) -> list[dict[str, Any]]:
    """The smallest effects that would have been named, beside what each part is found to lack."""
    out = []
    for part in parts:
        rows = [limit.entry() for limit in PartLimits(part.growth).of(part.growth.sites)]
        out += [{**r, "part": part.name} for r in rows] if len(parts) > 1 else rows
    return out


def _entry(part: Part, verdict: str) -> dict[str, Any]:
    before, after = (float(np.sqrt(h.mean_square)) for h in (part.before, part.after))
    loudness = part.loudness
    return {
        "part": part.name,
        "verdict": verdict,
        "confidence": part.confidence,
        "effects": [] if verdict == UNKNOWN else named_entries(part),
        "compared": part.model.metric,
        **({"rms_over_stated_noise": loudness} if loudness else {}),
        "error_ratio": after / before if before else None,
        "values": _fitted(part),
        "relative_to": list(part.model.relative_to),
    }


def _fitted(part: Part) -> Mapping[str, float]:
    """What the baseline left open, as fitted."""
    fit = part.fit
    return {f.key: f.value(float(z)) for f, z in zip(fit.hypothesis.free, fit.z, strict=True) if f.kind != "effect"}
