"""The front door: effective mass at one pose, frame and direction, and all that goes with it."""

from __future__ import annotations

import cmath
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.apparent_mass import servo_response
from spacerobot.dynamics.contact_frequency import contact_frequency
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.ellipsoid import BeltedEllipsoid
from spacerobot.dynamics.impact import base_reaction
from spacerobot.dynamics.manipulability import arm_manipulability
from spacerobot.dynamics.mobility import SINGULAR, by_inverse
from spacerobot.dynamics.operational import along, operational_inertia, rank, reciprocal
from spacerobot.dynamics.pose_limits import PoseLimitWarning, pose_limit_warnings
from spacerobot.dynamics.regime import Regime, regime_of
from spacerobot.dynamics.servo import HoldsJoints, servo_or_its_numbers
from spacerobot.dynamics.split import MobilitySplit, split_mobility
from spacerobot.dynamics.terms import Terms, checked_configuration, terms_of
from spacerobot.model.describe import held_words
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import html_table


@dataclass(frozen=True, eq=False, repr=False)
class EffectiveMass:
    """Effective mass at one pose, frame and direction; world axes, SI.

    Attributes:
        robot: name of the robot.
        frame: where it is felt.
        q_rad: shape (len(chain),), joint positions [rad or m].
        direction: shape (3,), unit vector.
        base: "fixed" or "free".
        joints: "free", "locked" or "servo".
        slider: "free", "locked", or None for a robot without a wrist.
        effective_mass_kg: 1/(n^T G_v n); infinite where the frame cannot move along n; the magnitude for
            servo joints.
        phase_rad: angle of the apparent mass, zero except for servo joints (+-pi: acts as a spring).
        rotational_inertia_kg_m2: the same for a moment about n, 1/(n^T G_w n).
        mobility: shape (6, 6), G = J H^-1 J^T, linear first; complex for servo joints.
        lambda_linear: shape (3, 3), (J_v H^-1 J_v^T)^-1, or None where singular; not a block of
            `lambda_spatial`.
        lambda_spatial: shape (6, 6), (J H^-1 J^T)^-1, or None where singular.
        ellipsoid: belted ellipsoid of the linear mobility; None for servo joints.
        split: mobility with joints free, taken apart into slider, base and arm.
        base_velocity_per_impulse: shape (6,), velocity jump of the base per unit impulse along n, linear
            [1/kg] first, base frame; of free joints where they are servo-held, since an impulse outruns a
            servo.
        manipulability: kinematic and dynamic, of the driven joints with the base free to react.
        omega_rad_s: frequency of the apparent mass, or None.
        notes: what a reader should know about the numbers.
        warnings: what may be wrong with the request (a pose outside the limits).
    """

    robot: str
    frame: str
    q_rad: np.ndarray
    direction: np.ndarray
    base: str
    joints: str
    slider: str | None
    effective_mass_kg: float
    phase_rad: float
    rotational_inertia_kg_m2: float
    mobility: np.ndarray
    lambda_linear: np.ndarray | None
    lambda_spatial: np.ndarray | None
    ellipsoid: BeltedEllipsoid | None
    split: MobilitySplit
    base_velocity_per_impulse: np.ndarray
    manipulability: dict[str, float]
    omega_rad_s: float | None
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        along = ", ".join(f"{x:.4g}" for x in self.direction)
        return (
            f"EffectiveMass({self.effective_mass_kg:.6g} kg at {self.robot}:{self.frame} along ({along}), "
            f"base {self.base}, joints {self.joints})"
        )

    def _repr_html_(self) -> str:
        along = ", ".join(f"{x:.4g}" for x in self.direction)
        rows: list[tuple[str, Any, str]] = [
            ("effective mass", self.effective_mass_kg, "kg"),
            ("rotational inertia", self.rotational_inertia_kg_m2, "kg m²"),
        ]
        if self.omega_rad_s is not None:
            rows += [("phase", self.phase_rad, "rad"), ("at", self.omega_rad_s, "rad/s")]
        rows += [(f"mobility of the {name}", value, "1/kg") for name, value in self.share().items() if name != "free"]
        title = f"{self.robot}: {self.frame} along ({along}), base {self.base}, joints {self.joints}"
        return html_table(title, rows, ("", "value", "unit"), (*self.notes, *self.warnings))

    @property
    def mobility_per_kg(self) -> float:
        """1/effective mass [1/kg]; zero where it is infinite."""
        return 0.0 if math.isinf(self.effective_mass_kg) else 1.0 / self.effective_mass_kg

    @property
    def apparent_mass_kg(self) -> complex:
        """Magnitude and phase as one complex number [kg]."""
        return cmath.rect(self.effective_mass_kg, self.phase_rad)

    def share(self) -> dict[str, float]:
        """n^T G_v n with joints free, taken apart: slider, base, arm, and their sum "free" [1/kg]."""
        parts = {"slider": self.split.slider, "base": self.split.base, "arm": self.split.arm}
        parts["free"] = self.split.free
        return {name: float(self.direction @ part[:3, :3] @ self.direction) for name, part in parts.items()}


