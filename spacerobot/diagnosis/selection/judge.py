"""The verdict: what the fits of a search allow one to say, and how surely."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.selection.nameable import held, means
from spacerobot.diagnosis.selection.penalty import defect, instead_of_values, lead_over, score, simplest
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.candidates import by_name, contains
from spacerobot.diagnosis.terms.decision import (
    BENT,
    EARN,
    FEW,
    GROUP_LIMIT,
    HELD_OFF,
    LEVEL_LIMIT,
    MARGIN,
    MOVED,
    PENALTY,
    SIGNIFICANT,
)
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.kinds import (
    AMBIGUOUS,
    NAMED,
    NOT_TRUSTED,
    NOTHING_MISSING,
    UNKNOWN,
    WRONG_PARAMETER,
    Kind,
)


@dataclass(frozen=True)
class Rival:
    """One hypothesis with its penalised cost over the best one's, and what was decided of it."""

    fit: Fit
    score: float
    lost: str


@dataclass(frozen=True)
class Judgement:
    """What is said, on which fit, against which rivals."""

    verdict: Kind
    confidence: float
    chosen: Fit
    alternatives: tuple[Fit, ...]
    rivals: tuple[Rival, ...]
    moved: tuple[str, ...]

    @property
    def lead(self) -> float:
        """Penalised cost of the nearest rival over the chosen fit's, sets that hold the chosen one apart."""
        label = self.chosen.hypothesis.label
        return min((r.score for r in self.rivals if not contains(r.fit.hypothesis.label, label)), default=0.0)


def moved(fit: Fit) -> tuple[str, ...]:
    """Believed values that the data move beyond MOVED stated sigmas."""
    return tuple(k for k, s in fit.hypothesis.sigmas(fit.z).items() if abs(s) > MOVED)


def sure_of_values(fit: Fit) -> float:
    """How sure it is on which side of MOVED the furthest of the believed values lies: even odds there, 1 far from it.

    What is stated of a value is a standard deviation, so that odds grow as those of a normal distribution do.
    """
    away = fit.hypothesis.sigmas(fit.z)
    # what lies within a bound for certain is on one side
    free = [f for f in fit.hypothesis.free if f.key in away and max(map(abs, f.bounds)) > MOVED]
    furthest = max((abs(away[f.key]) for f in free), default=0.0)
    return float(1.0 - 0.5 * np.exp(-0.5 * abs(furthest**2 - MOVED**2)))


def contradicted(fit: Fit) -> tuple[str, ...]:
    """Believed values that are moved, or that hold off readings which do not tell them well enough to move them.

    To give such a one up must earn what an effect must.
    """
    held_off = {name for name, apart in fit.contradictions().items() if abs(apart) > HELD_OFF}
    return tuple(k for k, s in fit.hypothesis.sigmas(fit.z).items() if abs(s) > MOVED or k in held_off)


def _wrong(base: Fit, freed: Fit | None) -> tuple[str, ...]:
    """Believed values that are stated wrongly where no effect is missing: those set free, and any still moved."""
    return moved(base) if freed is None else tuple(dict.fromkeys((*freed.hypothesis.freed, *moved(freed))))


