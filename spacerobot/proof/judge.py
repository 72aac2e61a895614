"""Opening the seal: one campaign's verdict against what was hidden in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from spacerobot.proof.engine.laws import LAWS
from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.spoiled import WAYS

NAMELESS = ("unknown", "learned")
"""What an honest answer says of physics outside the catalogue: nothing, or its law without a name."""

DEFINITE = ("named", "wrong_parameter", "nothing_missing")
"""Verdicts that claim to know."""

NOTICEABLE = 3.0
"""Strength, in detection limits, from which a hidden effect should be found; below it, to see nothing is no error."""

Label = tuple[str, str]


@dataclass(frozen=True)
class Judgement:
    """What a verdict was worth.

    Attributes:
        top: the favourite is the truth: the named set, the first alternative, or the class of verdict.
        in_set: the truth is among what was given.
        confidently_wrong: a definite verdict that is false.
        abstained: unknown, ambiguous or not_trusted, or no answer at all.
        said: the verdict's class.
        favourite: effects that it holds likeliest.
        confidence: as stated, NaN as None.
        parameters: whatever is stated of a value whose truth is known: key, true value, value, interval.
    """

    top: bool
    in_set: bool
    confidently_wrong: bool
    abstained: bool
    said: str
    favourite: tuple[Label, ...]
    confidence: float | None
    parameters: tuple[dict[str, Any], ...] = field(default=())


def labels(effects: Sequence[Mapping[str, Any]]) -> tuple[Label, ...]:
    """(effect, place) of each, sorted."""
    return tuple(sorted((str(e["effect"]), str(e["where"])) for e in effects))


def judge(truth: Mapping[str, Any], verdict: Mapping[str, Any] | None, error: str = "") -> Judgement:
    """Compare a verdict with the seal.

    Args:
        truth: of the seal: effects, expected, parameters, withheld, strength, spoiled.
        verdict: of verdict.json; None where the diagnosis failed.
        error: what it said then.
    """
    if verdict is None:
        refused = WAYS[truth["spoiled"]].refused and "the noise of" in error if truth.get("spoiled") else False
        return Judgement(refused, refused, False, True, "refused" if refused else "failed", (), None)
    said = str(verdict["verdict"])
    named = labels(verdict["effects"])
    sets = [labels(a["effects"]) for a in verdict.get("alternatives", [])]
    favourite = named if said == "named" else (sets[0] if said == "ambiguous" and sets else ())
    given = [named] if said == "named" else (sets if said == "ambiguous" else [])
    hidden = labels(truth["effects"])
    expected = str(truth["expected"])
    top, in_set = _right(expected, hidden, truth, verdict, favourite, given)
    strength = truth.get("strength")
    overlooked = said == "nothing_missing" and expected != "nothing_missing"
    excused = overlooked and strength is not None and strength < NOTICEABLE
    elsewhere = expected == "learned" and said == "learned" and not top
    wrong = elsewhere or (said in DEFINITE and not top and not excused)
    return Judgement(
        top,
        in_set,
        wrong,
        said not in DEFINITE,
        said,
        favourite,
        verdict.get("confidence"),
        _parameters(truth, verdict, favourite),
    )


def _right(
    expected: str,
    hidden: tuple[Label, ...],
    truth: Mapping[str, Any],
    verdict: Mapping[str, Any],
    favourite: tuple[Label, ...],
    given: Sequence[tuple[Label, ...]],
) -> tuple[bool, bool]:
    said = str(verdict["verdict"])
    if expected == "named":
        return favourite == hidden, hidden in given
    if expected == "spoiled":
        return (_right_of_spoiled(hidden, str(truth["spoiled"]), verdict, given),) * 2
    moved = set(verdict.get("parameters", {}))
    if expected == "nothing_missing":
        right = said == "nothing_missing" or (said == "wrong_parameter" and moved <= set(truth["parameters"]))
        return right, right
    if expected == "learned":
        (law,) = (LAWS[name] for name, _ in hidden)
        found = said == "learned" and all(one["where"] == law.where for one in verdict["learned"])
        return found, found or said in ("unknown", "ambiguous", "not_trusted")
    if expected == "unknown":
        return said in NAMELESS, said in (*NAMELESS, "ambiguous", "not_trusted")
    recognised = said == "wrong_parameter" and set(truth["parameters"]) <= moved
    spelled = bool(hidden) and favourite == hidden  # a payload may be called a payload
    return recognised or spelled, recognised or spelled or (bool(hidden) and hidden in given)


def _right_of_spoiled(
    hidden: tuple[Label, ...], way: str, verdict: Mapping[str, Any], given: Sequence[tuple[Label, ...]]
) -> bool:
    """Whether what is hidden is said and nothing else but what spoils the recordings, or that they are spoiled."""
    said, known = str(verdict["verdict"]), WAYS[way]
    spelled = any(one and set(hidden) <= set(one) <= {*hidden, *known.effects} for one in given)
    if said not in DEFINITE:
        return spelled or bool(verdict.get("spoiled") or verdict.get("noise"))
    if said == "named":
        return spelled
    if said == "wrong_parameter":
        return not hidden and set(verdict.get("parameters", {})) <= set(known.values)
    return not hidden


def _parameters(
    truth: Mapping[str, Any], verdict: Mapping[str, Any], favourite: Sequence[Label]
) -> tuple[dict[str, Any], ...]:
    """Of hidden effects that are named, or favoured by an ambiguous answer, and of believed values said to have moved.

    An ambiguous answer's effects have values but no intervals.
    """
    found = []
    best = (verdict.get("alternatives") or [{}])[0].get("parameters") or {}
    for item in truth["effects"]:
        label = (item["effect"], item["where"])
        if label not in favourite:
            continue
        claimed = [e for e in verdict["effects"] if (e["effect"], e["where"]) == label]
        for name, true in item.items():
            key = f"{item['effect']}@{item['where']}.{name}"
            if name in ("effect", "where", "trials", "order", "kind"):
                continue
            if len(claimed) == 1 and name in claimed[0]["parameters"]:
                found.append(_stated(key, true, claimed[0]["parameters"][name]))
            elif not claimed and key in best:
                found.append(_stated(key, true, {"value": best[key]}))
    built = truth.get("rig_as_built") or {}
    for name, value in (verdict.get("parameters") or {}).items():
        true = built.get(f"{name} over believed", built.get(name))
        if isinstance(true, int | float):
            found.append(_stated(name, true, value))
    return tuple(found)


def _stated(key: str, true: float, value: Mapping[str, Any]) -> dict[str, Any]:
    interval = value.get("ci95") or (None, None)
    number, low, high = (x if isinstance(x, int | float) else None for x in (value["value"], *interval))
    return {"parameter": key, "true": true, "value": number, "low": low, "high": high}


def band_share(truth: Mapping[str, Any], verdict: Mapping[str, Any]) -> float | None:
    """Share of a learned law's table whose band holds the true force, with what it trades with; None of another law."""
    law = next((LAWS[e["effect"]] for e in truth["effects"] if e["effect"] in LAWS), None)
    if law is None or verdict["verdict"] != "learned":
        return None
    found, numbers = verdict["learned"][0], truth["effects"][0]
    table = found["table"]
    if (found["where"], found["kind"], table["variable"]) != (law.where, law.kind, law.of):
        return None
    traded = sum(float(truth["rig_as_built"][name]) for name in table["total_with"])
    rows = zip(table["x"], table["low"], table["high"], strict=True)
    inside = [low <= law.curve(x, numbers) + traded * x <= high for x, low, high in rows]
    return sum(inside) / len(inside)


def outside(effects: Sequence[Mapping[str, Any]]) -> bool:
    """Whether any of the effects is in no catalogue."""
    return any(e["effect"] in OUTSIDERS or e["effect"] in LAWS for e in effects)
