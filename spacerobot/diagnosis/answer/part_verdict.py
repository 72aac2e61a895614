"""The verdict of a study that is diagnosed part by part."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from msgspec import UNSET
from msgspec.structs import replace

from spacerobot import __version__
from spacerobot.diagnosis.answer import record
from spacerobot.diagnosis.answer.agreed import agreed
from spacerobot.diagnosis.answer.alternatives import alternatives
from spacerobot.diagnosis.answer.events import clocks, meetings, touches
from spacerobot.diagnosis.answer.held_out import of_parts
from spacerobot.diagnosis.answer.learned import learned_law
from spacerobot.diagnosis.answer.mended_model import FILE, RUNS
from spacerobot.diagnosis.answer.next_trial import WHY_PART, next_trial
from spacerobot.diagnosis.answer.not_predicted import not_predicted
from spacerobot.diagnosis.answer.record import (
    FORMAT,
    Believed,
    Detectable,
    Effect,
    FoundModel,
    Moved,
    NextExperiment,
    Number,
    Value,
    Verdict,
)
from spacerobot.diagnosis.answer.shape_errors import with_shapes
from spacerobot.diagnosis.answer.turning import counted_in_angles
from spacerobot.diagnosis.answer.verdict import all_moved, detectable, fitted_effects, moved_values, pattern
from spacerobot.diagnosis.learning.learned_part import LearnedPart
from spacerobot.diagnosis.selection.check import why_not
from spacerobot.diagnosis.selection.nested_laws import least_alike
from spacerobot.diagnosis.selection.part_result import Part, balance
from spacerobot.diagnosis.selection.stretches import Knock
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.decision import LOCATED, MOVED
from spacerobot.diagnosis.terms.kinds import (
    AMBIGUOUS,
    LEARNED,
    NAMED,
    NOT_TRUSTED,
    NOTHING_MISSING,
    SETTLED,
    UNKNOWN,
    WRONG_PARAMETER,
    Kind,
)
from spacerobot.diagnosis.terms.parameters import zero_key
from spacerobot.effects.effect import said_name
from spacerobot.recordings.study import Study

PRECEDENCE = (NOT_TRUSTED, UNKNOWN, LEARNED, AMBIGUOUS, NAMED, WRONG_PARAMETER, NOTHING_MISSING)
"""Of the parts' verdicts, the first that occurs is the study's: the whole is as weak as the weakest of its parts that
were measured. What is named at one of them stands in its own entry."""

NO_LAW = "no law was learned either"
NO_FORCE = "what stands out in its balances predicts no unseen trial"


def verdict_of(study: Study, parts: Sequence[Part], *, seed: int, seconds: float) -> Verdict:
    """The whole answer; beside what every verdict has, "parts" with each part's own."""
    own = [p.verdict for p in parts]
    told = [v for p, v in zip(parts, own, strict=True) if not p.model.not_measured] or own
    verdict = next(v for v in PRECEDENCE if v in told)
    said = (AMBIGUOUS, NAMED) if verdict == AMBIGUOUS else (verdict,)
    speaking = [p for p, v in zip(parts, own, strict=True) if v in said and (not p.model.not_measured or told is own)]
    effects = agreed([e for p in speaking for e in lacked(p, len(parts))]) if verdict in (NAMED, LEARNED) else []
    effects = with_shapes(effects, speaking)
    further = [next_trial_of(p) for p, v in zip(parts, own, strict=True) if v == AMBIGUOUS]
    seen = touches([p.model for p in parts])
    return Verdict(
        format=FORMAT,
        spacerobot=__version__,
        input_hash=study.input_hash,
        seed=seed,
        study=study.title,
        seconds=round(seconds, 3),
        verdict=verdict,
        confidence=float(np.mean([p.confidence for p in speaking])),
        why=[line for p in parts for line in why_not(p.checks)]
        + [
            f"{p.name}: {NO_LAW if v == UNKNOWN else NO_FORCE}: {p.not_learned.why}"
            for p, v in zip(parts, own, strict=True)
            if p.not_learned and (v == UNKNOWN or p.striking)
        ]
        + [f"{p.name}: {p.model.not_measured}" for p in parts if p.model.not_measured]
        + [line for p, v in zip(parts, own, strict=True) if v == AMBIGUOUS for line in _shared(p)],
        effects=effects,
        alternatives=alternatives(speaking, verdict),
        parameters=_all_moved(parts),
        exact=held_exact(study, parts),
        moved=furthest_moved(parts, [*study.sigma, *study.absolute, *study.values()]),
        located=[
            pattern(r, balance(p, r.balance, parts))
            for p in parts
            if p.located is not None
            for r in p.located.rows
            if r.p < LOCATED
        ],
        not_located={p.name: why for p in parts if (why := _not_located(p))},
        held_out=of_parts(parts),
        not_predicted=not_predicted(study, _known(parts)),
        detectable=_detectable(parts),
        next_experiment=next((n for n in further if n is not None), None),
        model=FoundModel(file=FILE, run=RUNS),
        events=[t.entry() for t in (*seen, *meetings([p.model for p in parts]))],
        clocks=clocks(study, seen),
        learned=_laws(parts) or UNSET,
        parts=[_alone(p, v) for p, v in zip(parts, own, strict=True)],
    )


