"""What holds in each mode of a collision, and what ends it. Compiled.

A mode is (contact, friction): contact APART, PRESSED or RELEASED (overlapping still, its force ended); friction
sliding one way or the other, or stuck.
"""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.exact.propagator import mode_matrix
from spacerobot.support.jit import lean

APART, PRESSED, RELEASED = 0, 1, 2
DEPTH, PUSH, RUB, DEFLECTION, FUNCTIONALS = 0, 1, 2, 3, 4
"""Functionals of the state: penetration, force wanted by the contact, rate (sliding) or force (stuck) of the friction,
deflection of the wrist."""

SLOTS = 6
GUARDS = 4


@lean
def slot_of(contact: int, slide: int) -> int:
    """Which linear system acts."""
    return 3 * (1 if contact == PRESSED else 0) + slide + 1


@lean
def fill_functionals(header: Any, rows: Any, x: Any, slide: int, free: Any, a: Any, g: Any, rate: Any) -> None:
    """Rows g of the functionals and `rate` of their time derivatives, shape (FUNCTIONALS, m) each.

    Args:
        header, rows, x: structure and numbers.
        slide: sign of the sliding, 0 for stuck or no friction.
        free: system's matrix without friction.
        a: system's matrix.
        g, rate: filled.
    """
    n, forces = header[0], header[1]
    k, m = n + forces, 2 * n + 1
    g[:, :] = 0.0
    for i in range(n):
        g[DEPTH, i] = rows[forces, i]
        g[PUSH, i] = x[k] * rows[forces, i]
        g[PUSH, n + i] = x[k + 1] * rows[forces, i]
        g[DEFLECTION, i] = rows[forces + 4, i]
    if header[2]:
        if slide != 0:
            for i in range(n):
                g[RUB, n + i] = slide * rows[forces + 1, i]
        else:
            give = 0.0
            for i in range(n):
                give += rows[forces + 1, i] * rows[forces + 1, i] / x[i]
            for j in range(m):
                along = 0.0
                for i in range(n):
                    along += rows[forces + 1, i] * free[n + i, j]
                g[RUB, j] = -along / give
    for f in range(FUNCTIONALS):
        for j in range(m):
            total = 0.0
            for i in range(m - 1):
                total += g[f, i] * a[i, j]
            rate[f, j] = total


@lean
def open_mode(
    header: Any, rows: Any, x: Any, contact: int, slide: int, a: Any, g: Any, rate: Any, free: Any, c: Any, s: Any
) -> float:
    """Fills the system's matrix and functionals of a mode; returns the length of a step [s]."""
    touching = contact == PRESSED
    stuck = header[2] == 1 and slide == 0
    mode_matrix(header, rows, x, touching, 0, False, free, c, s)
    h = mode_matrix(header, rows, x, touching, slide, stuck, a, c, s)
    fill_functionals(header, rows, x, slide, free, a, g, rate)
    return h


@lean
def fill_guards(header: Any, x: Any, contact: int, slide: int, which: Any, sign: Any, offset: Any) -> int:
    """What must stay positive in a mode: sign * functional + offset; returns how many."""
    k = header[0] + header[1]
    count = 1
    which[0], sign[0], offset[0] = DEPTH, 1.0, 0.0
    if contact == APART:
        sign[0] = -1.0
    elif contact == PRESSED:
        if not header[3]:
            which[0], offset[0] = PUSH, x[k + 2]
    else:
        which[1], sign[1], offset[1] = PUSH, -1.0, 0.0
        count = 2
    if header[2]:
        if slide != 0:
            which[count], sign[count], offset[count] = RUB, 1.0, 0.0
            count += 1
        else:
            for way in (-1.0, 1.0):
                which[count], sign[count], offset[count] = RUB, way, x[k + 3] * (1.0 + 1e-12) + 1e-300
                count += 1
    return count


@lean
def dot(g: Any, z: Any) -> float:
    """Value of a functional."""
    total = 0.0
    for i in range(z.size):
        total += g[i] * z[i]
    return total
