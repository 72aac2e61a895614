"""Placements, Jacobian, joint-space inertia and bias forces of a whole model in one compiled pass over its tree.

The composite-rigid-body and recursive Newton-Euler algorithms (Featherstone, Rigid Body Dynamics Algorithms, 2008,
tables 6.2 and 5.1) in world axes, so that nothing is transformed between links: every tree is written about a fixed
point, which at each evaluation lies where its root joint is. Pinocchio is the reference.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.dynamics.tree_arrays import (
    BALL,
    CIRCLE,
    FREE,
    SLIDE,
    TURN,
    TreeArrays,
    TreeWork,
    packed_tree,
    tree_work_from,
)
from spacerobot.support.jit import jit, lean


def tree_work(tree: TreeArrays) -> TreeWork:
    """Room for one evaluation."""
    ints, _, size = packed_tree(tree)
    found: TreeWork = tree_work_from(ints, np.zeros(size))
    return found


@lean
def _placed(tree: Any, work: Any, i: int, q: Any) -> None:
    """Rotation and place of joint i, from its parent's."""
    parent, kind, a = tree.joint[i, 0], tree.joint[i, 1], tree.joint[i, 2]
    r, out, b = work.rotation, work.rotation[i], tree.before[i]
    x, y, z = b[9], b[10], b[11]
    if parent < 0:
        m00, m01, m02, m10, m11, m12, m20, m21, m22 = b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]
        px, py, pz = x, y, z
    else:
        p = r[parent]
        m00, m01, m02 = (
            p[0] * b[0] + p[1] * b[3] + p[2] * b[6],
            p[0] * b[1] + p[1] * b[4] + p[2] * b[7],
            p[0] * b[2] + p[1] * b[5] + p[2] * b[8],
        )
        m10, m11, m12 = (
            p[3] * b[0] + p[4] * b[3] + p[5] * b[6],
            p[3] * b[1] + p[4] * b[4] + p[5] * b[7],
            p[3] * b[2] + p[4] * b[5] + p[5] * b[8],
        )
        m20, m21, m22 = (
            p[6] * b[0] + p[7] * b[3] + p[8] * b[6],
            p[6] * b[1] + p[7] * b[4] + p[8] * b[7],
            p[6] * b[2] + p[7] * b[5] + p[8] * b[8],
        )
        px = work.place[parent, 0] + p[0] * x + p[1] * y + p[2] * z
        py = work.place[parent, 1] + p[3] * x + p[4] * y + p[5] * z
        pz = work.place[parent, 2] + p[6] * x + p[7] * y + p[8] * z
    if kind in (FREE, BALL):
        at = a
        if kind == FREE:
            x, y, z = q[a], q[a + 1], q[a + 2]
            px, py, pz = (
                px + m00 * x + m01 * y + m02 * z,
                py + m10 * x + m11 * y + m12 * z,
                pz + m20 * x + m21 * y + m22 * z,
            )
            at = a + 3
        i_, j_, k_, w = q[at], q[at + 1], q[at + 2], q[at + 3]
        t00, t01, t02 = 1.0 - 2.0 * (j_ * j_ + k_ * k_), 2.0 * (i_ * j_ - w * k_), 2.0 * (i_ * k_ + w * j_)
        t10, t11, t12 = 2.0 * (i_ * j_ + w * k_), 1.0 - 2.0 * (i_ * i_ + k_ * k_), 2.0 * (j_ * k_ - w * i_)
        t20, t21, t22 = 2.0 * (i_ * k_ - w * j_), 2.0 * (j_ * k_ + w * i_), 1.0 - 2.0 * (i_ * i_ + j_ * j_)
        n00, n01, n02 = (
            m00 * t00 + m01 * t10 + m02 * t20,
            m00 * t01 + m01 * t11 + m02 * t21,
            m00 * t02 + m01 * t12 + m02 * t22,
        )
        n10, n11, n12 = (
            m10 * t00 + m11 * t10 + m12 * t20,
            m10 * t01 + m11 * t11 + m12 * t21,
            m10 * t02 + m11 * t12 + m12 * t22,
        )
        n20, n21, n22 = (
            m20 * t00 + m21 * t10 + m22 * t20,
            m20 * t01 + m21 * t11 + m22 * t21,
            m20 * t02 + m21 * t12 + m22 * t22,
        )
    elif kind == SLIDE:
        s = q[a]
        px, py, pz = px + m02 * s, py + m12 * s, pz + m22 * s
        n00, n01, n02, n10, n11, n12, n20, n21, n22 = m00, m01, m02, m10, m11, m12, m20, m21, m22
    else:
        c, s = (q[a], q[a + 1]) if kind == CIRCLE else (np.cos(q[a]), np.sin(q[a]))
        n00, n01, n02 = m00 * c + m01 * s, m01 * c - m00 * s, m02
        n10, n11, n12 = m10 * c + m11 * s, m11 * c - m10 * s, m12
        n20, n21, n22 = m20 * c + m21 * s, m21 * c - m20 * s, m22
    if tree.plain[i] == 0:
        t = tree.after[i]
        n00, n01, n02 = (
            n00 * t[0] + n01 * t[3] + n02 * t[6],
            n00 * t[1] + n01 * t[4] + n02 * t[7],
            n00 * t[2] + n01 * t[5] + n02 * t[8],
        )
        n10, n11, n12 = (
            n10 * t[0] + n11 * t[3] + n12 * t[6],
            n10 * t[1] + n11 * t[4] + n12 * t[7],
            n10 * t[2] + n11 * t[5] + n12 * t[8],
        )
        n20, n21, n22 = (
            n20 * t[0] + n21 * t[3] + n22 * t[6],
            n20 * t[1] + n21 * t[4] + n22 * t[7],
            n20 * t[2] + n21 * t[5] + n22 * t[8],
        )
    out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7], out[8] = n00, n01, n02, n10, n11, n12, n20, n21, n22
    point, place = work.point[i], work.place[i]
    if parent < 0:
        point[0], point[1], point[2] = px, py, pz
        place[0], place[1], place[2] = 0.0, 0.0, 0.0
    else:
        root = work.point[tree.joint[i, 4]]
        point[0], point[1], point[2] = root[0], root[1], root[2]
        place[0], place[1], place[2] = px, py, pz
    # the Jacobian's columns: axis through the place, about the tree's point
    if kind in (SLIDE, TURN, CIRCLE):
        column = work.motion[tree.joint[i, 3]]
        if kind == SLIDE:
            column[0], column[1], column[2], column[3], column[4], column[5] = m02, m12, m22, 0.0, 0.0, 0.0
        else:
            x, y, z = place[0], place[1], place[2]
            column[0], column[1], column[2] = y * m22 - z * m12, z * m02 - x * m22, x * m12 - y * m02
            column[3], column[4], column[5] = m02, m12, m22
    else:
        at = tree.joint[i, 3]
        if kind == FREE:
            for k in range(3):
                column = work.motion[at + k]
                column[0], column[1], column[2] = out[k], out[3 + k], out[6 + k]
                column[3], column[4], column[5] = 0.0, 0.0, 0.0
            at += 3
        x, y, z = place[0], place[1], place[2]
        for k in range(3):
            column = work.motion[at + k]
            ax, ay, az = out[k], out[3 + k], out[6 + k]
            column[0], column[1], column[2] = y * az - z * ay, z * ax - x * az, x * ay - y * ax
            column[3], column[4], column[5] = ax, ay, az


