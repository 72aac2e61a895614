"""How much wider noise makes an interval that is not white, or larger than stated: each parameter's own inflation.

Noise that is alike from sample to sample averages out more slowly: so many samples count for fewer. How many fewer for
a parameter hangs on how fast its own influence changes sign: a slow drift of the track feels all of the colour, a ring
of the force none. The variance of a least-squares value is h' C h, where h (S,) is what each sample's error adds to the
value and C the covariance of the errors (the sandwich: Huber 1967, White 1980, with autocovariances Newey & West 1987).
C is measured on all that the fit leaves, before the touch and after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.terms.data import TrialData

LONGEST = 3
"""Lags are looked at up to a third of the longest trial: beyond, too few pairs of readings are left."""


@dataclass(frozen=True, eq=False)
class Influence:
    """What a fit makes of the error of each sample.

    Attributes:
        columns: per trial, what a unit of each sample's residual moves the parameters by, shape (G, S) [z].
        taken: per trial, an orthogonal basis of what the fit takes out of the residual, shape (S, G + N).
        prior: share of the parameters' variance that comes from priors, not from samples, shape (G,).
        variance: of the parameters for white noise as stated, shape (G,).
    """

    columns: Mapping[str, np.ndarray]
    taken: Mapping[str, np.ndarray]
    prior: np.ndarray
    variance: np.ndarray

    @classmethod
    def of(cls, fitter: Fitter, fit: Fit) -> Influence:
        """At a finished fit."""
        rows, count = fitter.rows_at(fit), len(fit.hypothesis.free)
        prior = fit.hypothesis.precision
        information, shared, own = prior.copy(), {}, {}
        for trial in fitter.trials:
            counts = fit.trials[trial.id].residual != 0.0
            j = rows[trial.id] * counts[:, None]
            own[trial.id], _ = np.linalg.qr(j[:, count:])
            shared[trial.id] = j[:, :count] - own[trial.id] @ (own[trial.id].T @ j[:, :count])
            information = information + shared[trial.id].T @ shared[trial.id]
        covariance = np.linalg.pinv(information, hermitian=True)
        size, vectors = np.linalg.eigh(covariance)
        root = vectors * np.sqrt(np.maximum(size, 0.0))
        return cls(
            {k: covariance @ j.T for k, j in shared.items()},
            {k: np.hstack([own[k], j @ root]) for k, j in shared.items()},
            np.einsum("ij,jk,ki->i", covariance, prior, covariance),
            np.diag(covariance),
        )


def inflations(fitter: Fitter, fit: Fit) -> dict[str, float]:
    """By which a rise of the cost is to be divided to count as one of white noise as stated, by parameter; 1 at least.

    Args:
        fitter: of the trials the fit was made to.
        fit: a finished fit.
    """
    influence = Influence.of(fitter, fit)
    variance = influence.prior.copy()
    for stream in dict.fromkeys(b.stream for t in fitter.trials for b in t.blocks):
        own = [s for s in _series(fitter.trials, fit, influence) if s.stream == stream]
        levels = _levels(own)
        variance += sum(levels[s.channel] * np.square(s.influence).sum(axis=1) for s in own)
        for lag, rho in _correlations(own, levels):
            variance += sum(2.0 * rho * levels[s.channel] * _lagged(s.influence, lag).sum(axis=1) for s in own)
    ratio = variance / np.maximum(influence.variance, 1e-300)
    return {f.key: max(1.0, float(r)) for f, r in zip(fit.hypothesis.free, ratio, strict=True)}


@dataclass(frozen=True, eq=False)
class _Series:
    """One channel of one trial, T samples."""

    stream: str
    channel: str
    residual: np.ndarray  # (T,), zero where masked
    influence: np.ndarray  # (G, T)
    taken: np.ndarray  # (K, T)


def _series(trials: Sequence[TrialData], fit: Fit, influence: Influence) -> Iterator[_Series]:
    for trial in trials:
        row = 0
        for block in trial.blocks:
            for channel in block.channels:
                rows = slice(row, row + block.time.size)
                row += block.time.size
                yield _Series(
                    block.stream,
                    channel,
                    fit.trials[trial.id].residual[rows],
                    influence.columns[trial.id][:, rows],
                    influence.taken[trial.id][rows].T,
                )


def _lagged(x: np.ndarray, lag: int) -> np.ndarray:
    """Products of values so many samples apart, along the last axis."""
    return np.asarray(x[..., : x.shape[-1] - lag] * x[..., lag:])


def _levels(series: Sequence[_Series]) -> dict[str, float]:
    """Variance of the noise by channel [stated sigmas squared], 1 at least; what the fit has taken out counts."""
    out = {}
    for channel in dict.fromkeys(s.channel for s in series):
        own = [s for s in series if s.channel == channel]
        left = sum(float((s.residual != 0.0).sum() - np.square(s.taken).sum()) for s in own)
        out[channel] = max(1.0, sum(float(s.residual @ s.residual) for s in own) / max(left, 1.0))
    return out


def _correlations(series: Sequence[_Series], levels: Mapping[str, float]) -> Iterator[tuple[int, float]]:
    """Lags [samples] and autocorrelations of one instrument's noise, as far as these are more than chance.

    They are added in pairs of lags until a pair is no longer positive (Geyer 1992, initial positive sequence), and are
    freed of the negative bias that what a fit has taken out of white noise gives them.
    """
    lag, longest = 1, max(s.residual.size for s in series) // LONGEST
    while lag + 1 <= longest:
        pair = [_correlation(series, levels, k) for k in (lag, lag + 1)]
        if sum(pair) <= 0.0:
            return
        yield from zip((lag, lag + 1), pair, strict=True)
        lag += 2


def _correlation(series: Sequence[_Series], levels: Mapping[str, float], lag: int) -> float:
    seen = both = 0.0
    for s in series:
        if s.residual.size > lag:
            seen += float(_lagged(s.residual, lag).sum()) / levels[s.channel] + float(_lagged(s.taken, lag).sum())
            both += float(_lagged((s.residual != 0.0).astype(float), lag).sum())
    return seen / max(both, 1.0)
