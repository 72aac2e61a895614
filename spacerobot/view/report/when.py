"""What happened when, in sentences: touches that were found in the recordings, and clocks that differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

MANY = 3
"""Trials from which on a clock has one sentence for all: the verdict has each."""


def happened(verdict: Mapping[str, Any]) -> tuple[str, ...]:
    """A sentence for each touch and each clock; none where nothing was found."""
    out = []
    events = verdict.get("events") or ()
    met = [e for e in events if e["seen_in"] == "track"]
    if met:
        first, trials = met[0], len({e["trial"] for e in met})
        moments = ", ".join(f"{e['time_s']['value']:.3f}" for e in met if e["trial"] == first["trial"])
        out.append(
            f"The body met something that the baseline does not know in {trials} trials "
            f"(in {first['trial']} at {moments} s): there its track bends at once. It is taken as free in between."
        )
    for event in (e for e in events if e not in met):
        out.append(
            f"Something touched the arm in trial {event['trial']} at {_seconds(event['time_s'])} on the clock of "
            f"{event['clock']}: there the {event['seen_in']} is first shaken."
        )
    alike: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    for clock in verdict.get("clocks") or ():
        alike.setdefault((clock["where"], clock["against"], clock["why"]), []).append(clock)
    for own in alike.values():
        out += [_of_many(own)] if len(own) >= MANY else [_of_one(clock) for clock in own]
    return tuple(out)


def _of_one(clock: Mapping[str, Any]) -> str:
    late = clock["parameters"]["delay_s"]
    low, high = sorted(abs(x) for x in late["ci95"])
    return (
        f"The clock of {clock['where']} is {abs(late['value']):.4f} s (95 %: {low:.4f} to {high:.4f}) "
        f"{_way(late['value'])} that of {clock['against']} in trial {clock['trial']}: {clock['why']}."
    )


def _of_many(own: Sequence[Mapping[str, Any]]) -> str:
    """One sentence for a clock that was set trial by trial: the least and the most, and how well each is known."""
    late = {clock["trial"]: clock["parameters"]["delay_s"] for clock in own}
    least, most = (pick(late, key=lambda trial: late[trial]["value"]) for pick in (min, max))
    known = max(0.5 * (v["ci95"][1] - v["ci95"][0]) for v in late.values())
    ends = [f"{abs(late[t]['value']):.4f} s {_way(late[t]['value'])} it in trial {t}" for t in (least, most)]
    return (
        f"The clock of {own[0]['where']} was set beside that of {own[0]['against']} in each of {len(own)} trials: from "
        f"{ends[0]} to {ends[1]}, each within {known:.4f} s (95 %): {own[0]['why']}."
    )


def _way(late: float) -> str:
    return "behind" if late < 0.0 else "ahead of"


def _seconds(value: Mapping[str, Any]) -> str:
    low, high = value["ci95"]
    return f"{value['value']:.3f} s ({low:.3f} to {high:.3f})"
