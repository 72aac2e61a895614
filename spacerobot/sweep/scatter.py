"""Draws that depend on the seed and the collision's number alone, so that no division of the work can change them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.support.errors import InputError

KINDS = ("normal", "uniform")
CUT = 4.0
"""Normal draws beyond so many standard deviations are set to it; one in sixteen thousand is."""

_WORDS = 4  # that Philox makes at a time


@dataclass(frozen=True)
class Scatter:
    """How one number varies from collision to collision about its value.

    Attributes:
        kind: "normal" (amount is the standard deviation) or "uniform" (amount is the half width).
        amount: relative to the value, unless `absolute`.
        absolute: amount is in the number's own unit.
    """

    kind: str
    amount: float
    absolute: bool = False

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("unknown kind of scatter", given=self.kind, valid=", ".join(KINDS))

    @property
    def reach(self) -> float:
        """Largest draw, as a multiple of the amount."""
        return CUT if self.kind == "normal" else 1.0

    def spread(self, values: np.ndarray, uniform: np.ndarray) -> np.ndarray:
        """Values with scatter; `uniform` in (0, 1), same shape."""
        if self.kind == "normal":
            from scipy.special import ndtri

            draws = np.clip(ndtri(uniform), -CUT, CUT)
        else:
            draws = 2.0 * uniform - 1.0
        return values + draws * self.amount if self.absolute else values * (1.0 + draws * self.amount)


def uniforms(seed: int, first: int, last: int, columns: int) -> np.ndarray:
    """Numbers in (0, 1) of the collisions first to last - 1, shape (last - first, columns).

    Philox (Salmon et al. 2011) makes the k-th word from seed and k, so every collision has its own.
    """
    if columns == 0:
        return np.empty((last - first, 0))
    begin, end = first * columns, last * columns
    block = begin // _WORDS
    words = np.random.Philox(key=seed, counter=block).random_raw(end - block * _WORDS)[begin - block * _WORDS :]
    return ((words >> np.uint64(11)).astype(float) + 0.5).reshape(-1, columns) * 2.0**-53
