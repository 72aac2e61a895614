"""Events: what switched, and when."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Event:
    """One switch.

    Attributes:
        time: s.
        element: "contact", or the name of a force, friction or law with a memory.
        kind: "touch", "release", "apart", "stick", "slip", "edge" or "turn" (of the way of a port).
    """

    time: float
    element: str
    kind: str


def contact_intervals(
    events: tuple[Event, ...], start_pressed: bool, start: float, end: float
) -> list[tuple[float, float]]:
    """Times during which the contact carried force, as (touch, release) pairs [s]."""
    intervals = []
    since = start if start_pressed else None
    for event in events:
        if event.element != "contact":
            continue
        if event.kind == "touch" and since is None:
            since = event.time
        elif event.kind in ("release", "apart") and since is not None:
            intervals.append((since, event.time))
            since = None
    if since is not None:
        intervals.append((since, end))
    return intervals
