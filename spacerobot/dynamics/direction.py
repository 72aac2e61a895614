"""Directions: unit vectors in world axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.support.errors import InputError

TOLERANCE = 1e-6


def unit_directions(direction: ArrayLike, *, where: str | None = None) -> np.ndarray:
    """One or several directions as unit vectors, shape (3,) or (K, 3), rescaled to length 1 exactly.

    Raises:
        InputError: not three components, not finite, or a length that differs from 1 by more than 1e-6.
    """
    try:
        vectors = np.asarray(direction, dtype=float)
    except (TypeError, ValueError):
        raise InputError("direction is not numeric", given=direction, where=where) from None
    if vectors.ndim not in (1, 2) or vectors.shape[-1] != 3:
        raise InputError(
            "direction has the wrong length",
            given=vectors.shape,
            valid="3 components, world axes",
            where=where,
        )
    if not np.isfinite(vectors).all():
        raise InputError("direction is not finite", given=vectors.tolist(), where=where)
    norms = np.linalg.norm(vectors, axis=-1)
    off = np.abs(norms - 1.0) > TOLERANCE
    if np.any(off):
        worst = vectors if vectors.ndim == 1 else vectors[int(np.argmax(off))]
        norm = float(np.linalg.norm(worst))
        hint = f"for this direction {', '.join(f'{x:.9g}' for x in worst / norm)}" if norm > 0 else "three numbers"
        raise InputError(
            "direction is not a unit vector",
            given=f"{', '.join(f'{x:g}' for x in worst)} (length {norm:.9g})",
            valid=f"length 1 within {TOLERANCE:g}; {hint}",
            where=where,
        )
    return vectors / norms[..., None]