def _laws(parts: Sequence[Part]) -> list[record.Learned]:
    """Every law that was learned; of several parts each says at which."""
    laws = [(p, p.learnt) for p in parts if isinstance(p, LearnedPart) and p.learnt is not None]
    return [
        learned_law(law, 1.0, turns=law.site.where in p.turning, part=p.name if len(parts) > 1 else UNSET)
        for p, law in laws
    ]


TRIALS = 6
"""Recorded pieces that are varied for the next trial, evenly over all."""


def next_trial_of(part: Part) -> NextExperiment | None:
    """The one under which the chosen explanation and its best rival differ most; None where there is no rival."""
    if not part.rivals:
        return None
    rival = min(part.rivals, key=lambda c: c.error)
    other = least_alike(rival.fit) if contains(rival.label, part.chosen.label) else rival.fit
    trials = part.trials[:: max(1, len(part.trials) // TRIALS)]
    return next_trial((part.fit, other), part.model, trials, part.fit.initials(), why=WHY_PART, part=part.name)


def _known(parts: Sequence[Part]) -> set[str]:
    """Channels that some part predicts, or takes as they were recorded."""
    return {c for p in parts for c in (*p.model.given, *(c for t in p.model.trials for c in t.channels))}


def _not_located(part: Part) -> str:
    """Why nothing is located in a part; nothing to say where something is."""
    if part.located is None:
        return part.model.no_balance
    if any(r.p < LOCATED for r in part.located.rows):
        return ""
    pieces = len({t.recorded for t in part.trials})
    return (
        f"no pattern of its balance agrees over {pieces} recorded {'trial' if pieces == 1 else 'trials'} to a level of "
        f"{LOCATED:g}, or it closes"
    )


def lacked(part: Part, count: int) -> list[Effect]:
    """The effects that a part lacks, with their values; of several parts each says which one it is.

    What turns has its parameters named and counted in angles.
    """
    found = [*fitted_effects(part.fit, 1.0), *map(_struck, part.knocks)]
    out = counted_in_angles(found, part.turning.__contains__)
    return [replace(one, part=part.name) for one in out] if count > 1 else out


def _struck(knock: Knock) -> Effect:
    """A knock in one trial, as the effect that it is."""
    strength, when = knock.effect.parameters
    value, low, high = knock.impulse
    at = knock.moment
    long, shortest, longest = at.lasts
    parameters = {
        strength.name: Value(value=value, ci95=(low, high), unit=strength.unit),
        when.name: Value(value=at.time, ci95=(at.low + 0.5 * longest, at.high - 0.5 * longest), unit=when.unit),
    }
    if long > 0.0:
        parameters["lasts_s"] = Value(value=long, ci95=(shortest, longest), unit=when.unit)
    return Effect(effect=said_name(knock.effect.name), where=knock.where, parameters=parameters, trials=[knock.trial])


def _shared(part: Part) -> list[str]:
    """What every set that predicts as well as the chosen one has too, as a line; none where they share nothing."""
    names = " and ".join(f"{name} at {where}" for name, where in sorted(part.in_all))
    return [f"{part.name}: every explanation that predicts as well has {names}"] if names else []


def _moved(part: Part) -> dict[str, Believed]:
    return moved_values(part.fit, part.moved, 1.0, settled=part.verdict in SETTLED)


def _all_moved(parts: Sequence[Part]) -> dict[str, Believed]:
    """Of a value that several parts judge, the one that moves it furthest."""
    out: dict[str, Believed] = {}
    furthest: dict[str, float] = {}
    for part in parts:
        sigmas = part.fit.hypothesis.sigmas(part.fit.z)
        for name, entry in _moved(part).items():
            if name not in out or abs(sigmas[name]) > furthest[name]:
                out[name], furthest[name] = entry, abs(sigmas[name])
    return out


def furthest_moved(parts: Sequence[Part], stated: Collection[str]) -> dict[str, Moved]:
    """How far every believed value that was free moved; of one that several parts judge, the furthest.

    What the study does not state, the moment of a log within its sample, is told where it is far off alone.
    """
    out: dict[str, Moved] = {}
    for part in parts:
        known = {*stated, *part.model.believed.unknown, *map(zero_key, part.model.believed.zeros)}
        for name, entry in all_moved(part.fit).items():
            if name not in known and _in_sigmas(entry) <= MOVED:
                continue
            if name not in out or _in_sigmas(entry) > _in_sigmas(out[name]):
                out[name] = entry
    return dict(sorted(out.items(), key=lambda item: -_in_sigmas(item[1])))


def _in_sigmas(entry: Moved) -> float:
    return abs(float(entry.in_sigmas or 0.0))


def held_exact(study: Study, parts: Sequence[Part]) -> list[str]:
    """Stated values that every part that has them holds as they are stated: those without a sigma."""
    free = {f.key for p in parts for f in p.fit.hypothesis.free}
    used = {n for p in parts for n in (*p.model.believed.values, *(v for t in p.trials for v in t.overrides))}
    stated = dict.fromkeys(n for t in study.trials for n in study.values(t))
    return [n for n in stated if n in used and n not in free and n not in study.sigma]


def _detectable(parts: Sequence[Part]) -> list[Detectable]:
    """The smallest effects that would have been named, beside what each part is found to lack."""
    return [detectable(limit, part.name if len(parts) > 1 else UNSET) for part in parts for limit in part.limits]


def _alone(part: Part, verdict: Kind) -> record.Part:
    """What is said of one part."""
    before, after = (float(np.sqrt(h.mean_square)) for h in (part.before, part.after))
    return record.Part(
        part=part.name,
        verdict=verdict,
        confidence=part.confidence,
        effects=[] if verdict in (UNKNOWN, NOT_TRUSTED) else lacked(part, 1),
        not_measured=part.model.not_measured or UNSET,
        compared=part.model.metric,
        rms_over_stated_noise=dict(part.loudness) if part.loudness else UNSET,
        error_ratio=after / before if before else None,
        values=_fitted(part),
        relative_to=list(part.model.relative_to),
    )


def _fitted(part: Part) -> dict[str, Number]:
    """What the baseline left open, as fitted."""
    fit = part.fit
    return {f.key: f.value(float(z)) for f, z in zip(fit.hypothesis.free, fit.z, strict=True) if f.kind != "effect"}
