"""Damped steps of a fit: what its trials have of their own may be damped as well."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.normal_equations import Normal

SHARED, OWN, READINGS = 3, 4, 60
FREE = np.full(SHARED, 1e6)


def _normal(rng: np.random.Generator, faint: float = 1.0) -> tuple[Normal, list[np.ndarray], list[np.ndarray]]:
    """Of two trials; the last of each one's own values shows `faint` times as much as the others."""
    jacobians = [rng.standard_normal((READINGS, SHARED + OWN)) for _ in range(2)]
    for jacobian in jacobians:
        jacobian[:, -1] *= faint
    residuals = [10.0 * rng.standard_normal(READINGS) for _ in range(2)]
    return Normal.build(jacobians, residuals, np.zeros(SHARED), np.eye(SHARED)), jacobians, residuals


def _cost(jacobians: list[np.ndarray], residuals: list[np.ndarray], dz: np.ndarray, dn: list[np.ndarray]) -> float:
    moved = (r + j @ np.concatenate([dz, n]) for j, r, n in zip(jacobians, residuals, dn, strict=True))
    return float(dz @ dz) + sum(float(r @ r) for r in moved)


@pytest.mark.parametrize("damping", [0.0, 1e-6, 1e-2, 1.0, 1e3])
def test_a_step_brings_what_it_promises_where_all_is_linear(damping: float) -> None:
    normal, jacobians, residuals = _normal(np.random.default_rng(1))
    dz, dn, promised = normal.step(damping, np.zeros(SHARED), -FREE, FREE, own_too=damping > 0.0)
    nothing = _cost(jacobians, residuals, np.zeros(SHARED), [np.zeros(OWN)] * 2)
    assert promised == pytest.approx(nothing - _cost(jacobians, residuals, dz, dn), rel=1e-6)
    assert promised > 0.0


def test_the_undamped_step_is_the_least_squares_one() -> None:
    normal, jacobians, residuals = _normal(np.random.default_rng(2))
    dz, dn, _ = normal.step(0.0, np.zeros(SHARED), -FREE, FREE)
    rows = np.zeros((2 * READINGS + SHARED, SHARED + 2 * OWN))
    for k, jacobian in enumerate(jacobians):
        of = slice(k * READINGS, (k + 1) * READINGS)
        rows[of, :SHARED], rows[of, SHARED + k * OWN :][:, :OWN] = jacobian[:, :SHARED], jacobian[:, SHARED:]
    rows[-SHARED:, :SHARED] = np.eye(SHARED)  # the prior
    best = np.linalg.lstsq(rows, -np.concatenate([*residuals, np.zeros(SHARED)]), rcond=None)[0]
    np.testing.assert_allclose(np.concatenate([dz, *dn]), best, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("alike", [0.0, 0.9, 0.9999])
def test_no_step_within_bounds_pays_more(alike: float) -> None:
    """Also where two effects act alike and one is cut off at nothing: what it promises is never below nothing."""
    rng = np.random.default_rng(4)
    for _ in range(20):
        jacobians = [rng.standard_normal((READINGS, SHARED + OWN)) for _ in range(2)]
        for jacobian in jacobians:
            jacobian[:, 1] = alike * jacobian[:, 0] + (1.0 - alike) * jacobian[:, 1]
        residuals = [10.0 * rng.standard_normal(READINGS) for _ in range(2)]
        normal = Normal.build(jacobians, residuals, np.zeros(SHARED), np.eye(SHARED))
        z = rng.uniform(0.0, 0.5, SHARED)
        low, high = np.zeros(SHARED), np.ones(SHARED)
        dz, _, promised = normal.step(1e-9, z, low, high)
        assert ((z + dz >= low - 1e-12) & (z + dz <= high + 1e-12)).all()
        assert promised >= 0.0

        def model(step: np.ndarray, of: Normal = normal) -> float:
            return float(0.5 * step @ of.reduced @ step + of.gradient @ step)

        others = rng.uniform(low, high, (200, SHARED)) - z
        assert model(dz) <= min(map(model, others)) + 1e-9 * abs(model(dz))


def test_more_damping_is_a_shorter_step_of_every_value() -> None:
    normal, _, _ = _normal(np.random.default_rng(3))
    lengths = []
    for damping in (0.0, 0.1, 1.0, 1e2, 1e4):
        dz, dn, _ = normal.step(damping, np.zeros(SHARED), -FREE, FREE, own_too=damping > 0.0)
        lengths.append((np.linalg.norm(dz), *(np.linalg.norm(n) for n in dn)))
    longer, shorter = np.array(lengths[:-1]), np.array(lengths[1:])
    assert (shorter < longer).all()
    assert (np.array(lengths[-1]) < 1e-2 * np.array(lengths[0])).all()


def test_what_hardly_shows_does_not_make_a_step_that_was_refused_long() -> None:
    """A joint that sticks: how fast it drifted before shows in nothing."""
    normal, _, _ = _normal(np.random.default_rng(4), faint=1e-4)
    _, wild, _ = normal.step(0.1, np.zeros(SHARED), -FREE, FREE)
    _, tame, _ = normal.step(0.1, np.zeros(SHARED), -FREE, FREE, own_too=True)
    assert min(abs(n[-1]) for n in wild) > 1e2
    assert max(abs(n[-1]) for n in tame) < 10.0
    for a, b in zip(wild, tame, strict=True):
        assert np.abs(a[:-1] - b[:-1]).max() < 0.2 * np.abs(a[:-1]).max()
