"""Constant and work arrays of the compiled kernel, packed: a compiled call pays for every array it is handed."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.dynamics.tree_arrays import (
    TreeArrays,
    TreeWork,
    packed_tree,
    tree_inside,
    tree_work_from,
    tree_work_inside,
)
from spacerobot.support.jit import jit, lean, lean_twin

NF, NV, PORTS, JOINTS, STUCK, SPLIT, RISE, TREE_INTS, TREE_FLOATS, TREE_WORK, HEADER = range(11)
"""Where the packed integers keep counts, two indices, and where the tree of bodies begins in each array."""

BODIES = 5


class Layout(NamedTuple):
    """Constant arrays. nf features, nv velocities, m ports of the mechanism (without contact and slide)."""

    joints: np.ndarray  # (njoints, 3) int: kind, index into q, index into v
    feature: np.ndarray  # (nf, 3) int: kind, index into q or body, index into v or direction
    support: np.ndarray  # (BODIES, nv) int: 1 where a velocity moves the body
    carrier: np.ndarray  # (BODIES,) int: joint in the tree of bodies that carries it, -1 for the world
    reference: np.ndarray  # (nf,) displacement at rest, taken off
    ports: np.ndarray  # (m, nf) coefficients
    local: np.ndarray  # (BODIES, 3) the frame's origin in its joint; the target's is its contact point
    axes: np.ndarray  # (3, 3) rows approach, lateral, up
    tip_axes: np.ndarray  # (3, 3) rows: contact normal, lateral and upward direction in the tip's joint
    ahead: np.ndarray  # (nf, 3) of a heading: the direction that it is the heading of, in its body
    split: int  # first velocity of the target
    seen: np.ndarray  # (nf,) int: 1 where a port in use reads it
    used: np.ndarray  # (m,) int: 1 where something acts or reads
    rise: int  # port of the upward sliding, or -1


class Scratch(NamedTuple):
    """Work arrays. R frictions (at least one)."""

    row: np.ndarray  # (nf, nv)
    value: np.ndarray  # (nf, 3): displacement, rate, bias acceleration
    place: np.ndarray  # (BODIES, 3) frame origins in the world
    arm: np.ndarray  # (BODIES, 3) the same from the point of the tree that carries them
    motion: np.ndarray  # (2, 3, 3)
    vectors: np.ndarray  # (6, 3)
    factor: np.ndarray  # (nv, nv) Cholesky factor
    free: np.ndarray  # (nv,) acceleration
    held: np.ndarray  # (R, nv) M^-1 W^T of stuck ports
    matrix: np.ndarray  # (R, R)
    vector: np.ndarray  # (R,)


def packed(layout: Layout, tree: TreeArrays, frictions: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integers and floats that hold a layout and its tree of bodies, and a work array for their scratch."""
    nf, nv = layout.feature.shape[0], layout.support.shape[1]
    r = max(frictions, 1)
    tree_ints, tree_floats, tree_size = packed_tree(tree)
    constant = [layout.joints, layout.feature, layout.support, layout.carrier, layout.seen, layout.used]
    floats = [layout.reference, layout.ports, layout.local, layout.axes, layout.tip_axes, layout.ahead]
    size = nf * nv + 3 * nf + 6 * BODIES + 18 + 18 + nv * nv + nv + r * nv + r * r + r
    starts = [HEADER + sum(a.size for a in constant), sum(a.size for a in floats), size]
    counts = [nf, nv, layout.ports.shape[0], layout.joints.shape[0], r, layout.split, layout.rise, *starts]
    ints = [np.array(counts), *(a.ravel() for a in constant), tree_ints]
    return (
        np.concatenate(ints).astype(np.int64),
        np.concatenate([*(a.ravel() for a in floats), tree_floats]).astype(float),
        np.zeros(size + tree_size),
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
    a += BODIES * nv
    carrier = k[a : a + BODIES]
    a += BODIES
    seen, used = k[a : a + nf], k[a + nf : a + nf + m]
    reference = x[:nf]
    b = nf
    ports = x[b : b + m * nf].reshape((m, nf))
    b += m * nf
    local = x[b : b + 3 * BODIES].reshape((BODIES, 3))
    b += 3 * BODIES
    axes, tip_axes = x[b : b + 9].reshape((3, 3)), x[b + 9 : b + 18].reshape((3, 3))
    ahead = x[b + 18 : b + 18 + 3 * nf].reshape((nf, 3))
    return Layout(
        joints, feature, support, carrier, reference, ports, local, axes, tip_axes, ahead, k[SPLIT], seen, used, k[RISE]
    )  # fmt: skip


@jit
def scratch_from(k: Any, s: Any) -> Scratch:
    """The scratch inside a work array, as views."""
    nf, nv, r = k[NF], k[NV], k[STUCK]
    row = s[: nf * nv].reshape((nf, nv))
    a = nf * nv
    value = s[a : a + 3 * nf].reshape((nf, 3))
    a += 3 * nf
    place, arm = s[a : a + 3 * BODIES].reshape((BODIES, 3)), s[a + 3 * BODIES : a + 6 * BODIES].reshape((BODIES, 3))
    a += 6 * BODIES
    motion, vectors = s[a : a + 18].reshape((2, 3, 3)), s[a + 18 : a + 36].reshape((6, 3))
    a += 36
    factor = s[a : a + nv * nv].reshape((nv, nv))
    a += nv * nv
    free = s[a : a + nv]
    a += nv
    held = s[a : a + r * nv].reshape((r, nv))
    a += r * nv
    matrix, vector = s[a : a + r * r].reshape((r, r)), s[a + r * r : k[TREE_WORK]]
    return Scratch(row, value, place, arm, motion, vectors, factor, free, held, matrix, vector)


@jit
def bodies_from(k: Any, s: Any) -> TreeWork:
    """What the tree of bodies leaves in a work array, as views."""
    found: TreeWork = tree_work_from(k[k[TREE_INTS] :], s[k[TREE_WORK] :])
    return found


layout_inside, scratch_inside = lean_twin(layout_from), lean_twin(scratch_from)
"""The same for compiled callers; what they return must not reach Python."""


@lean
def tree_of(k: Any, x: Any) -> TreeArrays:
    """The tree of bodies that `packed` wrote, as views for compiled callers."""
    found: TreeArrays = tree_inside(k[k[TREE_INTS] :], x[k[TREE_FLOATS] :])
    return found


@lean
def bodies_of(k: Any, s: Any) -> TreeWork:
    """As `bodies_from`, for compiled callers."""
    found: TreeWork = tree_work_inside(k[k[TREE_INTS] :], s[k[TREE_WORK] :])
    return found