def effective_mass(
    robot: Robot,
    pose: ArrayLike | None = None,
    direction: ArrayLike = (1.0, 0.0, 0.0),
    *,
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
    slider: str = "free",
    others: dict[str, float] | None = None,
    configuration: ArrayLike | None = None,
    servo: HoldsJoints | None = None,
    stiffness: ArrayLike | None = None,
    damping: ArrayLike | None = None,
    omega: float | None = None,
    wrist_stiffness: float | None = None,
    target_mass: float | None = None,
) -> EffectiveMass:
    """Effective mass 1/(n^T J_v H^-1 J_v^T n) (Khatib, IJRR 1995), reflected rotor inertia included.

    A free wrist slider is carried along sideways and slides along its axis: at the hand H is replaced by its
    Schur complement, and at a frame beyond the slider the mass along its axis is the slider's alone.

    Args:
        robot: the robot.
        pose: shape (len(chain),), joint positions from base to tip [rad or m]; neutral if None. Or the whole
            configuration, shape (nq,).
        direction: shape (3,), unit vector in world axes.
        frame: frame name; the wrist mount (or the arm's tip) if None.
        base: "fixed" or "free"; free where the robot floats if None.
        joints: "free", "locked", or "servo" (held by `servo`).
        slider: "free" or "locked", of the wrist.
        others: positions of joints outside the chain by name (fingers, the slider); they are locked, the
            slider not.
        configuration: shape (nq,), the whole configuration instead of `pose` and `others`.
        servo: what holds servo joints.
        stiffness, damping: deprecated, of the servo.
        omega: frequency of servo joints [rad/s]; sqrt(k_w/m~) from the next two if None.
        wrist_stiffness: k_w [N/m], for that frequency.
        target_mass: m_t [kg], for that frequency.

    Raises:
        InputError: values out of range, or servo joints without a frequency.
        NotFoundError: no such frame or joint.
    """
    n = unit_directions(direction)
    if n.shape != (3,):
        raise InputError("one direction at a time", given=n.shape, valid="effective_mass_batch takes several")
    regime = regime_of(robot, base, joints, slider)
    if configuration is None:
        given = None if pose is None else _numeric(pose, "pose")
        whole = given is not None and given.shape == (robot.model.nq,) != (len(robot.chain),)
        if whole and others:
            raise InputError("a whole configuration says where the others are too", given=f"others {others}")
        q = given if given is not None and whole else robot.configuration(given, others=others)
    elif pose is not None or others:
        raise InputError("give a pose or a whole configuration, not both")
    else:
        q = _numeric(configuration, "configuration")
    q = checked_configuration(robot, q)
    if joints != "servo" and not all(v is None for v in (servo, stiffness, damping, omega)):
        raise InputError("a servo and a frequency need servo joints", given=f"joints {joints}", valid='joints="servo"')

    outside = pose_limit_warnings(robot, q)
    for text in outside:
        warnings.warn(text, PoseLimitWarning, stacklevel=2)
    notes: list[str] = []
    released = terms_of(robot, q, Regime(regime.base, "free", regime.slider), frame)
    split = split_mobility(released)
    terms = released if joints != "locked" else terms_of(robot, q, regime, frame)
    if joints == "servo":
        held = servo_or_its_numbers(robot, servo, stiffness, damping)

        def response(w: float) -> np.ndarray:
            return terms.jacobian @ servo_response(terms, held, w, terms.jacobian.T)

        if omega is None:
            omega, text = _default_frequency(terms, n, response, wrist_stiffness, target_mass)
            notes.append(text)
        else:
            notes.append(f"servo joints: apparent mass at {_frequency(omega)}, as given")
        mobility = response(omega)
        mass, phase = _complex_mass(mobility[:3, :3], n)
        turning, _ = _complex_mass(mobility[3:, 3:], n)
        if abs(phase) > 0.5 * math.pi:
            notes.append("below the arm's resonance the frame acts as a spring: the apparent mass is negative")
    else:
        mobility = by_inverse(terms)
        mass, phase = reciprocal(along(mobility[:3, :3], n)), 0.0
        turning = reciprocal(along(mobility[3:, 3:], n))
    notes += _infinity_notes(regime, mobility, mass, turning)
    if joints != "locked" and (words := held_words(robot)):
        notes.append(words)
    return EffectiveMass(
        robot=robot.name,
        frame=frame or robot.tip,
        q_rad=_chain_positions(robot, q),
        direction=n,
        base=regime.base,
        joints=joints,
        slider=regime.slider if robot.slider is not None else None,
        effective_mass_kg=mass,
        phase_rad=phase,
        rotational_inertia_kg_m2=turning,
        mobility=mobility,
        lambda_linear=operational_inertia(mobility[:3, :3]),
        lambda_spatial=operational_inertia(mobility),
        ellipsoid=None if joints == "servo" else BeltedEllipsoid(mobility[:3, :3]),
        split=split,
        base_velocity_per_impulse=base_reaction(terms, n),
        manipulability=arm_manipulability(split),
        omega_rad_s=omega,
        notes=tuple(notes),
        warnings=outside,
    )