@lean
def place_bodies(tree: Any, work: Any, q: Any) -> None:
    """Placements and Jacobian at q: `rotation`, `place`, `point`, `motion`."""
    for i in range(tree.mass.size):
        _placed(tree, work, i, q)


@lean
def move_bodies(tree: Any, work: Any, v: Any) -> None:
    """Velocities, bias accelerations and the Jacobian's drift at v, after `place_bodies`."""
    m = tree.mass.size
    for i in range(m):
        parent, kind, b = tree.joint[i, 0], tree.joint[i, 1], tree.joint[i, 3]
        count = 6 if kind == FREE else 3 if kind == BALL else 1
        speed, bias = work.speed[i], work.bias[i]
        if parent < 0:
            for k in range(6):
                speed[k], bias[k] = 0.0, 0.0
        else:
            for k in range(6):
                speed[k], bias[k] = work.speed[parent, k], work.bias[parent, k]
        for d in range(b, b + count):
            column, rate = work.motion[d], v[d]
            for k in range(6):
                speed[k] += column[k] * rate
        vx, vy, vz, wx, wy, wz = speed[0], speed[1], speed[2], speed[3], speed[4], speed[5]
        for d in range(b, b + count):
            s, out, rate = work.motion[d], work.drift[d], v[d]
            ax, ay, az, bx, by, bz = s[0], s[1], s[2], s[3], s[4], s[5]
            out[0] = wy * az - wz * ay + vy * bz - vz * by
            out[1] = wz * ax - wx * az + vz * bx - vx * bz
            out[2] = wx * ay - wy * ax + vx * by - vy * bx
            out[3], out[4], out[5] = wy * bz - wz * by, wz * bx - wx * bz, wx * by - wy * bx
            for k in range(6):
                bias[k] += out[k] * rate


