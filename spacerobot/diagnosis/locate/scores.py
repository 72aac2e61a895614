"""Scores of patterns against whitened residuals, added up trial by trial."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate import significance

STRETCH = 8
"""Rows that flip their sign together: twice as long as a test function."""

LEAST = 1e-3
"""A pattern of which wrong believed values imitate all but this share of the information cannot be seen."""


@dataclass(frozen=True)
class Verdict:
    """What one test says; fields as in `Row`."""

    log_p: float
    score: float
    fall: float
    coefficient: float
    error: float
    p_flips: float
    at: float


class Score:
    """One pattern, in one or several variants of which the best counts. V variants."""

    def __init__(self, at: np.ndarray) -> None:
        self.at = at  # (V,) what distinguishes the variants
        self._scores: list[np.ndarray] = []  # (V, U) each
        self.information: np.ndarray | float = 0.0  # (V,)
        self._before: np.ndarray | float = 0.0  # (V,) if the believed values were exact

    def add(self, white: np.ndarray, patterns: np.ndarray, exact: np.ndarray) -> None:
        """Add a trial.

        Args:
            white: whitened residual, shape (R,).
            patterns: whitened alike, shape (R, V).
            exact: whitened by sensor noise alone, shape (R, V).
        """
        edges = np.arange(0, white.size, STRETCH)
        self._scores.append(np.add.reduceat(patterns * white[:, None], edges, axis=0).T)
        self.information = self.information + np.square(patterns).sum(axis=0)
        self._before = self._before + np.square(exact).sum(axis=0)

    def verdict(self, least: float, seed: int) -> Verdict | None:
        """Of the best variant; None where none has more information than `least`."""
        scores = np.concatenate(self._scores, axis=1)
        information = np.asarray(self.information)
        seen = (information > LEAST * np.asarray(self._before)) & (information > least)
        if not seen.any():
            return None
        worth = np.where(seen, np.square(scores.sum(axis=1)) / np.where(seen, information, 1.0), -1.0)
        k = int(np.argmax(worth))
        size = math.sqrt(information[k])
        score = float(scores[k].sum()) / size
        log_p = significance.combined(significance.log_p_normal(score), int(seen.sum()))
        p_flips = significance.flip_p(scores[k], seed)
        return Verdict(log_p, score, score**2, score / size, 1.0 / size, p_flips, float(self.at[k]))
