"""What the equations do at their edges: Eq. 5, the end of Eq. 14, M -> infinity, and the speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.dynamics.apparent_mass import ApparentMass, apparent_mass
from spacerobot.dynamics.contact_frequency import contact_frequency
from spacerobot.model.library import load
from spacerobot.simulation.parts import Servo
from spacerobot.theory import coulomb_slider, frequencies, reduction, response, restitution, table1
from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.exact import solve

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrequencyCheck:
    """Low branch over the contact stiffness, rad/s, for the case of `frequencies.PRINTED_CASE`.

    Attributes:
        contact_stiffness: k_c, N/m, shape (n,).
        exact: eigenfrequency of Eqs. 2 to 4, shape (n,).
        printed_reading: what Eq. 5 as printed is taken to give, shape (n,).
        limit: Eqs. 9 and 10.
        known: the one number known of the print, at the case's own k_c.
        exact_there: the exact one at that k_c.
    """

    contact_stiffness: Array
    exact: Array
    printed_reading: Array
    limit: float
    known: float
    exact_there: float


def frequency_check() -> FrequencyCheck:
    """Eq. 5 as printed against the exact frequencies."""
    case = frequencies.PRINTED_CASE
    stiffness = np.logspace(2.5, 7.5, 121)
    systems = [
        ThreeMasses(
            case.hand_mass, case.wrist_mass, case.target_mass, case.wrist_stiffness, case.wrist_damping, float(k)
        )
        for k in stiffness
    ]
    return FrequencyCheck(
        stiffness,
        np.array([frequencies.exact(s).low for s in systems]),
        np.array([frequencies.printed_reading(s).low for s in systems]),
        frequencies.separated(case).low,
        frequencies.PRINTED_LOW_BRANCH,
        frequencies.exact(case).low,
    )


@dataclass(frozen=True)
class PullCheck:
    """The force on the target in the softest, lightest condition, which pulls most. Arrays over time, shape (n,).

    Attributes:
        stiffness: k_w, N/m.
        target_mass: m_t, kg.
        time: s, to a little beyond the end of Eq. 14.
        simplified: k_w x + c x' of the reduced model, N; NaN after the end.
        exact: contact force of Eqs. 2 to 4, unilateral, N.
        adhesion: how long and how hard the end of Eq. 14 pulls.
    """

    stiffness: float
    target_mass: float
    time: Array
    simplified: Array
    exact: Array
    adhesion: response.Adhesion


def pull_check(equivalent_damping: float) -> PullCheck:
    """The adhesive force before the end of Eq. 14."""
    spring, target = table1.SPRINGS[0], table1.TARGET_MASSES[0]
    model = table1.reduced(spring, table1.WRIST_MASS + target, equivalent_damping=equivalent_damping)
    adhesion = response.adhesion(model, spring.hand_speed)
    time = np.linspace(0.0, 1.1 * adhesion.end, 1200)
    simplified = response.force(model, spring.hand_speed, time)
    simplified[time > adhesion.end] = np.nan
    system = table1.three_masses(spring, target, equivalent_damping=equivalent_damping)
    exact = solve(system, spring.hand_speed, duration=1.2 * adhesion.end).contact_force(time)
    return PullCheck(spring.stiffness, target, time, simplified, exact, adhesion)


@dataclass(frozen=True)
class HandMassCheck:
    """What a finite M does, at 530 N/m and 9.7 kg. Arrays over `hand_mass`, shape (n,).

    Attributes:
        hand_mass: M, kg.
        reduced_mass: m~ of Eq. 10, kg.
        lumped_mass: m_w + m_t, kg, to which it tends.
        time_simplified: relative distance of Eq. 16 from its value for a locked arm.
        time_exact: the same of the exact motion's contact time (bilateral, end of Eq. 14).
    """

    hand_mass: Array
    reduced_mass: Array
    lumped_mass: float
    time_simplified: Array
    time_exact: Array


def hand_mass_check() -> HandMassCheck:
    """M -> infinity against Eq. 10."""
    spring, target = table1.SPRINGS[0], table1.TARGET_MASSES[0]
    lumped = table1.WRIST_MASS + target
    masses = np.logspace(0.0, 6.0, 49)
    reduced = np.array([reduction.reduced_mass(float(m), lumped) for m in masses])

    def exact(hand_mass: float) -> float:
        system = table1.three_masses(spring, target, damping="wrist", hand_mass=hand_mass)
        return solve(system, spring.hand_speed, adhesive=True, stop="returned").end

    locked = exact(float("inf"))
    return HandMassCheck(
        masses,
        reduced,
        lumped,
        1.0 - np.sqrt(reduced / lumped),
        np.array([1.0 - exact(float(m)) / locked for m in masses]),
    )


@dataclass(frozen=True)
class ServoCheck:
    """The PA10-like arm on the ground, its joints held by servos ever stiffer. Arrays over `stiffness`, shape (n,).

    Attributes:
        stiffness: K_p of each joint, N m/rad.
        tip_stiffness: K_tip of the arm at the hand, N/m.
        mobility: Re 1/m_app at the contact's own frequency, 1/kg; negative where the arm acts as a spring.
        reduced_mass: m~ = 1/(1/m_app + 1/(m_w + m_t)), kg.
        lumped_mass: m_w + m_t, kg, to which it tends.
        expected: m~ over m_w + m_t, less one, from 1/m_app = -omega^2/K_tip.
        pose_deg: joint angles.
    """

    stiffness: Array
    tip_stiffness: Array
    mobility: Array
    reduced_mass: Array
    lumped_mass: float
    expected: Array
    pose_deg: tuple[float, ...]


def servo_check() -> ServoCheck:
    """Servo-held joints on the ground: 1/m_app -> 0 and m~ -> m_w + m_t as they stiffen, at 530 N/m and 9 kg."""
    spring, lumped = table1.SPRINGS[0], table1.WRIST_MASS + table1.TARGET_MASSES[0]
    robot, pose_deg = load("pa10_wrist"), (0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0)
    pose = np.radians(pose_deg)
    stiffness = np.logspace(4.0, 8.0, 33)
    tip, mobility, expected = [], [], []
    for k in stiffness:

        def response(omega: float, k: float = float(k)) -> ApparentMass:
            return apparent_mass(robot, pose, (1.0, 0.0, 0.0), omega, servo=Servo(k), base="fixed")

        def at(omega: float, response: Callable[[float], ApparentMass] = response) -> complex:
            return complex(response(omega).mobility[0])

        omega, _ = contact_frequency(at, spring.stiffness, lumped)
        found = response(omega)
        tip.append(found.tip_stiffness)
        mobility.append(float(found.mobility[0].real))
        expected.append(1.0 / (1.0 - lumped * omega**2 / found.tip_stiffness) - 1.0)
    reduced = 1.0 / (np.array(mobility) + 1.0 / lumped)
    return ServoCheck(stiffness, np.array(tip), np.array(mobility), reduced, lumped, np.array(expected), pose_deg)


@dataclass(frozen=True)
class SpeedCheck:
    """Restitution over the speed at 530 N/m and 9.7 kg. Arrays over `speed`, shape (n,).

    Attributes:
        speed: m/s.
        coulomb: with Coulomb friction F = pi c_eq v/4 of the mean speed, and c_w.
        coulomb_released: the same, ending where the force vanishes.
        constant: with the constant c_w + c_eq (Eq. 18).
        friction: F, N.
        smallest_speed: below which nothing comes back (c_w left out), m/s.
    """

    speed: Array
    coulomb: Array
    coulomb_released: Array
    constant: float
    friction: float
    smallest_speed: float


def speed_check(equivalent_damping: float) -> SpeedCheck:
    """A constant c_eq against the friction that it stands for."""
    spring, lumped = table1.SPRINGS[0], table1.WRIST_MASS + table1.TARGET_MASSES[0]
    model = table1.reduced(spring, lumped, equivalent_damping=equivalent_damping)
    friction = coulomb_slider.equivalent_friction(equivalent_damping, spring.hand_speed)
    speeds = np.linspace(0.01, 0.3, 146)

    def rebound(speed: float, end: coulomb_slider.End) -> float:
        return coulomb_slider.rebound(
            model.mass, model.stiffness, friction, speed, damping=spring.damping, end=end
        ).restitution

    return SpeedCheck(
        speeds,
        np.array([rebound(float(v), "displacement_zero") for v in speeds]),
        np.array([rebound(float(v), "force_zero") for v in speeds]),
        restitution.displacement_zero(model),
        friction,
        coulomb_slider.smallest_speed(model.mass, model.stiffness, friction),
    )