@lean
def weigh_bodies(tree: Any, work: Any) -> None:
    """Joint-space inertia and Coriolis, centrifugal and gravity terms, after `move_bodies`."""
    m = tree.mass.size
    gx, gy, gz = tree.gravity[0], tree.gravity[1], tree.gravity[2]
    for i in range(m):
        r, p, h, t = work.rotation[i], work.place[i], tree.moment[i], tree.inertia[i]
        mass = tree.mass[i]
        # m c in world axes about the joint's origin, then about the tree's point
        ax = r[0] * h[0] + r[1] * h[1] + r[2] * h[2]
        ay = r[3] * h[0] + r[4] * h[1] + r[5] * h[2]
        az = r[6] * h[0] + r[7] * h[1] + r[8] * h[2]
        hx, hy, hz = ax + mass * p[0], ay + mass * p[1], az + mass * p[2]
        # R I R^T, xx xy yy xz yz zz
        u0, u1, u2 = (
            r[0] * t[0] + r[1] * t[1] + r[2] * t[3],
            r[0] * t[1] + r[1] * t[2] + r[2] * t[4],
            r[0] * t[3] + r[1] * t[4] + r[2] * t[5],
        )
        v0, v1, v2 = (
            r[3] * t[0] + r[4] * t[1] + r[5] * t[3],
            r[3] * t[1] + r[4] * t[2] + r[5] * t[4],
            r[3] * t[3] + r[4] * t[4] + r[5] * t[5],
        )
        w0, w1, w2 = (
            r[6] * t[0] + r[7] * t[1] + r[8] * t[3],
            r[6] * t[1] + r[7] * t[2] + r[8] * t[4],
            r[6] * t[3] + r[7] * t[4] + r[8] * t[5],
        )
        xx, xy, yy = (
            u0 * r[0] + u1 * r[1] + u2 * r[2],
            u0 * r[3] + u1 * r[4] + u2 * r[5],
            v0 * r[3] + v1 * r[4] + v2 * r[5],
        )
        xz, yz, zz = (
            u0 * r[6] + u1 * r[7] + u2 * r[8],
            v0 * r[6] + v1 * r[7] + v2 * r[8],
            w0 * r[6] + w1 * r[7] + w2 * r[8],
        )
        # Steiner's terms with the place p of the origin: a p^T + p a^T and m p p^T
        px, py, pz = p[0], p[1], p[2]
        sx, sy, sz = px * (2.0 * ax + mass * px), py * (2.0 * ay + mass * py), pz * (2.0 * az + mass * pz)
        xx, yy, zz = xx + sy + sz, yy + sx + sz, zz + sx + sy
        xy -= px * ay + ax * py + mass * px * py
        xz -= px * az + ax * pz + mass * px * pz
        yz -= py * az + ay * pz + mass * py * pz
        c = work.composite[i]
        c[0], c[1], c[2], c[3] = mass, hx, hy, hz
        c[4], c[5], c[6], c[7], c[8], c[9] = xx, xy, yy, xz, yz, zz
        s, b = work.speed[i], work.bias[i]
        vx, vy, vz, wx, wy, wz = s[0], s[1], s[2], s[3], s[4], s[5]
        lx, ly, lz, ux, uy, uz = b[0] - gx, b[1] - gy, b[2] - gz, b[3], b[4], b[5]
        # momentum and its rate
        qx, qy, qz = mass * vx + wy * hz - wz * hy, mass * vy + wz * hx - wx * hz, mass * vz + wx * hy - wy * hx
        kx = xx * wx + xy * wy + xz * wz + hy * vz - hz * vy
        ky = xy * wx + yy * wy + yz * wz + hz * vx - hx * vz
        kz = xz * wx + yz * wy + zz * wz + hx * vy - hy * vx
        f = work.force[i]
        f[0] = mass * lx + uy * hz - uz * hy + wy * qz - wz * qy
        f[1] = mass * ly + uz * hx - ux * hz + wz * qx - wx * qz
        f[2] = mass * lz + ux * hy - uy * hx + wx * qy - wy * qx
        f[3] = xx * ux + xy * uy + xz * uz + hy * lz - hz * ly + wy * kz - wz * ky + vy * qz - vz * qy
        f[4] = xy * ux + yy * uy + yz * uz + hz * lx - hx * lz + wz * kx - wx * kz + vz * qx - vx * qz
        f[5] = xz * ux + yz * uy + zz * uz + hx * ly - hy * lx + wx * ky - wy * kx + vx * qy - vy * qx
    for back in range(m):
        i = m - 1 - back
        parent, kind, first = tree.joint[i, 0], tree.joint[i, 1], tree.joint[i, 3]
        count = 6 if kind == FREE else 3 if kind == BALL else 1
        c, f = work.composite[i], work.force[i]
        mass, hx, hy, hz = c[0], c[1], c[2], c[3]
        for d in range(first, first + count):
            s = work.motion[d]
            x, y, z, a, b, e = s[0], s[1], s[2], s[3], s[4], s[5]
            work.load[d] = x * f[0] + y * f[1] + z * f[2] + a * f[3] + b * f[4] + e * f[5]
            fx, fy, fz = mass * x + b * hz - e * hy, mass * y + e * hx - a * hz, mass * z + a * hy - b * hx
            nx = c[4] * a + c[5] * b + c[7] * e + hy * z - hz * y
            ny = c[5] * a + c[6] * b + c[8] * e + hz * x - hx * z
            nz = c[7] * a + c[8] * b + c[9] * e + hx * y - hy * x
            for k in range(first, d + 1):
                o = work.motion[k]
                share = o[0] * fx + o[1] * fy + o[2] * fz + o[3] * nx + o[4] * ny + o[5] * nz
                work.inertia[k, d] = work.inertia[d, k] = share
            work.inertia[d, d] += tree.armature[d]
            j = parent
            while j >= 0:
                at, other = tree.joint[j, 3], tree.joint[j, 1]
                for k in range(at, at + (6 if other == FREE else 3 if other == BALL else 1)):
                    o = work.motion[k]
                    share = o[0] * fx + o[1] * fy + o[2] * fz + o[3] * nx + o[4] * ny + o[5] * nz
                    work.inertia[k, d] = work.inertia[d, k] = share
                j = tree.joint[j, 0]
        if parent >= 0:
            up, above = work.composite[parent], work.force[parent]
            for k in range(10):
                up[k] += c[k]
            for k in range(6):
                above[k] += f[k]


@jit
def recursion(tree: Any, work: Any, q: Any, v: Any) -> None:
    """All of it, for a caller in Python."""
    place_bodies(tree, work, q)
    move_bodies(tree, work, v)
    weigh_bodies(tree, work)
