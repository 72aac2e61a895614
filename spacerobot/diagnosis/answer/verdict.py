"""The verdict of a wrist rig's study, and what every machine's says alike: fitted effects, moved values, limits."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import UNSET, UnsetType

from spacerobot import __version__
from spacerobot.diagnosis.answer.held_out import of_rig
from spacerobot.diagnosis.answer.learned import learned_law
from spacerobot.diagnosis.answer.not_predicted import not_predicted
from spacerobot.diagnosis.answer.record import (
    FORMAT,
    Alternative,
    Believed,
    ClockOffset,
    Detectable,
    Effect,
    Instead,
    Moved,
    NextExperiment,
    Pattern,
    Value,
    Verdict,
    placed,
)
from spacerobot.diagnosis.answer.spoiled import left_out, noise_told
from spacerobot.diagnosis.answer.turning import counted_in_angles
from spacerobot.diagnosis.fitting.fitted import Fit, Intervals, interval
from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.diagnosis.locate.located import Located, Row
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.limits import Limit
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import LOCATED, MOVED
from spacerobot.diagnosis.terms.hypothesis import LOOSE, Label
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, LEARNED, NAMED, SETTLED
from spacerobot.diagnosis.terms.parameters import TIMES_STATED, Free
from spacerobot.effects.effect import said_name
from spacerobot.recordings.beliefs import ABSORBING, UNSTATED
from spacerobot.recordings.study import Study
from spacerobot.recordings.value_units import unit_of_value

RIVALS = 5
"""Rivals that a verdict lists beside what is said."""


def fitted_effects(fit: Fit, inflation: float, profiled: Intervals | None = None) -> list[Effect]:
    """The fit's effects with their values, intervals and units."""
    return [
        Effect(
            effect=said_name(site.effect.name),
            where=site.where,
            parameters={
                p.name: _value(fit, site.key(p.name), p.unit, inflation, profiled)
                for p in site.effect.parameters
                if not site.effect.learned  # its numbers stand in a table of their own
            }
            | {
                name: Value(value=value, ci95=None, unit=name.partition("_")[2])
                for name, value in site.effect.settings.items()
                if not isinstance(value, str)
            },
            kind=str(site.effect.settings["kind"]) if "kind" in site.effect.settings else UNSET,
            trials=list(site.trials) if site.trials else UNSET,
        )
        for site in sorted(fit.hypothesis.sites, key=lambda s: s.label)
    ]


def _value(fit: Fit, key: str, unit: str, inflation: float, profiled: Intervals | None) -> Value:
    value, ci = interval(fit, key, inflation)
    return Value(value=value, ci95=(profiled or {}).get(key, ci), unit=unit)


def alternative(fit: Fit, best: Fit) -> Alternative:
    """One of several sets that the data cannot tell apart; its score is -2 ln of the likelihood over the best's.

    One without an effect is told by the believed values that it moves.
    """
    stated = set() if fit.hypothesis.sites else _wrong(fit)
    return Alternative(
        effects=placed(fit.hypothesis.label),
        parameters={k: v for k, v in fit.values().items() if "@" in k or k in stated},
        score=fit.cost - best.cost,
    )


def _wrong(fit: Fit) -> set[str]:
    """Believed values that a fit has beyond MOVED of their stated sigmas, whatever it was told of them."""
    return {name for name, sigmas in fit.hypothesis.sigmas(fit.z).items() if abs(sigmas) > MOVED}


def moved_values(
    fit: Fit,
    names: Sequence[str],
    inflation: float,
    profiled: Intervals | None = None,
    *,
    settled: bool = True,
) -> dict[str, Believed]:
    """Believed values beyond three of their sigmas; where the physics is not settled, without intervals."""
    out = {}
    for name in names:
        free = fit.hypothesis.free[fit.hypothesis.keys.index(name)]
        found = _value(fit, name, unit_of(free), inflation, profiled)
        out[name] = Believed(
            value=found.value,
            ci95=found.ci95 if settled else None,
            unit=found.unit,
            believed=free.centre,
            sigma=free.step / (LOOSE if name in fit.hypothesis.freed else 1.0),
        )
    return out


def unit_of(free: Free) -> str:
    """Unit of a believed value; of one that each trial states for itself, what its factor is counted in."""
    if not free.stated:
        return TIMES_STATED
    return unit_of_value(free.key)


