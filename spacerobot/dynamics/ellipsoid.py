"""The belted effective-mass ellipsoid (Khatib, IJRR 1995): the surface r(n) = M(n) n.

It is not the quadric of Lambda_v: a quadric's radius is 1/sqrt(n^T A n), the belted ellipsoid's is 1/(n^T A
n); they agree along the principal axes only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.mobility import SINGULAR
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief


@dataclass(frozen=True, eq=False, repr=False)
class BeltedEllipsoid(Brief):
    """Effective mass in every direction at one frame.

    Attributes:
        mobility: shape (3, 3), linear mobility G_v = J_v H^-1 J_v^T [1/kg], world axes.
    """

    mobility: np.ndarray

    def __post_init__(self) -> None:
        matrix = np.asarray(self.mobility, dtype=float)
        if matrix.shape != (3, 3) or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0.0):
            raise InputError("a belted ellipsoid needs a symmetric 3x3 mobility", given=matrix.tolist())
        if np.linalg.eigvalsh(matrix)[0] < -1e-9 * abs(matrix).max():
            raise InputError("a mobility has no negative eigenvalue", given=matrix.tolist())

    @property
    def axes(self) -> np.ndarray:
        """Principal directions as columns, shape (3, 3), from the lightest to the heaviest."""
        return np.linalg.eigh(self.mobility)[1][:, ::-1]

    @property
    def principal_masses(self) -> np.ndarray:
        """Effective masses along `axes` [kg], shape (3,), ascending; infinite where the frame cannot move."""
        values = np.linalg.eigvalsh(self.mobility)[::-1]
        return _masses(values, values[0])

    def radius(self, directions: np.ndarray) -> np.ndarray:
        """M(n) [kg] along unit directions (K, 3); shape (K,), infinite where the frame cannot move."""
        n = np.atleast_2d(unit_directions(directions))
        return _masses(np.einsum("ki,ij,kj->k", n, self.mobility, n), np.linalg.eigvalsh(self.mobility)[-1])

    def surface(self, rings: int = 48, segments: int = 96) -> np.ndarray:
        """Points r(n) [kg] on a grid of polar and azimuth angles about the principal axes.

        Args:
            rings: rows from pole to pole.
            segments: columns around.

        Returns:
            shape (rings + 1, segments + 1, 3), world axes. At singular poses some points are infinite, never
            NaN: clip them for drawing.
        """
        polar, azimuth = np.meshgrid(
            np.linspace(0.0, np.pi, rings + 1), np.linspace(0.0, 2.0 * np.pi, segments + 1), indexing="ij"
        )
        local = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
        n = local @ self.axes.T
        radius = self.radius(n.reshape(-1, 3)).reshape(n.shape[:2])
        with np.errstate(invalid="ignore"):
            points = radius[..., None] * n
        return np.where(np.isnan(points), 0.0, points)


def _masses(mobilities: np.ndarray, largest: float) -> np.ndarray:
    masses = np.full(mobilities.shape, np.inf)
    moving = mobilities > SINGULAR * max(float(largest), 0.0)
    masses[moving] = 1.0 / mobilities[moving]
    return masses
