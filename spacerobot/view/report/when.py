"""What happened when, in sentences: touches that were found in the recordings, and clocks that differ."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


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
    for clock in verdict.get("clocks") or ():
        late = clock["parameters"]["delay_s"]
        way = "behind" if late["value"] < 0.0 else "ahead of"
        low, high = sorted(abs(x) for x in late["ci95"])
        out.append(
            f"The clock of {clock['where']} is {abs(late['value']):.4f} s (95 %: {low:.4f} to {high:.4f}) "
            f"{way} that of {clock['against']} in trial {clock['trial']}: {clock['why']}."
        )
    return tuple(out)


def _seconds(value: Mapping[str, Any]) -> str:
    low, high = value["ci95"]
    return f"{value['value']:.3f} s ({low:.3f} to {high:.3f})"
