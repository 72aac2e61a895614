from __future__ import annotations

import numpy as np
import pytest

from spacerobot.dynamics.limits import scaled_base, wall_limit
from spacerobot.support.errors import InputError
from tests.dynamics.support import DEFAULT, directions, robot

FACTORS = np.logspace(2, 7, 6)


def test_a_base_of_growing_mass_and_inertia_makes_a_wall() -> None:
    """1/M -> 0 and m~ -> m_w + m_t, first order in one over the base's size."""
    chaser = robot("chaser_pa10_wrist")
    for n in directions(3):
        limit = wall_limit(chaser, chaser.configuration(DEFAULT), n, 9.7, FACTORS)
        assert (np.diff(limit.mobility) < 0.0).all()
        order = -np.diff(np.log10(limit.mobility))
        np.testing.assert_allclose(order[2:], 1.0, atol=1e-3)
        missing = 1.0 - limit.reduced_mass_kg / limit.tip_mass_kg
        np.testing.assert_allclose(-np.diff(np.log10(missing))[2:], 1.0, atol=1e-3)
        assert missing[-1] < 1e-6


def test_mass_alone_does_not_make_a_wall() -> None:
    chaser = robot("chaser_pa10_wrist")
    n = np.array([0.0, 0.0, 1.0])
    limit = wall_limit(chaser, chaser.configuration(DEFAULT), n, 9.7, FACTORS, inertia_too=False)
    assert 50.0 < 1.0 / limit.mobility[-1] < 2000.0
    assert limit.mobility[-1] == pytest.approx(limit.mobility[-2], rel=1e-3)


def test_free_joints_do_not_make_a_wall() -> None:
    chaser = robot("chaser_pa10_wrist")
    q = chaser.configuration(DEFAULT)
    limit = wall_limit(chaser, q, [1.0, 0.0, 0.0], 9.7, FACTORS, joints="free")
    ground = wall_limit(chaser, q, [1.0, 0.0, 0.0], 9.7, [1e12], joints="free").mobility[0]
    assert 1.0 / limit.mobility[-1] == pytest.approx(1.0 / ground, rel=1e-5)
    assert 7.0 < 1.0 / ground < 8.5


def test_bad_input() -> None:
    chaser = robot("chaser_pa10_wrist")
    with pytest.raises(InputError, match="floating"):
        scaled_base(robot("pa10"), 2.0)
    with pytest.raises(InputError, match="positive"):
        scaled_base(chaser, 0.0)
    with pytest.raises(InputError, match="positive"):
        wall_limit(chaser, chaser.configuration(DEFAULT), [1.0, 0.0, 0.0], -1.0, [1.0])
