"""Operational-space inertia: inverses of the mobility where they exist, and a word on where they do not."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.dynamics.mobility import SINGULAR


def operational_inertia(mobility: np.ndarray) -> np.ndarray | None:
    """Inverse of a mobility block, or None where the frame cannot move in every direction.

    The inverse of the linear (3, 3) block is Khatib's Lambda_v (IJRR 1995), what a force without a moment
    meets. It is not the linear block of the (6, 6) Lambda, which is what a force meets if moments keep the
    frame from turning.

    Args:
        mobility: shape (3, 3) or (6, 6), symmetric (complex for servo joints).
    """
    if rank(mobility) < mobility.shape[0]:
        return None
    scale = _scale(mobility)
    inverse = np.linalg.inv(mobility * np.outer(scale, scale))
    return 0.5 * (inverse + inverse.T) * np.outer(scale, scale)


def rank(mobility: np.ndarray) -> int:
    """In how many independent ways the frame can move; each block is scaled by its largest mobility."""
    scale = _scale(mobility)
    values = np.linalg.svd(mobility * np.outer(scale, scale), compute_uv=False)
    return int(np.sum(values > SINGULAR * values[0])) if values[0] > 0 else 0


def along(mobility: np.ndarray, direction: np.ndarray) -> float:
    """n^T G n of a real symmetric block; zero where it is below SINGULAR of the block's largest.

    Args:
        mobility: shape (3, 3).
        direction: shape (3,), unit vector.
    """
    value = float(direction @ mobility @ direction)
    largest = float(np.linalg.eigvalsh(mobility)[-1])
    return value if value > SINGULAR * largest else 0.0


def reciprocal(mobility: float) -> float:
    """Mass of a mobility; infinite at zero."""
    return 1.0 / mobility if mobility > 0.0 else math.inf


def _scale(mobility: np.ndarray) -> np.ndarray:
    blocks = [np.linalg.norm(mobility[i : i + 3, i : i + 3], 2) for i in range(0, mobility.shape[0], 3)]
    return np.repeat([1.0 / math.sqrt(b) if b > 0 else 1.0 for b in blocks], 3)
