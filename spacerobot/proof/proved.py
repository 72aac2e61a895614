"""Which effects of the catalogue the proof hides, and where; an entry is optional, and those without one are listed."""

from __future__ import annotations

from spacerobot.effects.registry import all_effects
from spacerobot.proof.driven.hidden import KNOWN
from spacerobot.proof.sizes import DRAWS


def proved() -> dict[str, tuple[str, ...]]:
    """Effect -> the places where campaigns hide it, for those of the catalogue that any does."""
    known = all_effects()
    found: dict[str, tuple[str, ...]] = {}
    for name, where in [*DRAWS, *((name, "joint.NAME") for name in KNOWN)]:
        if name in known:
            found[name] = (*found.get(name, ()), where)
    return found


def not_yet_proved() -> tuple[str, ...]:
    """Effects of the catalogue that no campaign hides: nothing is known of how well they are found."""
    return tuple(sorted(set(all_effects()) - set(proved())))


def as_text() -> str:
    """Both lists."""
    some = proved()
    lines = [f"  {name:22} {', '.join(some[name])}" for name in sorted(some)]
    rest = [f"  {name}" for name in not_yet_proved()] or ["  none"]
    return "\n".join(["proved, and where:", *lines, "not yet proved:", *rest])
