"""A box that tumbles on a plane: impulses at its corners, restitution and Coulomb friction, in fixed steps.

Moreau's time stepping: at each step the impulses of all corners near the plane are found together by projected
Gauss-Seidel sweeps, the normal ones pushing, the tangential ones inside their friction cone (Moreau 1988;
Anitescu and Potra 1997, Nonlinear Dynamics 14, Eqs. 7 to 12).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.support.jit import jit, part

SWEEPS = 20
NEAR = 5e-4
"""Gap [m] below which a corner may touch."""

SETTLED = 1e-5
"""Change of an impulse over the mass [m/s] in a sweep that ends the sweeps."""

SLOW = 0.05
"""Closing speed [m/s] below which nothing bounces."""


@part
def _rotation(q: Any, out: Any) -> None:
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0, 0], out[0, 1], out[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    out[1, 0], out[1, 1], out[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    out[2, 0], out[2, 1], out[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@part
def _turn(q: Any, w: Any, h: float) -> None:
    """The orientation after turning with w (world axes) for h seconds."""
    size = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if size < 1e-12:
        return
    s, c = np.sin(0.5 * size * h) / size, np.cos(0.5 * size * h)
    x, y, z = s * w[0], s * w[1], s * w[2]
    a, b, d, e = q[0], q[1], q[2], q[3]
    q[0] = c * a - x * b - y * d - z * e
    q[1] = c * b + x * a + y * e - z * d
    q[2] = c * d + y * a + z * b - x * e
    q[3] = c * e + z * a + x * d - y * b


@jit
def tumble(
    start: Any, steps: int, h: float, each: int, half: Any, mass: float, inertia: Any, pull: Any, height: float,
    restitution: float, mu: float, out: Any,
) -> None:  # fmt: skip
    """Steps a box on and writes its state every `each` steps.

    Args:
        start: orientation (w, x, y, z), position, angular velocity (world), velocity, shape (13,).
        steps, h, each: number and length [s] of steps, and how many to a row of `out`.
        half: half its edges [m], (3,).
        mass, inertia: kg, and kg m^2 about its own axes, (3,).
        pull: acceleration of gravity [m/s^2], (3,).
        height: of the plane [m].
        restitution, mu: of the contact.
        out: (steps / each, 13), as `start`.
    """
    q, p, w, v = start[:4].copy(), start[4:7].copy(), start[7:10].copy(), start[10:13].copy()
    turn, inverse = np.empty((3, 3)), np.empty((3, 3))
    arm, gain = np.empty((8, 3)), np.empty((8, 3))
    wanted, impulse = np.empty(8), np.empty((8, 3))
    touching = np.empty(8, dtype=np.bool_)
    spin, torque = np.empty(3), np.empty(3)
    for step in range(steps):
        _rotation(q, turn)
        for i in range(3):
            spin[i] = turn[0, i] * w[0] + turn[1, i] * w[1] + turn[2, i] * w[2]
        for i in range(3):  # Euler's equations, in its own axes
            j, k = (i + 1) % 3, (i + 2) % 3
            torque[i] = (inertia[j] - inertia[k]) * spin[j] * spin[k] / inertia[i]
        for i in range(3):
            w[i] += h * (turn[i, 0] * torque[0] + turn[i, 1] * torque[1] + turn[i, 2] * torque[2])
            v[i] += h * pull[i]
        for i in range(3):
            for j in range(3):
                inverse[i, j] = 0.0
                for k in range(3):
                    inverse[i, j] += turn[i, k] * turn[j, k] / inertia[k]
        any_touching = False
        for c in range(8):
            for i in range(3):
                arm[c, i] = 0.0
                for j in range(3):
                    sign = 1.0 if (c >> j) & 1 else -1.0
                    arm[c, i] += turn[i, j] * sign * half[j]
            gap = p[2] + arm[c, 2] - height
            touching[c] = gap < NEAR
            impulse[c] = 0.0
            if touching[c]:
                any_touching = True
                closing = v[2] + w[0] * arm[c, 1] - w[1] * arm[c, 0]
                wanted[c] = -restitution * closing if closing < -SLOW else 0.0
                for i in range(3):  # the corner's own apparent mass along each axis, inverted
                    j, k = (i + 1) % 3, (i + 2) % 3
                    rj, rk = arm[c, j], arm[c, k]
                    turned = rk * rk * inverse[j, j] + rj * rj * inverse[k, k] - 2.0 * rj * rk * inverse[j, k]
                    gain[c, i] = 1.0 / mass + turned
        if any_touching:
            for _ in range(SWEEPS):
                most_change = 0.0
                for c in range(8):
                    if not touching[c]:
                        continue
                    rx, ry, rz = arm[c, 0], arm[c, 1], arm[c, 2]
                    ox, oy, oz = impulse[c, 0], impulse[c, 1], impulse[c, 2]
                    ux = v[0] + w[1] * rz - w[2] * ry
                    uy = v[1] + w[2] * rx - w[0] * rz
                    uz = v[2] + w[0] * ry - w[1] * rx
                    nz = max(0.0, oz + (wanted[c] - uz) / gain[c, 2])
                    nx, ny = ox - ux / gain[c, 0], oy - uy / gain[c, 1]
                    size, most = np.sqrt(nx * nx + ny * ny), mu * nz
                    if size > most:
                        nx, ny = nx * most / size, ny * most / size
                    impulse[c, 0], impulse[c, 1], impulse[c, 2] = nx, ny, nz
                    dx, dy, dz = nx - ox, ny - oy, nz - oz
                    most_change = max(most_change, abs(dx), abs(dy), abs(dz))
                    tx, ty, tz = ry * dz - rz * dy, rz * dx - rx * dz, rx * dy - ry * dx
                    v[0] += dx / mass
                    v[1] += dy / mass
                    v[2] += dz / mass
                    for i in range(3):
                        w[i] += inverse[i, 0] * tx + inverse[i, 1] * ty + inverse[i, 2] * tz
                if most_change < SETTLED * mass:
                    break
        for i in range(3):
            p[i] += h * v[i]
        _turn(q, w, h)
        if (step + 1) % each == 0:
            row = out[(step + 1) // each - 1]
            row[:4], row[4:7], row[7:10], row[10:13] = q, p, w, v


@jit
def tumble_all(
    starts: Any, rows: Any, step: float, each: int, half: Any, mass: float, inertia: Any, pull: Any, height: float,
    restitution: float, mu: float, out: Any,
) -> None:  # fmt: skip
    """Many windows, `starts` (W, 13), of `rows[i]` readings `step` seconds apart; `out` (W, most rows, 13)."""
    for i in range(starts.shape[0]):
        tumble(
            starts[i], rows[i] * each, step / each, each, half, mass, inertia, pull, height, restitution, mu, out[i]
        )  # fmt: skip
