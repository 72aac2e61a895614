"""Joint-space inertia with reflected rotor inertia, and the elimination of joints that no one holds."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


def joint_space_inertia(robot: Robot, configuration: np.ndarray) -> np.ndarray:
    """H(q) by the composite-rigid-body algorithm, armature on the diagonal.

    Args:
        robot: the robot.
        configuration: shape (nq,).

    Returns:
        shape (nv, nv), symmetric; units of the kinetic energy per velocity squared (kg, kg m, kg m^2).
    """
    nv = robot.model.nv
    return np.array(pin.crba(robot.model, robot.model.createData(), configuration)).reshape(nv, nv)


def cholesky(inertia: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor.

    Raises:
        InputError: not positive definite, as when a moving link has no mass.
    """
    try:
        return np.linalg.cholesky(inertia)
    except np.linalg.LinAlgError:
        raise InputError(
            "the joint-space inertia is not positive definite",
            valid="a mass and an inertia, or an armature, on every moving link",
        ) from None


def eliminate(
    inertia: np.ndarray, jacobian: np.ndarray, released: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take out coordinates on which no generalised force acts, by a Schur complement.

    With p the released coordinates and r the rest,

        H_c = H_rr - H_rp H_pp^-1 H_pr,    J_c = J_r - J_p H_pp^-1 H_pr,
        J H^-1 J^T = J_p H_pp^-1 J_p^T + J_c H_c^-1 J_c^T.

    For the base this is the generalized Jacobian of Umetani and Yoshida (1989); for the wrist slider it is
    what the hand feels of a slider that is carried along sideways but slides freely along its axis.

    Args:
        inertia: shape (n, n), positive definite.
        jacobian: shape (m, n).
        released: shape (k,), indices of p.

    Returns:
        H_c, shape (n-k, n-k); J_c, shape (m, n-k); J_p H_pp^-1 J_p^T, shape (m, m).
    """
    kept = np.delete(np.arange(inertia.shape[0]), released)  # setdiff1d loads numpy.ma
    factor = cholesky(inertia[np.ix_(released, released)])
    coupling = np.linalg.solve(factor, inertia[np.ix_(released, kept)])
    rows = np.linalg.solve(factor, jacobian[:, released].T)
    reduced = inertia[np.ix_(kept, kept)] - coupling.T @ coupling
    return 0.5 * (reduced + reduced.T), jacobian[:, kept] - rows.T @ coupling, rows.T @ rows
