"""The linear system of one mode, its exponential over one step, and its Taylor series inside a step. Compiled.

State z = (q, v, 1), so that constant forces are a column. A step is short against the fastest motion of the mode
(THETA), so that the series of degree DEGREE is exact to rounding, without scaling and squaring.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.support.jit import lean

THETA = 1.0
"""Step times the bound of the mode's fastest rate."""

DEGREE = 20
"""1/21! is 2e-20."""


@lean
def mode_matrix(
    header: Any, rows: Any, x: Any, touching: bool, slide: int, stuck: bool, a: Any, damping: Any, stiff: Any
) -> float:
    """Fills a, shape (2n + 1, 2n + 1), with the system's matrix; returns the length of a step [s].

    Args:
        header, rows: of the structure.
        x: its numbers.
        touching: whether the contact acts.
        slide: sign of the sliding of the friction, 0 if it sticks.
        stuck: whether it sticks.
        a, damping, stiff: filled; the last two, shape (n, n), are scratch.
    """
    n, forces, friction = header[0], header[1], header[2]
    k = n + forces
    accel = k + 4
    a[:, :] = 0.0
    damping[:, :] = 0.0
    stiff[:, :] = 0.0
    for f in range(forces):
        into = stiff if header[4 + f] == 0 else damping
        for i in range(n):
            for j in range(n):
                into[i, j] += x[n + f] * rows[f, i] * rows[f, j]
    if touching:
        for i in range(n):
            for j in range(n):
                stiff[i, j] += x[k] * rows[forces, i] * rows[forces, j]
                damping[i, j] += x[k + 1] * rows[forces, i] * rows[forces, j]
    square, rate = 0.0, 0.0
    for i in range(n):
        for j in range(n):
            scale = x[i] * x[j]
            square += stiff[i, j] * stiff[i, j] / scale
            rate += damping[i, j] * damping[i, j] / scale
    for i in range(n):
        a[i, n + i] = 1.0
        for j in range(n):
            a[n + i, j] = -stiff[i, j] / x[i]
            a[n + i, n + j] = -damping[i, j] / x[i]
        a[n + i, 2 * n] = x[accel + i]
        if friction and not stuck:
            a[n + i, 2 * n] -= slide * x[k + 3] * rows[forces + 1, i] / x[i]
    if stuck:
        give = 0.0
        for i in range(n):
            give += rows[forces + 1, i] * rows[forces + 1, i] / x[i]
        for j in range(2 * n + 1):
            along = 0.0
            for i in range(n):
                along += rows[forces + 1, i] * a[n + i, j]
            for i in range(n):
                a[n + i, j] -= rows[forces + 1, i] / x[i] * along / give
    bound = np.sqrt(np.sqrt(square)) + np.sqrt(rate)
    return THETA / bound if bound > 0.0 else np.inf


@lean
def exponential(a: Any, h: float, e: Any, term: Any, temp: Any) -> None:
    """e = exp(a h) by its series; all shape (m, m), the last two scratch."""
    m = a.shape[0]
    e[:, :] = 0.0
    term[:, :] = 0.0
    for i in range(m):
        e[i, i] = 1.0
        term[i, i] = 1.0
    for degree in range(1, DEGREE + 1):
        factor = h / degree
        for i in range(m - 1):  # the last row of a is zero
            for j in range(m):
                total = 0.0
                for l in range(m - 1):
                    total += a[i, l] * term[l, j]
                if degree == 1 and j == m - 1:
                    total += a[i, m - 1]
                temp[i, j] = total * factor
        for i in range(m - 1):
            for j in range(m):
                term[i, j] = temp[i, j]
                e[i, j] += temp[i, j]
        if degree == 1:
            term[m - 1, m - 1] = 0.0


@lean
def step(e: Any, z: Any, out: Any) -> None:
    """out = e z, shape (m,)."""
    m = z.size
    for i in range(m - 1):
        total = e[i, m - 1]
        for j in range(m - 1):
            total += e[i, j] * z[j]
        out[i] = total
    out[m - 1] = 1.0


@lean
def series(a: Any, h: float, z: Any, c: Any) -> None:
    """Coefficients in theta of z(t + theta h), c shape (DEGREE + 1, m)."""
    m = z.size
    for i in range(m):
        c[0, i] = z[i]
    for degree in range(1, DEGREE + 1):
        factor = h / degree
        for i in range(m - 1):
            total = a[i, m - 1] if degree == 1 else 0.0
            for j in range(m - 1):
                total += a[i, j] * c[degree - 1, j]
            c[degree, i] = total * factor
        c[degree, m - 1] = 0.0


@lean
def at(c: Any, theta: float, out: Any) -> None:
    """State at theta from the coefficients, shape (m,)."""
    for i in range(out.size):
        total = c[DEGREE, i]
        for k in range(DEGREE):
            total = total * theta + c[DEGREE - 1 - k, i]
        out[i] = total


@lean
def projected(c: Any, g: Any, p: Any) -> None:
    """Polynomial p, shape (DEGREE + 1,), of the functional g, shape (m,)."""
    for k in range(DEGREE + 1):
        total = 0.0
        for i in range(g.size):
            total += g[i] * c[k, i]
        p[k] = total
