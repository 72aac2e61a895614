"""What happened when, in sentences: touches that were found in the recordings, and clocks that differ."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def happened(verdict: Mapping[str, Any]) -> tuple[str, ...]:
    """A sentence for each touch and each clock; none where nothing was found."""
    out = []
    for event in verdict.get("events") or ():
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
