"""A law with a memory: a force that depends on what went before, through one number that changes as the port moves."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from spacerobot.effects.kernel import c_function
from spacerobot.effects.sizes import Sizes

MemoryLaw = Callable[[float, float, float, float, float, float, Any], float]
"""(z, rate, d, v, way, normal, p) -> value.

The state z and its rate z' (0 where the rate itself is asked for); displacement [m or rad] and rate of the port; +1 or
-1, the way in which the port moves; the normal load [N], 1 where nothing presses; all the parameters, as many as there
are. Where the port is almost at rest `way` may differ from the sign of v for a moment: a law that turns with the way of
motion is smooth in all else where it reads `way`, and |v| as `way * v`.
"""

ARGUMENTS = 6
"""Numbers that a law reads before its parameters."""


def no_memory_energy(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """Stored energy of a law that stores none."""
    return 0.0


@dataclass(frozen=True)
class Memory:
    """A law with a memory in plain Python that Numba can compile: z' = g(z, d, v, N), f(z, z', d, v, N).

    The callables share the signature of `MemoryLaw`, and are written with `math` and plain arithmetic only. Both are
    continuous where v changes its sign.

    Attributes:
        rate: z' [unit of z a second].
        force: force along the positive direction of the port [N or N m].
        energy: stored energy [J].
        linear: both are linear in (z, d, v), whatever the way; such laws are integrated faster.
    """

    rate: MemoryLaw
    force: MemoryLaw
    energy: MemoryLaw = no_memory_energy
    linear: bool = False


@functools.cache
def compiled(law: MemoryLaw) -> Any:
    """`law` compiled once as a C function of six numbers and a pointer to p."""
    return c_function(law, ARGUMENTS)


GIVES = 1e-3
"""Least share of the motion over which friction builds up, to be told from dry friction.

What gives less is how a stop is drawn, in an engine or in a law, and no length that anybody could measure in the rig.
"""


def gives_too_little(length: float, sizes: Sizes) -> str:
    """Why what builds up over so short a length is no law with a memory, one clause; empty where it is one."""
    share = length / sizes.length
    return "" if share > GIVES else f"building up within {share:.1g} of the travel it is dry friction"


AT_REST = 1e-12
"""Share of the state's size to which its rest is found."""


def at_rest(memory: Memory, d: float, size: float, p: tuple[float, ...]) -> float:
    """The state that does not change while the port stands at d: 0 if that does not, otherwise found from there.

    Newton's steps with a slope by differences; where none is found (a state that drifts on), 0.
    """
    z = 0.0
    for _ in range(50):
        rate = memory.rate(z, 0.0, d, 0.0, 1.0, 1.0, p)
        if rate == 0.0:
            return z
        probe = 1e-6 * size
        slope = (memory.rate(z + probe, 0.0, d, 0.0, 1.0, 1.0, p) - rate) / probe
        if slope == 0.0:
            return 0.0
        step = rate / slope
        z -= step
        if abs(step) <= AT_REST * size:
            return z
    return 0.0