def judge(
    found: Found,
    left_of: Mapping[int, Left],
    freed: Fit | None,
    failed: Sequence[str],
    withdrawn: Collection[Label] = (),
) -> Judgement:
    """Decide.

    Args:
        found: the search's fits.
        left_of: what each finalist leaves over, by id(fit); the baseline and the best few are there.
        freed: the baseline refitted without the priors of the values it moves, or None where it moves none.
        failed: names of the fit's own checks that failed.
        withdrawn: sets with an effect whose interval does not show it (`shown.py`); they are not named.
    """
    base = found.baseline
    nameless = [f for f in found.fits.values() if f.hypothesis.label in withdrawn or held(f) or found.implausible(f)]
    candidates = [base, *(f for f in found.fits.values() if means(f) and f not in nameless)]
    inflation = min((left_of[id(f)].inflation for f in [*candidates, *nameless] if id(f) in left_of), default=1.0)
    scores = {id(f): score(f, inflation) for f in [*candidates, *nameless]}
    if freed is not None and not moved(base) and score(freed, inflation) > scores[id(base)] - EARN:
        freed = None  # the noise is louder than it seemed
    many = freed is not None and len(_wrong(base, freed)) > FEW
    at_will = np.inf if freed is None else score(freed, inflation)
    if not many:
        scores[id(base)] = min(scores[id(base)], at_will)
    ranked = sorted(candidates, key=lambda f: scores[id(f)])
    best = simplest(ranked, scores, scores[id(base)], lambda f: _adequate(f, left_of))
    lead = scores[id(base)] - scores[id(best)]
    bent = many and at_will < scores[id(best)] - MARGIN  # many wrong values do better than any effect
    if best is base or lead < EARN or bent:
        if freed is not None and not (bent or failed):
            instead = _instead(freed, at_will, ranked, scores, left_of)
            if instead:
                return _either(instead, freed, at_will, ranked, scores)
        said = _without_effect(base, freed, ranked, scores, left_of, failed)
        return _unnamed(said, [f for f in nameless if scores[id(f)] < scores[id(base)] - EARN])
    parts = {id(p): _floor(p, best, scores[id(base)] - scores[id(p)], left_of) for p in _parts(best, ranked)}
    known = [p for p in ranked if id(p) in parts and _law_of_its_own(p, left_of)]
    favourite = next((p for p in known if scores[id(p)] - scores[id(best)] < parts[id(p)]), best)
    explained = scores[id(base)] - scores[id(favourite)]
    owed = lead_over(explained) if _adequate(favourite, left_of) else MARGIN
    rivals: list[Rival] = []
    equal: list[Fit] = []
    odds = 0.0
    for fit in ranked:
        if fit is favourite:
            continue
        gap = scores[id(fit)] - scores[id(best)]
        floor = parts.get(id(fit), 0.0)
        if fit is best:  # all that it earns may be a defect of the favourite's own law
            equal.append(fit)
            behind = scores[id(favourite)] - scores[id(best)]
            odds += float(np.exp(-0.5 * MARGIN * (1.0 - behind / parts[id(favourite)])))
            lost = "not told apart: what it earns may be a defect of the favourite's own law"
        elif by_name(fit.hypothesis.label) in [by_name(f.hypothesis.label) for f in (favourite, *equal)]:
            lost = "another form of what stands here already"
        elif contains(fit.hypothesis.label, favourite.hypothesis.label):
            lost = f"holds the favourite as a special case and {_gains(scores[id(favourite)] - scores[id(fit)], owed)}"
        elif gap < MARGIN:
            equal.append(fit)
            odds += float(np.exp(-0.5 * gap))
            lost = f"not told apart: chi-squared differs by {fit.cost - favourite.cost:+.1f}"
        elif gap < floor:
            equal.append(fit)
            odds += float(np.exp(-0.5 * MARGIN * gap / floor))
            lost = "not told apart: what it leaves may be a defect of its own law"
        else:
            odds += float(np.exp(-0.5 * min(gap, 700.0)))
            lost = f"chi-squared larger by {fit.cost - favourite.cost:.0f}"
        rivals.append(Rival(fit, scores[id(fit)] - scores[id(favourite)], lost))
    if favourite is best:
        odds += _richer(favourite, ranked, scores, owed)
    left = left_of.get(id(favourite))
    adequate = left is not None and left.adequate
    verdict: Kind
    if failed:
        verdict = NOT_TRUSTED
    elif not adequate or _too_many(favourite):
        verdict = UNKNOWN
    else:
        verdict = AMBIGUOUS if equal else NAMED
    confidence = 1.0 / (1.0 + odds) * (1.0 - np.exp(-0.5 * (lead - EARN + 6.0)))
    if verdict == UNKNOWN:
        confidence = BENT if adequate else _surprise(left)
    said = Judgement(
        verdict,
        float(np.clip(confidence, 0.05, 0.99)),
        favourite,
        (favourite, *equal) if verdict == AMBIGUOUS else (),
        tuple(rivals),
        moved(favourite),
    )
    sound = [f.hypothesis.label for f in ranked if f.hypothesis.sites and _adequate(f, left_of)]
    others = [f for f in nameless if not any(contains(f.hypothesis.label, label) for label in sound)]
    return _unnamed(said, [f for f in others if scores[id(f)] < scores[id(best)] - MARGIN])


def _gains(gain: float, owed: float) -> str:
    """What a richer set gains over the favourite, in words."""
    if gain <= 0.0:
        return "gains nothing by it"
    return f"gains less than the {owed:.0f} it must" if gain < owed else "gains too little by it"


def _too_many(fit: Fit) -> bool:
    """Whether effects and values that stay bent beside them are more than may well be wrong at once.

    A bend counts that costs what an effect must earn: in one campaign of a hundred a value is off by three sigmas.
    """
    bends = sum(s * s > EARN for s in fit.hypothesis.sigmas(fit.z).values())
    return bends > 0 and len(fit.hypothesis.sites) + bends > FEW


def _parts(best: Fit, ranked: Sequence[Fit]) -> list[Fit]:
    """Sets of effects that the best one holds."""
    return [f for f in ranked if f.hypothesis.sites and contains(best.hypothesis.label, f.hypothesis.label)]


def _adequate(fit: Fit, left_of: Mapping[int, Left]) -> bool:
    return id(fit) in left_of and left_of[id(fit)].adequate


