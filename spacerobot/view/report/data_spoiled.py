"""What of the recordings was left out, and noise that is not what was stated, in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def spoiled(verdict: Mapping[str, Any]) -> tuple[str, ...]:
    """A sentence for what was left out of each channel, and for each noise; none where all is as stated."""
    out = []
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for one in verdict.get("spoiled") or ():
        groups.setdefault((one["channel"], one["why"]), []).append(one)
    for (channel, why), members in groups.items():
        count = sum(m["readings"] for m in members)
        trials = ", ".join(m["trial"] for m in members)
        word = "reading" if count == 1 else "readings"
        out.append(f"Left out of {channel}: {count} {word} {why} (trial {trials}).")
    for channel, noise in (verdict.get("noise") or {}).items():
        out.append(
            f"The noise of {channel} is taken as {noise['sigma']:.2g} {noise['unit']}, as its readings show; stated is "
            f"{noise['stated']:.2g}."
        )
    return tuple(out)
