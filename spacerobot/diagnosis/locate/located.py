"""What locating hands over: rows of what the residuals depend on, surfaces for figures, the clocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spacerobot.diagnosis.terms.decision import LOCATED

ALL = "all"
"""The phase of a row that takes the whole trial together."""

BINS = 15
"""Of a surface."""


@dataclass(frozen=True)
class Row:
    """One pattern that was sought in one balance.

    Attributes:
        balance: a coordinate, "contact", a sensor, or a port that should stand still.
        phase: of the trial, or "all".
        depends_on: "constant", "displacement", "displacement^3", "large displacement", "velocity",
            "sign of velocity", "velocity^2" (v|v|), "direction of motion", "force", "frequency"; of a sensor "time",
            "gain" or "constant"; of a contact also "displacement^2" and "displacement times velocity".
        share: of the balance's residual beyond its noise, 0 to 1, that the pattern explains.
        p: of the pattern being noise, corrected for the number of patterns sought, and not below what sign flips
            of whole trials allow.
        score: the pattern's coefficient over its standard error under the sensor noise.
        coefficient, error: of the pattern, SI (of a "frequency" the hidden mass [kg]).
        at: the frequency [Hz] of "frequency", the threshold [m or rad] of "large displacement", else nan.
        log_p: natural log of the uncorrected p-value against the sensor noise.
        p_flips: share of sign patterns over stretches of the trials that would agree as well.
    """

    balance: str
    phase: str
    depends_on: str
    share: float
    p: float
    score: float
    coefficient: float
    error: float
    at: float
    log_p: float
    p_flips: float


@dataclass(frozen=True, eq=False)
class Surface:
    """Residual force against what it may depend on, binned over all trials. K bins.

    Attributes:
        balance: whose.
        quantity: "displacement", "velocity" or "force".
        unit: of x.
        x: bin centres, ascending, shape (K,).
        y: residual force, predicted minus measured, shape (K,).
        error: one standard error of y under the sensor noise, shape (K,).
        y_unit: "N", "N m" or "m".
    """

    balance: str
    quantity: str
    unit: str
    x: np.ndarray
    y: np.ndarray
    error: np.ndarray
    y_unit: str


@dataclass(frozen=True)
class Clock:
    """How late one sensor's readings are against the positions.

    Attributes:
        sensor: which.
        delay_s: positive if late.
        error_s: one standard error under the sensor noise.
        gain: fall of chi-squared of the target's balance from no delay to this one.
    """

    sensor: str
    delay_s: float
    error_s: float
    gain: float


@dataclass(frozen=True)
class Total:
    """How well one balance closes over all trials: chi-squared of the whitened residual, its degrees of freedom, p."""

    balance: str
    unit: str
    chi2: float
    freedom: int
    p: float


@dataclass(frozen=True, eq=False)
class Located:
    """Where recording and model part.

    Attributes:
        rows: most significant first.
        surfaces: for figures.
        totals: per balance.
        clocks: per sensor that can be late.
        phases: trial id -> phase -> (begin, end) [s].
    """

    rows: tuple[Row, ...]
    surfaces: tuple[Surface, ...]
    totals: tuple[Total, ...]
    clocks: tuple[Clock, ...] = ()
    phases: Mapping[str, Mapping[str, tuple[float, float]]] = field(default_factory=dict)

    def found(self, level: float = LOCATED) -> tuple[Row, ...]:
        """The rows with p below `level`, most significant first."""
        return tuple(r for r in self.rows if r.p < level)

    def best(self, level: float = LOCATED) -> dict[str, Row]:
        """Balance -> its most significant row, of those found."""
        out: dict[str, Row] = {}
        for row in self.found(level):
            out.setdefault(row.balance, row)
        return out
