"""Constant and work arrays of the compiled kernel, packed: a compiled call pays for every array it is handed."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.support.jit import jit, lean

NF, NV, PORTS, JOINTS, STUCK, SPLIT, RISE, HEADER = range(8)
"""Where the packed integers keep the counts of features, velocities, ports, joints and frictions, and two indices."""

BODIES = 5


class Layout(NamedTuple):
    """Constant arrays. nf features, nv velocities, m ports of the mechanism (without contact and slide)."""

    joints: np.ndarray  # (njoints, 3) int: kind, index into q, index into v
    feature: np.ndarray  # (nf, 3) int: kind, index into q or body, index into v or direction
    support: np.ndarray  # (BODIES, nv) int: 1 where a velocity moves the body
    reference: np.ndarray  # (nf,) displacement at rest, taken off
    ports: np.ndarray  # (m, nf) coefficients
    local: np.ndarray  # (BODIES, 3) the frame's origin in its joint; the target's is its contact point
    axes: np.ndarray  # (3, 3) rows approach, lateral, up
    tip_axes: np.ndarray  # (3, 3) rows: contact normal, lateral and upward direction in the tip's joint
    ahead: np.ndarray  # (3,) approach at yaw zero, in the target's body
    split: int  # first velocity of the target
    rise: int  # port of the upward sliding, or -1


class Scratch(NamedTuple):
    """Work arrays. R frictions (at least one)."""

    row: np.ndarray  # (nf, nv)
    value: np.ndarray  # (nf, 3): displacement, rate, bias acceleration
    place: np.ndarray  # (BODIES, 3) frame origins in the world
    motion: np.ndarray  # (2, 3, 3)
    vectors: np.ndarray  # (5, 3)
    factor: np.ndarray  # (nv, nv) Cholesky factor
    free: np.ndarray  # (nv,) acceleration
    held: np.ndarray  # (R, nv) M^-1 W^T of stuck ports
    matrix: np.ndarray  # (R, R)
    vector: np.ndarray  # (R,)


def packed(layout: Layout, frictions: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integers and floats that hold a layout, and a work array for its scratch."""
    nf, nv = layout.feature.shape[0], layout.support.shape[1]
    r = max(frictions, 1)
    header = [nf, nv, layout.ports.shape[0], layout.joints.shape[0], r, layout.split, layout.rise]
    ints = [np.array(header), layout.joints, layout.feature, layout.support]
    floats = [layout.reference, layout.ports, layout.local, layout.axes, layout.tip_axes, layout.ahead]
    size = nf * nv + 3 * nf + 3 * BODIES + 18 + 15 + nv * nv + nv + r * nv + r * r + r
    return (
        np.concatenate([a.ravel() for a in ints]).astype(np.int64),
        np.concatenate([a.ravel() for a in floats]).astype(float),
        np.zeros(size),
    )


@jit
def layout_from(k: Any, x: Any) -> Layout:
    """The layout that `packed` wrote, as views."""
    nf, nv, m, nj = k[NF], k[NV], k[PORTS], k[JOINTS]
    a = HEADER
    joints = k[a : a + 3 * nj].reshape((nj, 3))
    a += 3 * nj
    feature = k[a : a + 3 * nf].reshape((nf, 3))
    a += 3 * nf
    support = k[a : a + BODIES * nv].reshape((BODIES, nv))
    reference = x[:nf]
    b = nf
    ports = x[b : b + m * nf].reshape((m, nf))
    b += m * nf
    local = x[b : b + 3 * BODIES].reshape((BODIES, 3))
    b += 3 * BODIES
    axes, tip_axes = x[b : b + 9].reshape((3, 3)), x[b + 9 : b + 18].reshape((3, 3))
    ahead = x[b + 18 : b + 21]
    return Layout(joints, feature, support, reference, ports, local, axes, tip_axes, ahead, k[SPLIT], k[RISE])


@jit
def scratch_from(k: Any, s: Any) -> Scratch:
    """The scratch inside a work array, as views."""
    nf, nv, r = k[NF], k[NV], k[STUCK]
    row = s[: nf * nv].reshape((nf, nv))
    a = nf * nv
    value = s[a : a + 3 * nf].reshape((nf, 3))
    a += 3 * nf
    place = s[a : a + 3 * BODIES].reshape((BODIES, 3))
    a += 3 * BODIES
    motion, vectors = s[a : a + 18].reshape((2, 3, 3)), s[a + 18 : a + 33].reshape((5, 3))
    a += 33
    factor = s[a : a + nv * nv].reshape((nv, nv))
    a += nv * nv
    free = s[a : a + nv]
    a += nv
    held = s[a : a + r * nv].reshape((r, nv))
    a += r * nv
    return Scratch(
        row, value, place, motion, vectors, factor, free, held, s[a : a + r * r].reshape((r, r)), s[a + r * r :]
    )


layout_inside, scratch_inside = lean(layout_from.py_func), lean(scratch_from.py_func)
"""The same for compiled callers; what they return must not reach Python."""
