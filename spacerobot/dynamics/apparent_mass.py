"""Apparent mass of an arm whose joints are held by servos: force over acceleration, as a function of
frequency.

    m_app(w) = 1/(-w^2 n^T J (-w^2 H + i w D + K)^-1 J^T n),  K = blkdiag(0_6, K_p), D alike.

w -> infinity gives the mass with joints free; w -> 0 the mass with joints locked for a free base, and
-K_tip/w^2 for a fixed one. Below the arm's own resonance a fixed arm is a spring, its apparent mass negative:
hence magnitude and phase.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.mobility import SINGULAR
from spacerobot.dynamics.operational import along
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.servo import HeldJoints, HoldsJoints, servo_or_its_numbers
from spacerobot.dynamics.terms import Terms, terms_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief, html_table
from spacerobot.support.tables import data_frame, data_set

if TYPE_CHECKING:
    import pandas
    import xarray

RESONANT = 1e-12
"""Smallest singular value of the scaled impedance below which an answer would be rounding error."""


@dataclass(frozen=True, eq=False, repr=False)
class ApparentMass(Brief):
    """Frequency response of a frame along one direction.

    Attributes:
        omega: shape (F,), [rad/s].
        mobility: shape (F,), complex acceleration per force [1/kg]; zero where below SINGULAR of the largest.
        free_mobility: with joints free, the limit w -> infinity [1/kg].
        locked_mobility: with joints locked, the limit w -> 0 [1/kg]; zero for a fixed base.
        tip_stiffness: static stiffness K_tip = 1/(n^T J K^-1 J^T n) [N/m]; zero where base, slider or a joint
            without stiffness lets the frame go, infinite where nothing can move it.
    """

    omega: np.ndarray
    mobility: np.ndarray
    free_mobility: float
    locked_mobility: float
    tip_stiffness: float

    @property
    def mass(self) -> np.ndarray:
        """Complex apparent mass [kg], shape (F,); infinite where the frame cannot move."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.mobility == 0.0, np.inf + 0.0j, 1.0 / self.mobility)

    @property
    def magnitude(self) -> np.ndarray:
        """|m_app| [kg], shape (F,)."""
        return np.abs(self.mass)

    @property
    def phase(self) -> np.ndarray:
        """Angle of m_app [rad], shape (F,): 0 acts as a mass, +-pi as a spring, -pi/2 as a damper."""
        return np.angle(self.mass)

    def _repr_html_(self) -> str:
        low, high = (float(f) / (2.0 * np.pi) for f in (self.omega.min(), self.omega.max()))
        rows = [
            ("apparent mass at the lowest frequency", float(self.magnitude[self.omega.argmin()]), "kg"),
            ("apparent mass at the highest frequency", float(self.magnitude[self.omega.argmax()]), "kg"),
            ("with joints locked", _mass(self.locked_mobility), "kg"),
            ("with joints free", _mass(self.free_mobility), "kg"),
            ("static stiffness at the tip", self.tip_stiffness, "N/m"),
        ]
        title = f"Apparent mass at {len(self.omega)} frequencies, {low:.4g} to {high:.4g} Hz"
        return html_table(title, rows, ("", "value", "unit"))

    def to_frame(self) -> pandas.DataFrame:
        """Magnitude and phase over frequency, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        return data_frame(
            {"magnitude": self.magnitude, "phase": self.phase},
            index=self.omega,
            name="omega",
            units={"omega": "rad/s", "magnitude": "kg", "phase": "rad"},
        )

    def to_xarray(self) -> xarray.Dataset:
        """Complex apparent mass and mobility over frequency, as a data set of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        variables = {"mass": ("omega", self.mass, "kg"), "mobility": ("omega", self.mobility, "1/kg")}
        return data_set(variables, {"omega": ("omega", self.omega, "rad/s")})


def _mass(mobility: float) -> float:
    """Of a mobility [1/kg]; infinite where it is zero [kg]."""
    return np.inf if mobility == 0.0 else 1.0 / mobility


