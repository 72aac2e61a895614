"""Scores of patterns against whitened residuals, added up trial by trial."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate import significance

STRETCH = 8
"""Rows that flip their sign together: twice as long as a test function."""

FEWEST_UNITS = 6
"""With fewer units their spread says nothing of the noise."""

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
        self._shares: list[np.ndarray] = []  # (V, U) each, information by unit
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
        squares = np.square(patterns)
        self._shares.append(np.add.reduceat(squares, edges, axis=0).T)
        self.information = self.information + squares.sum(axis=0)
        self._before = self._before + np.square(exact).sum(axis=0)

    def verdict(self, least: float, noise_known: bool) -> Verdict | None:
        """Of the best variant; None where none has more information than `least`.

        Where the noise is not known, the units' own spread about the common coefficient stands for it (the sandwich
        estimator of White 1982, Econometrica 50, Theorem 3.2), and a unit is a stretch of rows.
        """
        scores = np.concatenate(self._scores, axis=1)
        information = np.asarray(self.information)
        seen = (information > LEAST * np.asarray(self._before)) & (information > least)
        if not seen.any():
            return None
        worth = np.where(seen, np.square(scores.sum(axis=1)) / np.where(seen, information, 1.0), -1.0)
        k = int(np.argmax(worth))
        coefficient = float(scores[k].sum() / information[k])
        error, log_p = 1.0 / math.sqrt(information[k]), 0.0
        fall = coefficient**2 * float(information[k])
        if noise_known:
            log_p = significance.log_p_normal(coefficient / error)
        else:
            left = scores[k] - coefficient * np.concatenate(self._shares, axis=1)[k]
            told = int(np.count_nonzero(np.abs(scores[k]) > 1e-9 * np.abs(scores[k]).max(initial=0.0)))
            if told < FEWEST_UNITS:
                return None
            error = math.sqrt(float(left @ left) * told / (told - 1.0)) / float(information[k])
            log_p = significance.log_p_student(coefficient / error, told - 1)
        log_p = significance.combined(log_p, int(seen.sum()))
        p_flips = significance.flip_p(scores[k])
        return Verdict(log_p, coefficient / error, fall, coefficient, error, p_flips, float(self.at[k]))
