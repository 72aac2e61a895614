"""How well the arm can move and accelerate a frame, as one number (Yoshikawa 1985)."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.dynamics.split import MobilitySplit


def kinematic_manipulability(jacobian: np.ndarray) -> float:
    """sqrt(det(J J^T)) (Yoshikawa, IJRR 1985); zero at singular poses and for fewer joints than rows.

    Args:
        jacobian: shape (m, n).
    """
    return _root_determinant(jacobian)


def dynamic_manipulability(jacobian: np.ndarray, inertia: np.ndarray) -> float:
    """sqrt(det(J H^-1 H^-T J^T)) (Yoshikawa, J. Robotic Systems 1985): volume of accelerations per unit
    torque.

    Args:
        jacobian: shape (m, n).
        inertia: shape (n, n), joint-space inertia of the driven joints.

    Returns:
        units of acceleration per torque to the power m; zero at singular poses and for n < m.
    """
    if not inertia.size:
        return 0.0
    return _root_determinant(np.linalg.solve(inertia, jacobian.T).T)


def arm_manipulability(split: MobilitySplit) -> dict[str, float]:
    """Manipulabilities of the driven joints, with base and slider free to react (J*, H*).

    Returns:
        kinematic_linear, kinematic, dynamic_linear, dynamic; "linear" takes the three linear rows only.
    """
    return {
        "kinematic_linear": kinematic_manipulability(split.jacobian[:3]),
        "kinematic": kinematic_manipulability(split.jacobian),
        "dynamic_linear": dynamic_manipulability(split.jacobian[:3], split.inertia),
        "dynamic": dynamic_manipulability(split.jacobian, split.inertia),
    }


def _root_determinant(rows: np.ndarray) -> float:
    # The product of singular values never takes the root of a rounding error, as the determinant of A A^T
    # would.
    if rows.shape[1] < rows.shape[0]:
        return 0.0
    values = np.linalg.svd(rows, compute_uv=False)
    if values[-1] <= np.finfo(float).eps * max(rows.shape) * values[0]:
        return 0.0
    return math.prod(values.tolist())
