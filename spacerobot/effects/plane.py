"""Bodies that move in the plane by themselves: what resists them acts against their velocity, not along axes."""

from __future__ import annotations

from spacerobot.effects.effect import positions
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force

ACROSS = {"target": "target.y", "base": "base.y"}
"""Coordinate of a body -> the other one of its motion in the plane."""


def across(mechanism: Mechanism, where: str) -> str | None:
    """The other direction of a body in the plane; None where it moves along one, or something pushes along one."""
    other = ACROSS.get(where)
    return other if other in mechanism.ports and mechanism.contact is None else None


def along_both(name: str, where: str, other: str, kernel: Kernel, p: tuple[float, ...]) -> tuple[Force, Force]:
    """One law in the plane, each component at its own coordinate with the other's rate beside it."""
    return (
        Force(f"{name} at {where}", where, kernel, p, aux=other),
        Force(f"{name} at {other}", other, kernel, p, aux=where),
    )


def bodies(mechanism: Mechanism, *names: str) -> tuple[str, ...]:
    """Those of `names` that are ports, one for each body that moves in the plane."""
    others = {across(mechanism, n) for n in names if n in mechanism.ports}
    return tuple(n for n in positions(mechanism, *names) if n not in others)
