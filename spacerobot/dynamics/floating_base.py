"""How a free base moves when joints are driven: linear and angular momentum stay what they are.

With the centroidal momentum matrix A(q) (Orin, Goswami, Lee 2013, "Centroidal dynamics of a humanoid robot",
Autonomous Robots 35), h = A_b v_b + A_m q_m' is constant without external forces, so that

    v_b = A_b^-1 (h - A_m q_m'),

which is the generalized Jacobian's H_b v_b + H_bm q_m' = 0 (Umetani and Yoshida 1989) for a base that starts at rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spacerobot.support.errors import InputError, SimulationError

JointMotion = Callable[[float], tuple[np.ndarray, np.ndarray]]
"""Time [s] -> positions and velocities of all joints behind the free-flyer, shape (nv - 6,) each [rad or m]."""


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """A floating robot under prescribed joint motion. T times.

    Attributes:
        time: shape (T,) [s].
        configuration: shape (T, nq), free-flyer (x, y, z, quaternion xyzw) first.
        velocity: shape (T, nv), free-flyer first (linear, angular; base frame).
        momentum: shape (6,), linear, and angular about the centre of mass, world axes; constant.
    """

    time: np.ndarray
    configuration: np.ndarray
    velocity: np.ndarray
    momentum: np.ndarray


def floating_configuration(model: pin.Model, base: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """The configuration of a floating robot, shape (nq,): a joint that turns on and on takes two places in it.

    Args:
        model: first joint a free-flyer, every other joint with one velocity.
        base: shape (7,), position and quaternion (xyzw).
        positions: shape (nv - 6,) [rad or m].
    """
    q = pin.integrate(model, pin.neutral(model), np.concatenate([np.zeros(6), positions]))
    q[:7] = base
    return np.asarray(q)


def base_velocity(
    model: pin.Model, data: pin.Data, configuration: np.ndarray, joint_rates: np.ndarray, momentum: np.ndarray
) -> np.ndarray:
    """Free-flyer velocity that gives the robot its momentum.

    Args:
        model: first joint a free-flyer.
        data: of the model.
        configuration: shape (nq,).
        joint_rates: shape (nv - 6,) [rad/s or m/s].
        momentum: shape (6,), linear [kg m/s], and angular about the centre of mass [kg m^2/s], world axes.

    Returns:
        shape (6,), linear then angular, base frame.
    """
    matrix = pin.computeCentroidalMap(model, data, configuration)
    return np.asarray(np.linalg.solve(matrix[:, :6], momentum - matrix[:, 6:] @ joint_rates))


def base_motion(
    model: pin.Model,
    joint_motion: JointMotion,
    times: np.ndarray,
    *,
    base: np.ndarray | None = None,
    momentum: np.ndarray | None = None,
    knots: Sequence[float] = (),
    tolerance: float = 1e-10,
) -> BaseMotion:
    """Base motion from momentum conservation under prescribed joint motion.

    Args:
        model: first joint a free-flyer, every other joint with one velocity.
        joint_motion: positions and velocities of the other joints, in the model's order.
        times: ascending, shape (T,) [s]; the motion starts at the first.
        base: shape (7,), position and quaternion (xyzw) at the start; the world's origin, unturned, if None.
        momentum: shape (6,), linear, and angular about the centre of mass, world axes; zero if None.
        knots: times at which the joint motion is not smooth; the integration stops there [s].
        tolerance: relative and absolute, per step.

    Raises:
        InputError: another first joint, joints of other kinds, or arrays of the wrong shape.
    """
    if model.njoints < 2 or model.joints[1].nq != 7:
        raise InputError("the first joint is no free-flyer", given=model.names[1] if model.njoints > 1 else None)
    if any(joint.nv > 1 for joint in list(model.joints)[2:]):
        raise InputError("a joint has more than one velocity", valid="revolute, continuous and prismatic joints")
    times = np.asarray(times, dtype=float)
    if times.ndim != 1 or times.size < 2 or not (np.diff(times) > 0.0).all():
        raise InputError("times must ascend", given=times.shape)
    start = np.array([0.0, 0, 0, 0, 0, 0, 1]) if base is None else np.asarray(base, dtype=float)
    kept = np.zeros(6) if momentum is None else np.asarray(momentum, dtype=float)
    if start.shape != (7,) or kept.shape != (6,) or not (np.isfinite(start).all() and np.isfinite(kept).all()):
        raise InputError("the base needs 7 numbers and the momentum 6", given=(start.shape, kept.shape))
    norm = float(np.linalg.norm(start[3:]))
    if abs(norm - 1.0) > 1e-6:
        raise InputError("the base attitude is not a unit quaternion", given=f"norm {norm:.9g}")
    stops = np.unique(np.asarray(knots, dtype=float))  # in order, each once
    if not np.isfinite(stops).all():
        raise InputError("a knot is no time", given=stops[~np.isfinite(stops)][0])
    positions, rates = joint_motion(float(times[0]))
    if np.shape(positions) != (model.nv - 6,) or np.shape(rates) != (model.nv - 6,):
        raise InputError("joint motion has the wrong length", given=np.shape(positions), valid=f"({model.nv - 6},)")
    return _integrated(model, joint_motion, times, start, kept, stops, tolerance)


def _integrated(
    model: pin.Model,
    joint_motion: JointMotion,
    times: np.ndarray,
    start: np.ndarray,
    momentum: np.ndarray,
    knots: np.ndarray,
    tolerance: float,
) -> BaseMotion:
    from scipy.integrate import solve_ivp

    data = model.createData()

    def configuration(t: float, base: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        positions, rates = joint_motion(t)
        q = floating_configuration(model, base, positions)
        q[3:7] /= np.linalg.norm(q[3:7])
        return q, rates

    def rate(t: float, base: np.ndarray) -> np.ndarray:
        q, rates = configuration(t, base)
        v = base_velocity(model, data, q, rates, momentum)
        turn = pin.Quaternion(q[6], q[3], q[4], q[5])
        spin = turn * pin.Quaternion(0.0, *(0.5 * v[3:6]))
        return np.concatenate([turn.toRotationMatrix() @ v[:3], spin.coeffs()])

    close = 1e-9 * (times[-1] - times[0])  # a step between two knots that are one but for rounding cannot be taken
    stops: list[float] = []
    for knot in knots.tolist():
        if (stops[-1] if stops else times[0]) + close < knot < times[-1] - close:
            stops.append(knot)
    q_out, v_out = np.empty((times.size, model.nq)), np.empty((times.size, model.nv))
    y = start.copy()
    for a, b in zip([times[0], *stops], [*stops, times[-1]], strict=True):
        inside = (times >= a) & (times < b) if b < times[-1] else (times >= a)
        at = np.append(times[inside], b) if b < times[-1] else times[inside]
        result = solve_ivp(rate, (a, b), y, method="DOP853", t_eval=at, rtol=tolerance, atol=tolerance)
        if not result.success:
            raise SimulationError(f"the base's motion cannot be integrated from {a:g} s on: {result.message}")
        for row, t, base in zip(np.flatnonzero(inside), at, result.y.T, strict=False):
            q, rates = configuration(float(t), base)
            q_out[row] = q
            v_out[row] = np.concatenate([base_velocity(model, data, q, rates, momentum), rates])
        y = result.y[:, -1]
        y[3:7] /= np.linalg.norm(y[3:7])
    return BaseMotion(times, q_out, v_out, momentum)
