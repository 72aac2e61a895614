from __future__ import annotations

import numpy as np
import pytest

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.manipulability import dynamic_manipulability, kinematic_manipulability
from tests.dynamics.support import DEFAULT, robot


def test_determinant_formulas() -> None:
    rng = np.random.default_rng(0)
    for _ in range(5):
        j, root = rng.normal(size=(3, 7)), rng.normal(size=(7, 7))
        h = root @ root.T + np.eye(7)
        inverse = np.linalg.inv(h)
        assert kinematic_manipulability(j) == pytest.approx(np.sqrt(np.linalg.det(j @ j.T)), rel=1e-9)
        expected = np.sqrt(np.linalg.det(j @ inverse @ inverse.T @ j.T))
        assert dynamic_manipulability(j, h) == pytest.approx(expected, rel=1e-9)


def test_two_links_in_a_plane() -> None:
    """|det J| = l1 l2 |sin q2| (Yoshikawa 1985)."""
    for q2 in (0.3, 1.2, 2.9):
        c, s = np.cos(q2), np.sin(q2)
        j = np.array([[-0.4 * s, -0.4 * s], [0.5 + 0.4 * c, 0.4 * c]])
        assert kinematic_manipulability(j) == pytest.approx(0.5 * 0.4 * abs(s), rel=1e-12)


def test_zero_where_singular_or_too_few_joints() -> None:
    m = effective_mass(robot("pa10"), np.zeros(7), [1.0, 0.0, 0.0]).manipulability
    assert set(m.values()) == {0.0}
    assert kinematic_manipulability(np.ones((6, 3))) == 0.0
    assert dynamic_manipulability(np.zeros((3, 0)), np.zeros((0, 0))) == 0.0


def test_rotor_inertia_and_a_free_base_make_the_arm_less_able() -> None:
    fixed = effective_mass(robot("pa10_wrist"), DEFAULT, [1.0, 0.0, 0.0]).manipulability
    free = effective_mass(robot("chaser_pa10_wrist"), DEFAULT, [1.0, 0.0, 0.0]).manipulability
    assert 0.0 < free["kinematic_linear"] < fixed["kinematic_linear"]
