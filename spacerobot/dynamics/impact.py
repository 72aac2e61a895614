"""An instantaneous impact between a frame of the robot and a rigid target, both free of other impulses."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.inertia import cholesky
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import Terms, terms_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief, html_table


def velocity_jump(terms: Terms, direction: np.ndarray) -> np.ndarray:
    """H^-1 J_v^T n: jump of the moving coordinates per unit impulse along n; shape (n,) [1/kg, 1/(kg m)]."""
    factor = cholesky(terms.inertia)
    return np.linalg.solve(factor.T, np.linalg.solve(factor, terms.jacobian[:3].T @ direction))


def base_reaction(terms: Terms, direction: np.ndarray) -> np.ndarray:
    """S_b H^-1 J^T n: velocity jump of the base per unit impulse along n at the frame.

    Returns:
        shape (6,), linear [1/kg] then angular [1/(kg m)], in the base frame at its origin as Pinocchio has
        it; zero for a fixed base.
    """
    if not len(terms.base):
        return np.zeros(6)
    return velocity_jump(terms, direction)[terms.base]


def target_mobility(mass: float, inertia: ArrayLike | None = None, lever: ArrayLike | None = None) -> np.ndarray:
    """Linear mobility of a free rigid body at a point: 1/m - [r]x I^-1 [r]x, shape (3, 3) [1/kg].

    Args:
        mass: [kg], positive.
        inertia: shape (3, 3), about the centre of mass, world axes [kg m^2]; None for a point mass.
        lever: shape (3,), from the centre of mass to the point, world axes [m]; zero if None.

    Raises:
        InputError: mass not positive, inertia not positive definite, a lever without an inertia.
    """
    if not (math.isfinite(mass) and mass > 0.0):
        raise InputError("the target's mass must be positive", given=mass)
    arm = np.zeros(3) if lever is None else np.asarray(lever, dtype=float)
    if arm.shape != (3,) or not np.isfinite(arm).all():
        raise InputError("the lever needs three finite components", given=arm.tolist())
    linear = np.eye(3) / mass
    if inertia is None:
        if np.any(arm):
            raise InputError("a contact off the target's centre of mass needs the target's inertia")
        return linear
    matrix = np.asarray(inertia, dtype=float)
    if matrix.shape != (3, 3) or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0.0):
        raise InputError("the target's inertia must be a symmetric 3x3 matrix", given=matrix.tolist())
    if not np.isfinite(matrix).all() or np.linalg.eigvalsh(matrix)[0] <= 0.0:
        raise InputError("the target's inertia must be positive definite", given=matrix.tolist())
    cross = np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
    return linear - cross @ np.linalg.solve(matrix, cross)


@dataclass(frozen=True, eq=False, repr=False)
class Impact(Brief):
    """What one frictionless impact does.

    Attributes:
        impulse_Ns: magnitude p of the impulse along the direction; the robot gets +p n, the target -p n.
        reduced_mass_kg: 1/(n^T (G_robot + G_target) n).
        approach_speed_m_s: speed of the target's point relative to the frame along n, before.
        restitution: separation speed over approach speed.
        target_mass_kg: mass of the target.
        velocity_jump: shape (nv,), jump of the robot's generalised velocity; zero where locked.
        base_velocity_jump: shape (6,), its base part, linear first, base frame; zero for a fixed base.
        frame_velocity_jump: shape (6,), linear first, world axes.
        target_linear_jump_m_s: shape (3,), jump of the target's centre of mass, world axes.
        target_angular_jump_rad_s: shape (3,), world axes; zero for a point mass.
    """

    impulse_Ns: float
    reduced_mass_kg: float
    approach_speed_m_s: float
    restitution: float
    target_mass_kg: float
    velocity_jump: np.ndarray
    base_velocity_jump: np.ndarray
    frame_velocity_jump: np.ndarray
    target_linear_jump_m_s: np.ndarray
    target_angular_jump_rad_s: np.ndarray

    def _repr_html_(self) -> str:
        rows = [
            ("impulse", self.impulse_Ns, "N s"),
            ("reduced mass", self.reduced_mass_kg, "kg"),
            ("approach speed", self.approach_speed_m_s, "m/s"),
            ("restitution", self.restitution, "1"),
            ("target's speed changes by", float(np.linalg.norm(self.target_linear_jump_m_s)), "m/s"),
            ("base's speed changes by", float(np.linalg.norm(self.base_velocity_jump[:3])), "m/s"),
            ("base's angular velocity changes by", float(np.linalg.norm(self.base_velocity_jump[3:])), "rad/s"),
        ]
        return html_table(f"Impact of {self.target_mass_kg:g} kg", rows, ("", "value", "unit"))


def impact(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike,
    *,
    approach_speed: float,
    restitution: float,
    target_mass: float,
    target_inertia: ArrayLike | None = None,
    target_lever: ArrayLike | None = None,
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
    slider: str = "free",
) -> Impact:
    """Impulse p = (1 + e) v / (n^T (G_robot + G_target) n), and every velocity jump that follows from it.

    Args:
        robot: the robot.
        pose: shape (len(chain),) [rad or m], or the whole configuration, shape (nq,).
        direction: shape (3,), unit vector along the target's approach, world axes.
        approach_speed: relative speed along the direction before [m/s], not negative.
        restitution: e, 0 to 1.
        target_mass: [kg].
        target_inertia: shape (3, 3), about the target's centre of mass, world axes [kg m^2]; None: point
            mass.
        target_lever: shape (3,), from that centre to the contact point, world axes [m].
        frame: where it hits; the wrist mount if None.
        base: "fixed" or "free".
        joints: "free" or "locked".
        slider: "free" or "locked".

    Raises:
        InputError: any value out of its range.
    """
    if not (math.isfinite(approach_speed) and approach_speed >= 0.0):
        raise InputError("the approach speed must not be negative", given=approach_speed)
    if not 0.0 <= restitution <= 1.0:
        raise InputError("restitution must lie between 0 and 1", given=restitution)
    if joints == "servo":
        raise InputError("servo joints act over time, not in an impact", valid="joints free or locked")
    n = unit_directions(direction)
    terms = terms_of(robot, pose, regime_of(robot, base, joints, slider), frame)
    of_target = target_mobility(target_mass, target_inertia, target_lever)
    jump = velocity_jump(terms, n) if len(terms.columns) else np.zeros(0)
    frame_jump = terms.jacobian @ jump if len(jump) else np.zeros(6)
    reduced = 1.0 / (float(n @ frame_jump[:3]) + float(n @ of_target @ n))
    impulse = (1.0 + restitution) * approach_speed * reduced
    whole = np.zeros(robot.model.nv)
    whole[terms.columns] = impulse * jump
    lever = np.zeros(3) if target_lever is None else np.asarray(target_lever, dtype=float)
    spin = np.zeros(3)
    if target_inertia is not None:
        spin = np.linalg.solve(np.asarray(target_inertia, dtype=float), np.cross(lever, -impulse * n))
    return Impact(
        impulse_Ns=impulse,
        reduced_mass_kg=reduced,
        approach_speed_m_s=approach_speed,
        restitution=restitution,
        target_mass_kg=target_mass,
        velocity_jump=whole,
        base_velocity_jump=impulse * jump[terms.base] if len(terms.base) else np.zeros(6),
        frame_velocity_jump=impulse * frame_jump,
        target_linear_jump_m_s=-impulse * n / target_mass,
        target_angular_jump_rad_s=spin,
    )


def matching_mass(target_mass: float, restitution: float) -> float:
    """Virtual mass m_v = m_t/e of a hand at rest that stops the target; infinite for e = 0.

    Raises:
        InputError: mass not positive, restitution outside 0 to 1.
    """
    if not (math.isfinite(target_mass) and target_mass > 0.0):
        raise InputError("the target's mass must be positive", given=target_mass)
    if not 0.0 <= restitution <= 1.0:
        raise InputError("restitution must lie between 0 and 1", given=restitution)
    return target_mass / restitution if restitution > 0.0 else math.inf


def target_speed_after(virtual_mass: float, target_mass: float, restitution: float, speed: float = 1.0) -> float:
    """Speed of a target that hit a hand at rest: v (m_t - e m_v)/(m_t + m_v); -e v for an infinite m_v."""
    if math.isinf(virtual_mass):
        return -restitution * speed
    return speed * (target_mass - restitution * virtual_mass) / (target_mass + virtual_mass)
