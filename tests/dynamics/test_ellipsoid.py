from __future__ import annotations

import numpy as np
import pytest

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.ellipsoid import BeltedEllipsoid
from spacerobot.support.errors import InputError
from tests.dynamics.support import DEFAULT, directions, robot


def test_radius_is_the_effective_mass_in_every_direction() -> None:
    arm = robot("pa10_wrist")
    belt = effective_mass(arm, DEFAULT, [1.0, 0.0, 0.0]).ellipsoid
    assert belt is not None
    n = directions(10)
    np.testing.assert_allclose(
        belt.radius(n), [effective_mass(arm, DEFAULT, d).effective_mass_kg for d in n], rtol=1e-12
    )
    masses = belt.principal_masses
    assert (np.diff(masses) >= 0.0).all()
    np.testing.assert_allclose(belt.radius(belt.axes.T), masses, rtol=1e-10)
    assert (belt.radius(n) >= masses[0] * (1 - 1e-12)).all()
    assert (belt.radius(n) <= masses[-1] * (1 + 1e-12)).all()


def test_it_is_not_the_quadric_of_lambda() -> None:
    belt = BeltedEllipsoid(np.diag([1.0, 0.25, 0.125]))
    n = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    assert belt.radius(n)[0] == pytest.approx(1.6)
    lam = np.linalg.inv(belt.mobility)
    assert n @ lam @ n == pytest.approx(2.5)  # the inertia's own diagonal is heavier
    quadric = 1.0 / np.sqrt(n @ np.linalg.inv(lam @ lam) @ n)
    assert quadric != pytest.approx(1.6, rel=0.05)


def test_surface_closes_and_lies_on_the_radius() -> None:
    belt = BeltedEllipsoid(np.array([[1.0, 0.2, 0.0], [0.2, 0.5, 0.1], [0.0, 0.1, 0.3]]))
    points = belt.surface(12, 24)
    assert points.shape == (13, 25, 3)
    np.testing.assert_allclose(points[:, 0], points[:, -1], atol=1e-12)
    size = np.linalg.norm(points, axis=-1)
    np.testing.assert_allclose(size.ravel(), belt.radius((points / size[..., None]).reshape(-1, 3)), rtol=1e-9)


def test_singular_surface_has_no_nan() -> None:
    belt = BeltedEllipsoid(np.diag([1.0, 0.5, 0.0]))
    assert np.isinf(belt.principal_masses[-1])
    points = belt.surface()
    assert not np.isnan(points).any()
    assert np.isinf(points).any()
    assert not np.isnan(BeltedEllipsoid(np.zeros((3, 3))).surface(4, 4)).any()


@pytest.mark.parametrize("matrix", [np.eye(2), np.triu(np.ones((3, 3))), -np.eye(3)])
def test_bad_mobility(matrix: np.ndarray) -> None:
    with pytest.raises(InputError):
        BeltedEllipsoid(matrix)