def apparent_mass(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike,
    omega: ArrayLike,
    *,
    servo: HoldsJoints | None = None,
    stiffness: ArrayLike | None = None,
    damping: ArrayLike | None = None,
    frame: str | None = None,
    base: str | None = None,
    slider: str = "free",
) -> ApparentMass:
    """Frequency response of servo-held joints.

    Args:
        robot: the robot.
        pose: shape (len(chain),) [rad or m], or the whole configuration, shape (nq,).
        direction: shape (3,), unit vector in world axes.
        omega: shape (F,) or scalar, angular frequency [rad/s], positive.
        servo: K_p and D_p, as `Servo` has them.
        stiffness, damping: deprecated, of the servo.
        frame: frame name; the wrist mount if None.
        base: "fixed" or "free".
        slider: "free" or "locked".

    Raises:
        InputError: values out of range, or a frequency that is exactly an undamped resonance.
    """
    n = unit_directions(direction)
    held = servo_or_its_numbers(robot, servo, stiffness, damping)
    terms = terms_of(robot, pose, regime_of(robot, base, "servo", slider), frame)
    frequencies = np.atleast_1d(np.asarray(omega, dtype=float))
    rows = terms.jacobian[:3]
    response = np.array([_along(rows @ servo_response(terms, held, w, rows.T), n) for w in frequencies])
    limp = np.concatenate([terms.base, terms.slider]).astype(int)
    return ApparentMass(
        omega=frequencies,
        mobility=response,
        free_mobility=along(rows @ np.linalg.solve(terms.inertia, rows.T), n),
        locked_mobility=along(rows[:, limp] @ np.linalg.solve(terms.inertia[np.ix_(limp, limp)], rows[:, limp].T), n),
        tip_stiffness=_tip_stiffness(terms, held, rows.T @ n),
    )


def servo_response(terms: Terms, servo: HeldJoints, omega: float, force: np.ndarray) -> np.ndarray:
    """Complex accelerations (H - i D/w - K/w^2)^-1 f of the moving coordinates.

    Args:
        terms: H and J of what moves.
        servo: the joints' stiffness and damping.
        omega: [rad/s], positive.
        force: shape (n,) or (n, m), generalised force amplitudes.

    Raises:
        InputError: a frequency that is not positive and finite, or exactly an undamped resonance.
    """
    if not (np.isfinite(omega) and omega > 0.0):
        raise InputError("the frequency must be positive and finite", given=float(omega), valid="rad/s > 0")
    stiffness, damping = servo.impedance(terms)
    matrix = terms.inertia - np.diag(stiffness / omega**2 + 1j * damping / omega)
    size = np.sqrt(np.diag(terms.inertia) + stiffness / omega**2 + damping / omega)
    scaled = matrix / np.outer(size, size)
    if len(size) and np.linalg.svd(scaled, compute_uv=False)[-1] < RESONANT:
        raise InputError(
            "the frequency is an undamped resonance of the servo-held arm",
            given=f"{omega:g} rad/s",
            valid="another frequency, or servos with damping",
        )
    scale = size if force.ndim == 1 else size[:, None]
    return np.linalg.solve(scaled, force / scale) / scale


def _along(block: np.ndarray, n: np.ndarray) -> complex:
    value = complex(n @ block @ n)
    return value if abs(value) > SINGULAR * float(np.linalg.norm(block, 2)) else 0.0j


def _tip_stiffness(terms: Terms, servo: HeldJoints, row: np.ndarray) -> float:
    if np.any(row[terms.base] != 0.0) or np.any(row[terms.slider] != 0.0):
        return 0.0
    moved = row[terms.arm] != 0.0
    with np.errstate(divide="ignore"):
        compliance = float(np.sum(row[terms.arm][moved] ** 2 / servo.stiffness[moved]))
    return 1.0 / compliance if compliance > 0.0 else np.inf
