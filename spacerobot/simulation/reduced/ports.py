"""Displacements and rates of the ports of the reduced model, and the recorded drives. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.reduced.arrays import (
    BIAS,
    GAIN,
    GEOMETRY,
    INPUT_PORT,
    INPUTS,
    PORT_ORDER,
    PRESS,
    ROWS,
    SLIDE,
    STATES,
    TAU,
    W_ROWS,
    YAW,
    D,
    N,
    V,
    Z,
)
from spacerobot.support.jit import lean


@lean
def kinematics(x: Any, c: Any, y: Any, w: Any, count: int) -> None:
    """Displacements and rates of the first `count` ports of PORT_ORDER at state y = (q, v, z)."""
    n, rows, at, rate, order = c[N], c[ROWS], c[D], c[V], c[PORT_ORDER]
    for k in range(count):
        p = c[order + k]
        d = 0.0
        v = 0.0
        for i in range(n):
            r = x[rows + p * n + i]
            d += r * y[i]
            v += r * y[n + i]
        w[at + p] = d
        w[rate + p] = v
    for s in range(c[STATES]):
        w[c[Z] + s] = y[2 * n + s]
    yaw = c[YAW]
    if yaw >= 0 and c[PRESS] >= 0:
        a, b = x[c[GEOMETRY] + 0], x[c[GEOMETRY] + 1]
        sine, cosine = np.sin(y[yaw]), np.cos(y[yaw])
        across = a * sine + b * cosine
        along = a * cosine - b * sine
        spin = y[n + yaw]
        press, slide = c[PRESS], c[SLIDE]
        w[at + press] += a * (cosine - 1.0) - b * sine
        w[rate + press] -= across * spin
        w[c[W_ROWS] + press * n + yaw] = -across
        w[c[BIAS] + press] = -along * spin * spin
        w[at + slide] += a * sine + b * (cosine - 1.0)
        w[rate + slide] += along * spin
        w[c[W_ROWS] + slide * n + yaw] = along
        w[c[BIAS] + slide] = -across * spin * spin


@lean
def driven(u: Any, j: int, t: float) -> float:
    """Recorded drive j, interpolated linearly; outside the record the nearest sample holds."""
    last = u.shape[1] - 1
    k = int(np.searchsorted(u[0], t, side="right")) - 1
    if k < 0:
        return float(u[1 + j, 0])
    if k >= last:
        return float(u[1 + j, last])
    blend = (t - u[0, k]) / (u[0, k + 1] - u[0, k])
    return float(u[1 + j, k] + blend * (u[1 + j, k + 1] - u[1 + j, k]))


@lean
def ramp(u: Any, k: int, t: float, out: Any) -> Any:
    """Fills out, shape (2, U), with the recorded drives at t and their slopes until they bend next; when that is.

    Args:
        k: a corner of theirs that is not after t.

    Returns:
        the last corner not after t, and the time of the next; infinite beyond the record.
    """
    last = u.shape[1] - 1
    while k < last and u[0, k + 1] <= t:
        k += 1
    before, after = t < u[0, 0], k >= last
    for j in range(out.shape[1]):
        out[0, j], out[1, j] = u[1 + j, k], 0.0
        if not before and not after:
            out[1, j] = (u[1 + j, k + 1] - u[1 + j, k]) / (u[0, k + 1] - u[0, k])
            out[0, j] += (t - u[0, k]) * out[1, j]
    if before:
        return k, u[0, 0]
    return k, np.inf if after else u[0, k + 1]


@lean
def drive(x: Any, c: Any, t: float, u: Any, w: Any) -> None:
    """Adds the recorded drives."""
    n = c[N]
    for j in range(c[INPUTS]):
        force, p = x[c[GAIN] + j] * driven(u, j, t), c[c[INPUT_PORT] + j]
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * force
