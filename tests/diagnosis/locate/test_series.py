from __future__ import annotations

import math

import numpy as np
import pytest

from spacerobot.diagnosis.locate.series import BalanceSeries, locate_series
from spacerobot.support.errors import InputError

TIME = np.arange(0.0, 20.0, 0.05)


def series(extra: float, seed: int, scale: float = 1.0, trial: str = "one") -> BalanceSeries:
    """A residual that some viscous damping has been left in, with friction on top or not."""
    d = np.sin(1.3 * TIME) + 0.3 * np.sin(3.1 * TIME + seed)
    v = 1.3 * np.cos(1.3 * TIME) + 0.93 * np.cos(3.1 * TIME + seed)
    noise = 0.1 * np.random.default_rng(seed).normal(size=TIME.size)
    residual = scale * (extra * np.sign(v) - 0.4 * v + noise)
    return BalanceSeries(
        "joint.a", True, trial, residual, np.full(TIME.size, 0.1), d, v, lambda p: p, {"joint.a.damping": 30.0 * v}
    )


def test_friction_beyond_what_the_unknown_damping_could_do() -> None:
    found = locate_series([series(0.5, 1), series(0.5, 2, trial="two")])
    top = found.rows[0]
    assert (top.balance, top.depends_on) == ("joint.a", "sign of velocity")
    assert top.coefficient == pytest.approx(0.5, rel=0.1)
    assert top.p < 0.001
    assert {s.quantity for s in found.surfaces} == {"displacement", "velocity"}
    assert found.surfaces[0].y_unit == "N m"


@pytest.mark.parametrize("noise_known", [True, False])
def test_noise_alone_is_not_located(noise_known: bool) -> None:
    alarms, p = 0, []
    for seed in range(40):
        rows = locate_series([series(0.0, seed)], noise_known=noise_known).rows
        alarms += min(r.p for r in rows) < 0.05
        p += [math.exp(r.log_p) for r in rows if r.depends_on == "sign of velocity"]
    assert alarms <= 4
    assert np.mean(np.array(p) < 0.2) < 0.42


def test_a_wrong_sigma_changes_nothing_where_the_noise_is_not_known() -> None:
    right, loud = series(0.05, 3), series(0.05, 3, scale=20.0)
    p, q = (locate_series([s]).rows[0].p for s in (right, loud))
    assert p == pytest.approx(q, rel=0.2)


def test_flips_refuse_what_an_understated_noise_makes_significant() -> None:
    rows = locate_series([series(0.0, 3, scale=20.0)], noise_known=True).rows
    assert min(r.log_p for r in rows) < -50.0
    assert min(r.p for r in rows) > 0.01


def test_refused() -> None:
    with pytest.raises(InputError, match="no balance"):
        locate_series([])
    with pytest.raises(InputError, match="positive sigma"):
        BalanceSeries("a", False, "t", np.ones(3), np.zeros(3), np.ones(3), np.ones(3), lambda p: p)
