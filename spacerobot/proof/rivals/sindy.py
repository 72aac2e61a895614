"""PySINDy: sparse terms for what the baseline leaves of the slider's acceleration.

Used as its documentation advises for noisy data: smoothed derivatives, a library of candidate terms, sequentially
thresholded least squares on bagged ensembles with the threshold scanned, several trajectories together. All terms pass
through the smoothing that the acceleration passes through, or it would be taken for physics. The contact force is an
input, so what it predicts is the slider alone.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.signal import savgol_filter

from spacerobot.proof.rivals.opinion import Opinion
from spacerobot.proof.rivals.tracks import RATE, Track, folds
from spacerobot.recordings.study import Study

THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.4)
"""Of the normalised coefficients; the one that predicts best what it has not seen is taken."""

SCALE = (1e-2, 0.1)
"""Units of position [m] and speed [m/s] in which terms are formed, so that coefficients are comparable."""

WINDOW, ORDER = 7, 3
"""Frames and degree of the polynomials that smooth and differentiate."""

TERMS: dict[str, Callable[[Any, Any], Any]] = {
    "1": lambda x, v: 1.0 + 0.0 * x,
    "x": lambda x, v: x,
    "v": lambda x, v: v,
    "sign(v)": lambda x, v: np.tanh(v / 0.05),
    "|v| v": lambda x, v: np.abs(v) * v,
    "x^3": lambda x, v: x**3,
    "|x| x": lambda x, v: np.abs(x) * x,
    "x v": lambda x, v: x * v,
    "v^3": lambda x, v: v**3,
}

BASELINE = ("x", "v")
"""Terms of the baseline itself: in the residual they say that a constant is off, not that physics is missing."""


def sindy(study: Study, tracks: tuple[Track, ...]) -> Opinion:
    """Fit the slider's residual acceleration, choose the threshold on unseen conditions, and say which terms stay."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        errors = {t: _held_out(study, tracks, t) for t in THRESHOLDS}
        best = min(errors, key=lambda t: errors[t])
        coefficients = _fit(study, tracks, best)
    kept = [name for name, c in coefficients.items() if c and name not in BASELINE]
    says = "residual acceleration: " + (" ".join(f"{c:+.3g} {n}" for n, c in coefficients.items() if c) or "nothing")
    return Opinion({"wrist.x": errors[best]}, says, bool(kept))


def _baseline(study: Study) -> tuple[float, float, float]:
    v = study.values()
    return v["wrist.mass"], v["wrist.stiffness"], v["wrist.damping"] + v.get("wrist.equivalent_damping", 0.0)


def _smooth(values: np.ndarray, derivative: int = 0) -> np.ndarray:
    return np.asarray(savgol_filter(values, WINDOW, ORDER, deriv=derivative, delta=1.0 / RATE, axis=0))


def _fit(study: Study, tracks: tuple[Track, ...], threshold: float) -> dict[str, float]:
    """Term -> coefficient of the residual acceleration [m/s^2], zero where it was dropped."""
    import pysindy as ps

    m, k, c = _baseline(study)
    terms, rates = [], []
    for track in tracks:
        x, v = _smooth(track.wrist), _smooth(track.wrist, 1)
        left = _smooth(track.wrist, 2) - _smooth((track.force - k * x - c * v) / m)
        moving = np.abs(x) > 5e-4  # at rest there is nothing to learn
        columns = [np.broadcast_to(term(x / SCALE[0], v / SCALE[1]), x.shape) for term in TERMS.values()]
        terms.append(_smooth(np.column_stack(columns))[moving])
        rates.append(left[moving])
    theta, rate = np.concatenate(terms), np.concatenate(rates)[:, None]
    np.random.seed(0)  # noqa: NPY002 - PySINDy's ensembles draw from NumPy's global state
    optimizer = ps.EnsembleOptimizer(ps.STLSQ(threshold=threshold, alpha=1e-3), bagging=True, n_models=20)
    optimizer.fit(theta, rate)
    return dict(zip(TERMS, (float(value) for value in np.asarray(optimizer.coef_)[0]), strict=True))


def _held_out(study: Study, tracks: tuple[Track, ...], threshold: float) -> float:
    total, samples = 0.0, 0
    for seen, unseen in folds(tracks):
        coefficients = _fit(study, seen, threshold)
        for track in unseen:
            error = _simulated(study, coefficients, track) - track.wrist
            total += float(np.sum(np.minimum(error**2, 1.0)))
            samples += error.size
    return float(np.sqrt(total / samples))


def _simulated(study: Study, coefficients: dict[str, float], track: Track) -> np.ndarray:
    """The slider driven by the recorded force, with the fitted terms; shape (T,)."""
    m, k, c = _baseline(study)
    substeps = 20
    h = 1.0 / RATE / substeps
    force = np.interp(np.arange(track.time.size * substeps) * h, track.time, track.force)
    x, v = 0.0, 0.0
    out = np.empty(track.time.size)
    active = [(TERMS[n], value) for n, value in coefficients.items() if value]
    for i in range(track.time.size):
        out[i] = x
        for f in force[i * substeps : (i + 1) * substeps].tolist():
            a = (f - k * x - c * v) / m
            a += sum(value * float(term(x / SCALE[0], v / SCALE[1])) for term, value in active)
            v += h * a
            x += h * v
            if not abs(x) < 1.0:
                out[i:] = 1.0
                return out
    return out