def all_moved(fit: Fit, absorbing: Sequence[str] = ()) -> dict[str, Moved]:
    """How far the fit moves every believed value: those that are there to absorb first, then by their stated sigmas.

    Args:
        fit: what is reported.
        absorbing: believed values whose job is to stand for what is not modelled (`beliefs.ABSORBING`).
    """
    pairs = zip(fit.hypothesis.free, fit.z, strict=True)
    sigmas = fit.hypothesis.sigmas(fit.z) | {f.key: float(z) for f, z in pairs if f.kind == "zero"}
    found = [
        (f, f.value(float(z)))
        for f, z in zip(fit.hypothesis.free, fit.z, strict=True)
        if f.kind in ("believed", "absorbing", "zero")
    ]
    found.sort(key=lambda item: (item[0].key not in absorbing, -abs(sigmas.get(item[0].key) or 0.0)))
    return {
        f.key: Moved(
            value=value,
            believed=f.centre,
            in_sigmas=sigmas.get(f.key),
            unit=UNSET if f.stated else TIMES_STATED,
        )
        for f, value in found
    }


def exact(study: Study, fit: Fit) -> list[str]:
    """Believed values that the fit holds as they are stated: those without a sigma."""
    free = {f.key for f in fit.hypothesis.free}
    return [name for name in study.values() if name not in free]


def pattern(row: Row, balance: str | None = None) -> Pattern:
    """What a row of the located patterns says, of a balance that may be called otherwise."""
    return Pattern(balance=balance or row.balance, phase=row.phase, depends_on=row.depends_on, share=row.share, p=row.p)


def detectable(limit: Limit, part: str | UnsetType = UNSET) -> Detectable:
    """The smallest size of an effect that would have been named."""
    effect, where = limit.site.label
    instead: Instead | UnsetType = UNSET
    if limit.instead:
        first, *second = placed(limit.instead)
        instead = Instead(effect=first.effect, where=first.where, beside=second[0] if second else UNSET)
    return Detectable(
        effect=effect,
        where=where,
        parameter=limit.parameter.name,
        smallest=limit.smallest,
        unit=limit.parameter.unit,
        instead=instead,
        part=part,
    )


def verdict_of_rig(
    study: Study,
    model: RigModel,
    trials: Sequence[TrialData],
    judgement: Judgement,
    *,
    seed: int,
    seconds: float,
    inflation: float,
    located: Located,
    held: Unseen | None,
    limits: Sequence[Limit],
    next_experiment: NextExperiment | None,
    profiled: Intervals,
    why: Sequence[str],
    learnt: Learnt | None = None,
    clocks: Sequence[ClockOffset] = (),
) -> Verdict:
    """The whole answer of a wrist rig's study."""
    chosen = judgement.chosen
    lacked = fitted_effects(chosen, inflation, profiled) if judgement.verdict in (NAMED, LEARNED) else []
    if judgement.verdict == AMBIGUOUS:
        others = [alternative(f, judgement.alternatives[0]) for f in judgement.alternatives]
    else:
        near = [r.fit for r in judgement.rivals if r.fit.hypothesis.sites][:RIVALS]
        others = [alternative(f, chosen) for f in near]
    return Verdict(
        format=FORMAT,
        spacerobot=__version__,
        input_hash=study.input_hash,
        seed=seed,
        study=study.title,
        seconds=round(seconds, 3),
        verdict=judgement.verdict,
        confidence=round(judgement.confidence, 4),
        effects=counted_in_angles(lacked, model.turns),
        alternatives=others,
        parameters=moved_values(
            chosen,
            [n for n in judgement.moved if n in chosen.hypothesis.keys],
            inflation,
            profiled,
            settled=judgement.verdict in SETTLED,
        ),
        located=[pattern(r) for r in located.rows if r.p < LOCATED],
        held_out=of_rig(trials, held),
        detectable=[detectable(limit) for limit in limits],
        next_experiment=next_experiment,
        exact=exact(study, chosen),
        assumed=dict.fromkeys(model.beliefs.assumed, UNSTATED) if model.beliefs.assumed else UNSET,
        moved=all_moved(chosen, tuple(ABSORBING)),
        not_predicted=not_predicted(study, {c for t in trials for c in t.channels}),
        why=list(why),
        learned=UNSET if learnt is None else [learned_law(learnt, inflation)],
        clocks=list(clocks) if clocks else UNSET,
        spoiled=left_out(study, trials) or UNSET,
        noise=noise_told(study, trials) or UNSET,
    )


def labels_of(judgement: Judgement) -> list[Label]:
    """Sets of effects worth a formula: the chosen one and what it could not be told from."""
    return [f.hypothesis.label for f in (judgement.chosen, *judgement.alternatives)]