def _floor(part: Fit, whole: Fit, explained: float, left_of: Mapping[int, Left]) -> float:
    return defect(part, whole, explained, _adequate(part, left_of))


def _law_of_its_own(part: Fit, left_of: Mapping[int, Left]) -> bool:
    """Whether a part leaves nothing but noise, and its law is known to be the simplest of its kind."""
    return _adequate(part, left_of) and any(s.effect.stands_for for s in part.hypothesis.sites)


def _richer(favourite: Fit, ranked: Sequence[Fit], scores: Mapping[int, float], owed: float) -> float:
    """Odds that the nearest set that holds the favourite is meant: even where it would earn its place by so much."""
    label = favourite.hypothesis.label
    gains = [scores[id(favourite)] - scores[id(f)] for f in ranked if contains(f.hypothesis.label, label)]
    return float(np.exp(0.5 * MARGIN * min(max(gains, default=-np.inf) / owed - 1.0, 0.0)))


def _unnamed(said: Judgement, better: Sequence[Fit]) -> Judgement:
    """Unknown, where a set that shows none of its effects (at a bound, or perhaps nothing) explains more than what is
    said: something is there, and that is not its name.
    """
    if not better or said.verdict == NOT_TRUSTED:
        return said
    return replace(said, verdict=UNKNOWN, confidence=max(said.confidence, BENT), alternatives=())


def _instead(
    freed: Fit, at_will: float, ranked: Sequence[Fit], scores: Mapping[int, float], left_of: Mapping[int, Left]
) -> list[Fit]:
    """Effects that put back believed values and cost less than wrong values do, best first."""
    bar = instead_of_values(at_will, len(moved(freed)))
    better = [f for f in ranked if len(f.hypothesis.sites) == 1 and scores[id(f)] < bar and not moved(f)]
    return [f for f in better if id(f) in left_of and left_of[id(f)].adequate]


def _either(
    instead: Sequence[Fit], freed: Fit, at_will: float, ranked: Sequence[Fit], scores: Mapping[int, float]
) -> Judgement:
    """Ambiguous: one of these effects, or values that are stated wrongly."""
    least = scores[id(instead[0])]
    equal = [f for f in instead if scores[id(f)] < least + MARGIN]
    rivals = [Rival(f, scores[id(f)] - least, "not told apart from it") for f in equal[1:]]
    rivals.append(Rival(freed, at_will - least, "not told apart: wrong values instead of an effect"))
    others = [f for f in ranked if f not in equal]
    rivals += [Rival(f, scores[id(f)] - least, "explains less") for f in others]
    weight = float(np.exp(-0.5 * np.clip([r.score for r in rivals], 0.0, 700.0)).sum())
    confidence = float(np.clip(1.0 / (1.0 + weight), 0.05, 0.99))
    return Judgement(AMBIGUOUS, confidence, instead[0], (*equal, freed), tuple(rivals), ())


def _without_effect(
    base: Fit,
    freed: Fit | None,
    ranked: Sequence[Fit],
    scores: Mapping[int, float],
    left_of: Mapping[int, Left],
    failed: Sequence[str],
) -> Judgement:
    left = left_of[id(freed)] if freed is not None and id(freed) in left_of else left_of[id(base)]
    out = _wrong(base, freed)
    verdict: Kind
    if failed:
        verdict = NOT_TRUSTED
    elif not left.adequate or len(out) > FEW:
        verdict = UNKNOWN
    else:
        verdict = WRONG_PARAMETER if out else NOTHING_MISSING
    best_gain = max((scores[id(base)] - scores[id(f)] for f in ranked if f is not base), default=-PENALTY)
    chosen = freed if freed is not None and verdict == WRONG_PARAMETER else base
    unearned = 1.0 - np.exp(-0.25 * max(EARN - best_gain, 0.0))
    confidence = float(np.clip(unearned * sure_of_values(chosen), 0.05, 0.99))
    if verdict == UNKNOWN:
        confidence = max(_surprise(left), BENT if len(out) > FEW else 0.0)
    rivals = tuple(
        Rival(f, scores[id(f)] - scores[id(base)], f"earns {base.cost - f.cost:.1f} of chi-squared, too little")
        for f in ranked
        if f is not base
    )
    return Judgement(verdict, confidence, chosen, (), rivals, out)


def _surprise(left: Left | None) -> float:
    """How sure it is that something is left over."""
    if left is None:
        return 0.5
    excess = [
        (c.colour / SIGNIFICANT, c.worst / GROUP_LIMIT, (c.level / c.noise - 1.0) / LEVEL_LIMIT) for c in left.channels
    ]
    worst = max(map(max, excess))
    return float(np.clip(1.0 - np.exp(-0.7 * worst), 0.05, 0.99))
