"""The story of a verdict: a badge, one sentence, and what must be said with it; words of its own for each kind."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from spacerobot.view.report.data_spoiled import spoiled
from spacerobot.view.report.evidence import Evidence
from spacerobot.view.report.several import several
from spacerobot.view.report.when import happened
from spacerobot.view.report.words import (
    beyond,
    effect_object,
    effect_phrase,
    effect_title,
    effects_phrase,
    finite,
    is_sensor,
    joined,
    number,
    parameter_label,
    parameters_text,
    percent,
    place,
    quantity,
    unit_of_name,
)

FEW = 3
"""Effects that a sentence can hold with their numbers."""

DILUTED = 0.95
"""Share of the held-out error over all channels that is left, above which the one channel that gained is told of."""


@dataclass(frozen=True)
class Story:
    """What the first screen says.

    Attributes:
        badge: the kind of verdict in two words or so.
        tone: "found", "open" or "warning", for colour.
        headline: a title.
        sentence: the verdict in one sentence.
        more: further sentences that must be read with it.
    """

    badge: str
    tone: str
    headline: str
    sentence: str
    more: tuple[str, ...] = ()


def tell(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    """The story of a verdict."""
    story = _TELLERS[verdict["verdict"]](verdict, evidence)
    if line := several(verdict):
        story = replace(story, headline=line, more=(*(_of_parts(verdict)), *story.more))
    return replace(story, more=(*story.more, *happened(verdict), *spoiled(verdict)))


def _of_parts(verdict: Mapping[str, Any]) -> tuple[str, ...]:
    """What is lacking where it is known, though the whole is not named; and why of some nothing can be said."""
    known = [
        f"{p['part']}: {joined([effect_title(str(e['effect'])) for e in p['effects']])}"
        for p in verdict["parts"]
        if p["verdict"] in ("named", "ambiguous") and p["effects"] and not verdict["effects"]
    ]
    silent = [f"{p['part']}: {p['not_measured']}." for p in verdict["parts"] if p.get("not_measured")]
    return ((f"Of single parts the model lacks, {'; '.join(known)}.",) if known else ()) + tuple(silent)


def capital(text: str) -> str:
    """The text with its first letter large."""
    return text[:1].upper() + text[1:]


def _nearest(channels: Mapping[str, Mapping[str, Any]]) -> tuple[str, float] | None:
    """The channel whose held-out error falls most, and how many times; None if none falls by a tenth."""
    ratios = {}
    for name, entry in channels.items():
        before, after = finite(entry.get("rms_before")), finite(entry.get("rms_after"))
        if before is not None and after:
            ratios[name] = before / after
    best = max(ratios, key=lambda name: ratios[name], default=None)
    return None if best is None or ratios[best] < 1.1 else (best, ratios[best])


def improvement(verdict: Mapping[str, Any]) -> str | None:
    """How much nearer held-out data are predicted, as a clause; None without numbers."""
    held_out = verdict.get("held_out") or {}
    overall = held_out.get("overall") or {}
    before, after = finite(overall.get("rms_before")), finite(overall.get("rms_after"))
    floor = finite(overall.get("noise_floor"))
    if before is None or after is None:
        return None
    if after > DILUTED * before:
        nearer = _nearest(held_out.get("channels") or {})
        if nearer is not None:
            channel, ratio = nearer
            return f"data of {channel} held back from the fit are predicted {number(ratio)} times nearer"
    if held_out.get("unit", "sigma") == "spread":
        return (
            f"data held back from the fit are predicted to {percent(after, 2)} instead of {percent(before, 2)} of "
            "each channel's own spread"
        )
    size = f"{number(after)} instead of {number(before)} times the sensor noise"
    return f"data held back from the fit are predicted to {size}" + (
        f" (the noise itself: {number(floor)})" if floor is not None else ""
    )


def _many(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    """What is named at many joints or bodies: effect by effect, with where; the numbers are below."""
    spots: dict[str, list[str]] = {}
    for item in verdict["effects"]:
        part = str(item.get("part", ""))
        where = str(item["where"])
        name = part if part and not where.startswith(("joint.", "base")) else where.removeprefix("joint.")
        spots.setdefault(effect_title(str(item["effect"])), []).append(name)
    said = [f"{title} ({joined(list(dict.fromkeys(where)))})" for title, where in spots.items()]
    gained = improvement(verdict)
    sentence = f"The model lacks {joined(said, 'and also')}" + (f"; with this, {gained}." if gained else ".")
    quiet = [str(p["part"]) for p in verdict.get("parts", ()) if p["verdict"] == "nothing_missing"]
    open_ = [str(p["part"]) for p in verdict.get("parts", ()) if p["verdict"] in ("unknown", "ambiguous")]
    more = ((f"Nothing is missing that these data could show of {joined(quiet)}.",) if quiet else ()) + (
        (f"What {joined(open_)} lack{'s' if len(open_) == 1 else ''} is not told apart, or has no name.",)
        if open_
        else ()
    )
    return Story("Named", "found", capital(joined(list(spots))), sentence, (*more, *_moved(verdict)))


def _named(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    effects: Sequence[Mapping[str, Any]] = verdict["effects"]
    if len(effects) > FEW:
        return _many(verdict, evidence)
    sensors = [is_sensor(str(e["effect"])) for e in effects]
    phrases = [
        effect_object(e)
        + (f" in trial {joined([str(t) for t in e['trials']])} alone" if e.get("trials") else "")
        + (f", {parameters_text(e['parameters'])}" if e.get("parameters") else "")
        for e in effects
    ]
    what = joined(phrases, "and also")
    if all(sensors):
        badge = "Named: a sensor"
        sentence = f"Not the physics but the reading of it differs: the model lacks {what}"
    elif any(sensors):
        badge = "Named: physics and a sensor"
        sentence = f"The model lacks physics, and a sensor misreads: {what}"
    else:
        badge = "Named"
        sentence = f"The model lacks {what}"
    gained = improvement(verdict)
    sentence += f"; with {'it' if len(effects) == 1 else 'them'}, {gained}." if gained else "."
    return Story(badge, "found", capital(effects_phrase(effects)), sentence, _moved(verdict))


def _ambiguous(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    sets = [_alternative(a) for a in verdict["alternatives"]]
    listed = joined(sets[:4], "or")
    rest = f" ({len(sets) - 4} more below)" if len(sets) > 4 else ""
    what = "is missing" if all(a["effects"] for a in verdict["alternatives"]) else "is missing, or was believed wrongly"
    sentence = f"Something {what}, and these data cannot tell which: {listed}{rest}."
    more = [f"The favourite, by a margin that proves nothing, is {sets[0]}."] if sets else []
    step = verdict.get("next_experiment")
    if step:
        more.append(f"The trial that would tell them apart best: {change_text(step.get('change') or {})}.")
    return Story("Ambiguous", "open", "Several explanations, one set of data", sentence, (*more, *_moved(verdict)))


def _unknown(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    overall = (verdict.get("held_out") or {}).get("overall") or {}
    off = finite(overall.get("rms_before"))
    counted = "times the sensor noise"
    if (verdict.get("held_out") or {}).get("unit", "sigma") == "spread":
        counted = "of each channel's own spread"
    size = f": the baseline, refitted, is off by {number(off)} {counted} on held-out data" if off is not None else ""
    places = [f"{p['balance']} during {p['phase']}" for p in verdict["located"][:1]]
    where = f" It shows first in {places[0]}." if places else ""
    sentence = f"Something real is missing that no effect of the catalogue explains{size}; nothing is named."
    more = (
        f"The residual's surface is shown below as measured; no physical parameter is quoted from it.{where}",
        *(f"{capital(line)}." for line in verdict.get("why", ()) if "no law was learned" in line),
        *_moved(verdict),
    )
    return Story("Unknown", "open", "Physics outside the catalogue", sentence, more)


_LAWS = {
    "force": "a force that depends on its {on}",
    "friction": "dry friction whose level depends on its {on}",
    "memory": "a force that remembers how it came there",
}


def _alike(words: str) -> str:
    """A law's likeness as a sentence."""
    if words.startswith("rises"):
        return f"Its curve {words}."
    return f"It grows{words.removeprefix('growing')}." if words.startswith("growing") else f"It is {words}."