def _numeric(values: ArrayLike, what: str) -> np.ndarray:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{what} is not a list of numbers", given=values) from None


def _default_frequency(
    terms: Terms,
    n: np.ndarray,
    response: Callable[[float], np.ndarray],
    wrist_stiffness: float | None,
    target_mass: float | None,
) -> tuple[float, str]:
    """sqrt(k_w/m~) and a sentence that says so."""
    if wrist_stiffness is None or target_mass is None:
        raise InputError(
            "servo joints show an apparent mass that depends on frequency",
            valid="a frequency, or wrist stiffness and target mass for sqrt(k_w/m~)",
        )
    moved = float(terms.inertia[terms.slider[0], terms.slider[0]]) if len(terms.slider) else 0.0
    omega, settled = contact_frequency(
        lambda w: complex(n @ response(w)[:3, :3] @ n), wrist_stiffness, moved + target_mass
    )
    text = f"servo joints: apparent mass at the contact's own frequency sqrt(k_w/m~) = {_frequency(omega)}"
    return omega, text if settled else text + " of a locked arm (a resonance of the arm is near)"


def _frequency(omega: float) -> str:
    return f"{omega:.6g} rad/s ({omega / (2.0 * math.pi):.6g} Hz)"


def _complex_mass(block: np.ndarray, n: np.ndarray) -> tuple[float, float]:
    value = complex(n @ block @ n)
    if abs(value) <= SINGULAR * float(np.linalg.norm(block, 2)):
        return math.inf, 0.0
    return 1.0 / abs(value), -cmath.phase(value)


def _infinity_notes(regime: Regime, mobility: np.ndarray, mass: float, turning: float) -> list[str]:
    """Why a mass is infinite or an inertia does not exist."""
    if not np.any(mobility):
        return [f"nothing can move: base {regime.base}, joints {regime.joints}; every effective mass is infinite"]
    notes = []
    singular = f"(mobility below {SINGULAR:g} of the largest)"
    if math.isinf(mass):
        notes.append(f"the frame cannot move along the direction {singular}: the effective mass is infinite")
    if math.isinf(turning):
        notes.append(f"the frame cannot turn about the direction {singular}: the rotational inertia is infinite")
    linear, spatial = rank(mobility[:3, :3]), rank(mobility)
    if linear < 3:
        notes.append(f"the frame moves in {linear} of 3 directions here: Lambda (3x3) does not exist")
    if spatial < 6:
        notes.append(f"the frame has {spatial} of 6 degrees of freedom here: Lambda (6x6) does not exist")
    return notes


def _chain_positions(robot: Robot, configuration: np.ndarray) -> np.ndarray:
    values = []
    for name in robot.chain:
        joint = robot.model.joints[robot.joint_id(name)]
        q = configuration[joint.idx_q : joint.idx_q + joint.nq]
        values.append(float(q[0]) if joint.nq == 1 else math.atan2(q[1], q[0]))
    return np.array(values)
