"""Radau IIA collocation: nodes, weights, and what its solution and its error estimate need.

Hairer and Wanner, Solving Ordinary Differential Equations II (1996), sections IV.5 and IV.8: L-stable, of order
2s - 1, its collocation polynomial of order s + 1 throughout the step.
"""

from __future__ import annotations

import numpy as np
from scipy.special import roots_jacobi

from spacerobot.simulation.multibody.dop853 import POWERS

NODES = 5
"""Odd, so that the matrix has one real eigenvalue, and at most POWERS, so that a step's record holds the polynomial."""


def _integrals(nodes: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Integrals from 0 to each end of the Lagrange polynomials on the nodes, shape (ends, nodes)."""
    powers = np.arange(nodes.size)
    return np.asarray((ends[:, None] ** (powers + 1) / (powers + 1)) @ np.linalg.inv(nodes[:, None] ** powers))


def _basis(nodes: np.ndarray) -> np.ndarray:
    """What each coefficient of the record's interpolant is multiplied by at the nodes, shape (nodes, POWERS)."""
    columns = [nodes]
    for p in range(1, POWERS):
        columns.append(columns[-1] * (1.0 - nodes if p % 2 else nodes))
    return np.stack(columns, axis=1)


C = np.append(0.5 * (1.0 + roots_jacobi(NODES - 1, 1.0, 0.0)[0]), 1.0)
A = _integrals(C, C)
_EIGEN, _VECTORS = np.linalg.eig(A)
_kept = np.argsort(np.abs(_EIGEN.imag))[: NODES // 2 * 2 + 1]
_kept = np.array([i for i in _kept if _EIGEN[i].imag >= -1e-12])
ROOTS = _EIGEN[_kept].astype(complex)
"""The real eigenvalue of A first, then those above the real axis, shape ((NODES + 1) / 2,)."""
ROOTS.imag[0] = 0.0
INTO = np.ascontiguousarray(np.linalg.inv(_VECTORS)[_kept].astype(complex))
OUT = np.ascontiguousarray((_VECTORS[:, _kept] * np.where(np.arange(_kept.size) == 0, 1.0, 2.0)).astype(complex))
"""To eigenvectors and back, where the real part is taken; conjugates are counted by the factor 2."""
GAMMA = float(ROOTS[0].real)
_EMBEDDED = np.linalg.solve(
    (C[:, None] ** np.arange(NODES)).T, 1.0 / np.arange(1, NODES + 1) - GAMMA * np.eye(NODES)[0]
)
DEFECT = _EMBEDDED - A[-1]
"""Error h (GAMMA f0 + sum DEFECT_i f_i): against the formula of order s that also uses the slope at the start."""
FIT = np.zeros((POWERS, NODES))
FIT[:NODES] = np.linalg.inv(_basis(C)[:, :NODES])
"""From changes of state at the nodes to the coefficients of the record's interpolant."""
LAGRANGE = np.array([1.0 / np.prod([a - b for b in C if b != a]) for a in C])
"""Barycentric weights of the nodes."""