def _learned(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    law = verdict["learned"][0]
    said = _LAWS.get(law["kind"], "a law").format(on=joined(law["depends_on"]))
    gained = improvement(verdict)
    like = law.get("like")
    where = f"at the {law['where']}" if law["where"] in ("wrist", "contact", "target") else place(law["where"])
    sentence = f"What is missing is {said}, {where}: learned from the recordings, which nothing in the "
    sentence += f"catalogue explains. With it, {gained}." if gained else "catalogue explains."
    more = (_alike(like["words"]),) if like else ("No short formula says as much as the curve below.",)
    draft = ("my_law.py, beside this page, is a draft of it as an effect of your own.",) if law["formula"] else ()
    return Story(
        "Learned", "found", "A law that the catalogue does not hold", sentence, (*more, *draft, *_moved(verdict))
    )


def _nothing_missing(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    overall = (verdict.get("held_out") or {}).get("overall") or {}
    after = finite(overall.get("rms_after"))
    if after is None:
        after = finite(overall.get("rms_before"))
    sentence = "Nothing is missing that these data could show"
    if after is not None and (verdict.get("held_out") or {}).get("unit", "sigma") == "sigma":
        sentence += f": data held back from the fit are predicted to {number(after)} times the sensor noise"
    limits = [
        f"{effect_phrase(d)} of {quantity(d.get('smallest'), d.get('unit'))}"
        for d in verdict["detectable"]
        if not beyond(d)
    ][:3]
    unseen = (
        f"That is no proof of absence: anything smaller than, say, {joined(limits, 'or')} would have stayed unseen."
    )
    more = (unseen,) if limits else ()
    return Story("Nothing missing", "found", "The model explains the recordings", f"{sentence}.", more)


def _wrong_parameter(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    parts = []
    for name, item in verdict["parameters"].items():
        fitted = quantity(item.get("value"), item.get("unit"), item.get("ci95"))
        believed = quantity(item.get("believed"), item.get("unit"))
        parts.append(f"{parameter_label(name)} is {fitted}, not {believed}{_sigmas(item)}")
    gained = improvement(verdict)
    sentence = f"The physics is right, a believed value is not: {joined(parts)}"
    sentence += f"; with that, {gained}." if gained else "."
    names = joined([parameter_label(name) for name in verdict["parameters"]])
    more = tuple(f"{capital(line)}." for line in verdict.get("why", ()) if "acts exactly as" in line)
    return Story("Wrong parameter", "found", f"{capital(names)}: not what was believed", sentence, more)


def _not_trusted(verdict: Mapping[str, Any], evidence: Evidence) -> Story:
    failed = [c for c in evidence.checks if not c.get("passed")]
    which = joined([f"{c.get('name')} ({c['detail']})" if c.get("detail") else str(c.get("name")) for c in failed[:3]])
    sentence = "No answer: the fit failed its own checks" + (f": {which}." if which else ".")
    more = ("What was tried is listed below so that the cause can be found; none of its numbers should be quoted.",)
    return Story("Not trusted", "warning", "The fit failed its own checks", sentence, more)


def _alternative(item: Mapping[str, Any]) -> str:
    effects = item.get("effects") or ()
    parameters = [name for name in item.get("parameters") or {} if "@" not in name]  # an effect's own go without saying
    parts = [effects_phrase(effects)] if effects else []
    if parameters:
        names = joined([parameter_label(name) for name in parameters])
        parts.append(f"another {names} than believed" if not effects else f"with another {names}")
    return " ".join(parts) or "nothing more"


def _moved(verdict: Mapping[str, Any]) -> tuple[str, ...]:
    """What is said of believed values that moved beside the verdict proper."""
    moved = [
        f"{parameter_label(name)} to {quantity(item.get('value'), item.get('unit'), item.get('ci95'))} "
        f"(believed {quantity(item.get('believed'), item.get('unit'))}{_sigmas(item)})"
        for name, item in verdict["parameters"].items()
    ]
    return (f"Believed values moved too: {joined(moved)}.",) if moved else ()


def _sigmas(item: Mapping[str, Any]) -> str:
    value, believed, sigma = (finite(item.get(k)) for k in ("value", "believed", "sigma"))
    if value is None or believed is None or not sigma or not math.isfinite(sigma):
        return ""
    return f", {number(abs(value - believed) / sigma, 2)} of its stated sigmas away"


def change_text(change: Mapping[str, Any]) -> str:
    """A changed trial in words: "target mass 63.2 and speed 0.2 m/s"."""
    parts = []
    for name, value in change.items():
        if isinstance(value, Mapping):
            text = quantity(value.get("value"), value.get("unit"))
        elif isinstance(value, list):
            text = ", ".join(number(v) if finite(v) is not None else str(v) for v in value)
        else:
            numeric = isinstance(value, int | float) and not isinstance(value, bool)
            text = quantity(value, unit_of_name(str(name))) if numeric else str(value)
        parts.append(f"{parameter_label(str(name))} {text}")
    return joined(parts) or "a different trial"


def few_trials(count: int) -> str | None:
    """What so few trials can and cannot show; None where there are more than three, or none is listed."""
    if count == 1:
        return (
            "One trial: the fit and its residual can be seen, and an effect that works in it. Nothing can be predicted "
            "that was not fitted, nor told apart what changes with speed or mass from what does not."
        )
    if count == 2:
        return (
            "Two trials: each can be predicted from the other. What differs between them is told only where their "
            "speeds or masses differ, and a third that disagrees would not be noticed as the odd one."
        )
    if count == 3:
        return (
            "Three trials: each can be predicted from the other two, and one that disagrees stands out. Two effects "
            "that differ only in how they grow with speed or mass need as many different speeds or masses."
        )
    return None


def confidence_text(verdict: Mapping[str, Any]) -> str:
    """The verdict's confidence for people."""
    return percent(verdict.get("confidence"))


_TELLERS = {
    "named": _named,
    "ambiguous": _ambiguous,
    "learned": _learned,
    "unknown": _unknown,
    "nothing_missing": _nothing_missing,
    "wrong_parameter": _wrong_parameter,
    "not_trusted": _not_trusted,
}
