"""Compiled mobility of many poses: composite rigid bodies about the frame, then one Cholesky factor each.

All spatial quantities are written about the frame's origin in world axes, so composite inertias add without
being moved and the base's Jacobian is the identity (the algorithm: Featherstone, Rigid Body Dynamics
Algorithms, 2008, section 6.2; the choice of coordinates is ours).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.support.jit import jit, part


@jit
def mobility_kernel(tree: Any, poses: np.ndarray, slider: float, rows: int, out: np.ndarray) -> int:
    """Fill `out`, shape (N, rows, rows), with G = J H^-1 J^T (linear first) at every pose.

    Args:
        tree: a `KinematicTree`.
        poses: shape (N, len(chain)).
        slider: position of the wrist slider.
        rows: 3 for the linear block, 6 for all.
        out: written.

    Returns:
        -1, or the index of the first pose whose inertia is not positive definite.
    """
    m = tree.parent.shape[0]
    n = 6 if tree.floating else 0
    for j in range(m):
        if tree.column[j] >= 0:
            n += 1
    turn = np.empty((m, 3, 3))
    place = np.empty((m, 3))
    motion = np.zeros((m, 6))
    mass = np.empty(m + 1)
    first = np.empty((m + 1, 3))
    second = np.empty((m + 1, 3, 3))
    scratch = np.empty((3, 3))
    h = np.zeros((n, n))
    g = np.zeros((n, rows))
    for k in range(poses.shape[0]):
        _place(tree, poses[k], slider, turn, place, scratch)
        _gather(tree, turn, place, motion, mass, first, second, scratch)
        _compose(tree, motion, mass, first, second, h, g)
        if not _factor(h, g):
            return k
        for a in range(rows):
            for b in range(a + 1):
                value = 0.0
                for i in range(n):
                    value += g[i, a] * g[i, b]
                out[k, a, b] = value
                out[k, b, a] = value
    return -1


@jit
def mass_kernel(mobility: np.ndarray, directions: np.ndarray, singular: float, out: np.ndarray) -> int:
    """Fill `out`, shape (N, K), with 1/(n^T G n), or -1 where that is too near zero to tell without eigenvalues.

    Args:
        mobility: shape (N, 3, 3).
        directions: shape (K, 3).
        singular: part of the trace, which bounds the largest eigenvalue, below which a mobility is suspect.
        out: written.

    Returns:
        number of suspects.
    """
    suspects = 0
    for k in range(mobility.shape[0]):
        g = mobility[k]
        bound = singular * (g[0, 0] + g[1, 1] + g[2, 2])
        for d in range(directions.shape[0]):
            x, y, z = directions[d, 0], directions[d, 1], directions[d, 2]
            value = x * x * g[0, 0] + y * y * g[1, 1] + z * z * g[2, 2]
            value += 2.0 * (x * y * g[0, 1] + x * z * g[0, 2] + y * z * g[1, 2])
            if value > bound:
                out[k, d] = 1.0 / value
            else:
                out[k, d] = -1.0
                suspects += 1
    return suspects


@part
def _rotate(matrices, j, x, y, z):  # type: ignore[no-untyped-def]
    r = matrices[j]
    return (
        r[0, 0] * x + r[0, 1] * y + r[0, 2] * z,
        r[1, 0] * x + r[1, 1] * y + r[1, 2] * z,
        r[2, 0] * x + r[2, 1] * y + r[2, 2] * z,
    )


@part
def _multiply(a, b, out):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@part
def _place(tree, pose, slider, turn, place, scratch):  # type: ignore[no-untyped-def]
    """Forward kinematics: rotation and origin of every joint frame in the world."""
    for j in range(tree.parent.shape[0]):
        value = slider if tree.source[j] < 0 else pose[tree.source[j]]
        p = tree.translation[j]
        px, py, pz = p[0], p[1], p[2]
        fixed = tree.rotation[j]
        if tree.turning[j]:
            c, s, f = np.cos(value), np.sin(value), fixed
            fixed = scratch
            for i in range(3):
                fixed[i, 0] = c * f[i, 0] + s * f[i, 1]
                fixed[i, 1] = c * f[i, 1] - s * f[i, 0]
                fixed[i, 2] = f[i, 2]
        else:
            px, py, pz = px + value * fixed[0, 2], py + value * fixed[1, 2], pz + value * fixed[2, 2]
        up = tree.parent[j]
        if up < 0:
            for i in range(3):
                for k in range(3):
                    turn[j, i, k] = fixed[i, k]
            place[j, 0], place[j, 1], place[j, 2] = px, py, pz
        else:
            _multiply(turn[up], fixed, turn[j])
            dx, dy, dz = _rotate(turn, up, px, py, pz)
            place[j, 0], place[j, 1], place[j, 2] = place[up, 0] + dx, place[up, 1] + dy, place[up, 2] + dz


@part
def _shift(mass, cx, cy, cz, first, second):  # type: ignore[no-untyped-def]
    """First moment, and second moment moved from the centre of mass to the frame."""
    first[0], first[1], first[2] = mass * cx, mass * cy, mass * cz
    second[0, 0] += mass * (cy * cy + cz * cz)
    second[1, 1] += mass * (cx * cx + cz * cz)
    second[2, 2] += mass * (cx * cx + cy * cy)
    second[0, 1] -= mass * cx * cy
    second[0, 2] -= mass * cx * cz
    second[1, 2] -= mass * cy * cz
    second[1, 0], second[2, 0], second[2, 1] = second[0, 1], second[0, 2], second[1, 2]


@part
def _gather(tree, turn, place, motion, mass, first, second, scratch):  # type: ignore[no-untyped-def]
    """Each body's inertia about the frame, and how each joint moves the frame; the base comes last."""
    m = tree.parent.shape[0]
    tip, t = tree.tip_joint, tree.tip_offset
    ox, oy, oz = t[0], t[1], t[2]
    if tip >= 0:
        ox, oy, oz = _rotate(turn, tip, ox, oy, oz)
        ox, oy, oz = ox + place[tip, 0], oy + place[tip, 1], oz + place[tip, 2]
    for j in range(m):
        x, y, z = place[j, 0] - ox, place[j, 1] - oy, place[j, 2] - oz
        r, c, s = turn[j], tree.center[j], motion[j]
        ax, ay, az = r[0, 2], r[1, 2], r[2, 2]
        if tree.turning[j]:
            s[0], s[1], s[2] = y * az - z * ay, z * ax - x * az, x * ay - y * ax
            s[3], s[4], s[5] = ax, ay, az
        else:
            s[0], s[1], s[2] = ax, ay, az
        dx, dy, dz = _rotate(turn, j, c[0], c[1], c[2])
        _multiply(r, tree.inertia[j], scratch)
        for i in range(3):
            for k in range(i, 3):
                second[j, i, k] = scratch[i, 0] * r[k, 0] + scratch[i, 1] * r[k, 1] + scratch[i, 2] * r[k, 2]
        mass[j] = tree.mass[j]
        _shift(mass[j], x + dx, y + dy, z + dz, first[j], second[j])
    second[m] = tree.base_inertia
    mass[m] = tree.base_mass
    c = tree.base_center
    _shift(mass[m], c[0] - ox, c[1] - oy, c[2] - oz, first[m], second[m])


