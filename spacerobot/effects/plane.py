"""Bodies that move in the plane or in space by themselves: what resists them acts against their velocity."""

from __future__ import annotations

from collections.abc import Sequence

from spacerobot.effects.effect import positions
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force

PLACES = ("target", "target.y", "target.z")
"""A body's place along three axes that stand square on each other, right-handed with its spins."""

SPINS = ("target.roll", "target.pitch", "target.yaw")
"""And how it turns about these, one after the other."""

ACROSS = {PLACES[0]: PLACES[1:], "target.yaw": SPINS[:2], "base": ("base.y",)}
"""Coordinate of a body -> the others that its motion may have."""


def turned_by(axis: int) -> tuple[tuple[str, str, float], ...]:
    """Of one of the axes, from 0, cross the velocity: the place that has it, by whose rate, and with which sign."""
    one, other = PLACES[(axis + 1) % 3], PLACES[(axis + 2) % 3]
    return (other, one, 1.0), (one, other, -1.0)


def across(mechanism: Mechanism, where: str) -> tuple[str, ...]:
    """The other directions of a body; none where it moves along one, or something pushes along one."""
    if mechanism.contact is not None:
        return ()
    return tuple(n for n in ACROSS.get(where, ()) if n in mechanism.ports)


def in_space(mechanism: Mechanism) -> bool:
    """Whether a body moves up and down as well as in the plane: nothing carries it."""
    return "target.z" in mechanism.ports


def along_all(name: str, directions: Sequence[str], kernel: Kernel, p: tuple[float, ...]) -> tuple[Force, ...]:
    """One law for the whole velocity, each component at its own coordinate with the speed across beside it."""
    found = []
    for n in directions:
        others = [other for other in directions if other != n]
        found.append(Force(f"{name} at {n}", n, kernel, p, aux=others[0], aside=(*others, None)[1]))
    return tuple(found)


def bodies(mechanism: Mechanism, *names: str) -> tuple[str, ...]:
    """Those of `names` that are ports, one for each body that moves in several directions."""
    others = {other for n in names if n in mechanism.ports for other in across(mechanism, n)}
    return tuple(n for n in positions(mechanism, *names) if n not in others)
