from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
import scipy.special
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.theory.matrix_exponential import expm
from spacerobot.theory.roots import bracketed_root
from spacerobot.theory.special import gamma_ratio, lambert_w0


@settings(max_examples=200, derandomize=True, deadline=None)
@given(st.floats(-0.36, 1e6))
def test_lambert_against_scipy(x: float) -> None:
    assert lambert_w0(x) == pytest.approx(float(scipy.special.lambertw(x).real), rel=1e-12, abs=1e-15)


def test_lambert_at_its_branch_point() -> None:
    assert lambert_w0(-math.exp(-1)) == pytest.approx(-1, abs=1e-7)
    assert lambert_w0(0.0) == 0.0
    with pytest.raises(ValueError, match="-1/e"):
        lambert_w0(-0.4)


def test_gamma_ratio() -> None:
    assert gamma_ratio(1.4, 0.9) == pytest.approx(float(scipy.special.gamma(1.4) / scipy.special.gamma(0.9)))
    assert gamma_ratio(300.5, 300.0) == pytest.approx(math.sqrt(300.0), rel=1e-3)


@pytest.mark.parametrize("scale", [1e-6, 0.1, 1.0, 30.0])
def test_expm_against_scipy(scale: float) -> None:
    a = np.random.default_rng(3).normal(size=(7, 7)) * scale
    expected = scipy.linalg.expm(a)
    assert np.abs(expm(a) - expected).max() <= 1e-12 * np.abs(expected).max()


def test_bracketed_root() -> None:
    assert bracketed_root(math.cos, 0.0, 3.0) == pytest.approx(math.pi / 2, abs=4e-16)
    assert bracketed_root(lambda x: x**9, -1.0, 2.0) == pytest.approx(0.0, abs=1e-18)
    assert bracketed_root(lambda x: x, 0.0, 1.0) == 0.0
    with pytest.raises(ValueError, match="sign change"):
        bracketed_root(math.cosh, -1.0, 1.0)