@part
def _compose(tree, motion, mass, first, second, h, g):  # type: ignore[no-untyped-def]
    """Composite bodies from tip to base, the lower triangle of H, and J^T."""
    m = tree.parent.shape[0]
    rows = g.shape[1]
    h[:] = 0.0
    g[:] = 0.0
    for j in range(m - 1, -1, -1):
        col = tree.column[j]
        if col >= 0:
            s, hc = motion[j], first[j]
            fx = mass[j] * s[0] + s[4] * hc[2] - s[5] * hc[1]
            fy = mass[j] * s[1] + s[5] * hc[0] - s[3] * hc[2]
            fz = mass[j] * s[2] + s[3] * hc[1] - s[4] * hc[0]
            lx, ly, lz = _rotate(second, j, s[3], s[4], s[5])
            lx += hc[1] * s[2] - hc[2] * s[1]
            ly += hc[2] * s[0] - hc[0] * s[2]
            lz += hc[0] * s[1] - hc[1] * s[0]
            i = j
            while i >= 0:
                other = tree.column[i]
                if other >= 0:
                    o = motion[i]
                    value = o[0] * fx + o[1] * fy + o[2] * fz + o[3] * lx + o[4] * ly + o[5] * lz
                    h[max(col, other), min(col, other)] = value
                i = tree.parent[i]
            h[col, col] += tree.armature[j]
            if tree.floating:
                h[col, 0], h[col, 1], h[col, 2], h[col, 3], h[col, 4], h[col, 5] = fx, fy, fz, lx, ly, lz
            if tree.on_path[j]:
                for r in range(rows):
                    g[col, r] = s[r]
        up = tree.parent[j] if tree.parent[j] >= 0 else m
        mass[up] += mass[j]
        for a in range(3):
            first[up, a] += first[j, a]
            for b in range(3):
                second[up, a, b] += second[j, a, b]
    if tree.floating:
        hc = first[m]
        for a in range(3):
            h[a, a] = mass[m]
            for b in range(a + 1):
                h[3 + a, 3 + b] = second[m, a, b]
        h[3, 1], h[3, 2] = -hc[2], hc[1]
        h[4, 0], h[4, 2] = hc[2], -hc[0]
        h[5, 0], h[5, 1] = -hc[1], hc[0]
        for r in range(rows):
            g[r, r] = 1.0


@part
def _factor(h, g):  # type: ignore[no-untyped-def]
    """H = L L^T (1/L_ii on the diagonal) and L^-1 J^T, in place; False if H is not positive definite."""
    n, rows = g.shape
    for i in range(n):
        for j in range(i):
            value = h[i, j]
            for r in range(j):
                value -= h[i, r] * h[j, r]
            h[i, j] = value * h[j, j]
        value = h[i, i]
        for r in range(i):
            value -= h[i, r] * h[i, r]
        if not value > 0.0:
            return False
        inverse = 1.0 / np.sqrt(value)
        h[i, i] = inverse
        for r in range(rows):
            value = g[i, r]
            for j in range(i):
                value -= h[i, j] * g[j, r]
            g[i, r] = value * inverse
    return True
