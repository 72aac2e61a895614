"""Four assumptions broken by degrees: frequency ratio, wrist mass, joint stiffness, point mass.

Each sweep lays a closed form (or the claim that nothing happens) over a solution that does not make the assumption:
Eqs. 2 to 4 solved exactly, or the reduced backend with an arm that gives way, or with a target that turns.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.effects.catalogue.arm_compliance import ArmCompliance
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.events import contact_intervals
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.theory import contact_time, frequencies, restitution, table1
from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.exact import solve
from spacerobot.theory.reduction import Reduced

Array = NDArray[np.float64]

ARM_MASS = 8.0
"""Of the arm where it gives way, seen at its hand, kg: the size of a PA10's."""


@dataclass(frozen=True)
class Sweep:
    """One assumption broken by degrees; costs against the reduced model, shape (n,) each.

    Attributes:
        number: of the assumption.
        x: its measure.
        x_label: what the measure is.
        at: the measure at the conditions of Table 1, (least, most), or None.
        y_label: what the cost is.
        expected: the closed form's cost.
        found: that of the solution without the assumption.
        condition: in words.
    """

    number: int
    x: Array
    x_label: str
    at: tuple[float, float] | None
    y_label: str
    expected: Array
    found: Array
    condition: str


def sweeps(equivalent_damping: float) -> tuple[Sweep, ...]:
    """All four, in the order of the assumptions."""
    return (
        point_mass(equivalent_damping),
        joint_stiffness(equivalent_damping),
        frequency_ratio(equivalent_damping),
        wrist_mass(equivalent_damping),
    )


def frequency_ratio(equivalent_damping: float) -> Sweep:
    """Contact time over omega_c/omega_w, the contact made softer and harder at one damping ratio."""
    spring, target = table1.SPRINGS[2], table1.TARGET_MASSES[1]
    base = table1.three_masses(spring, target, equivalent_damping=equivalent_damping)
    model = table1.reduced(spring, table1.WRIST_MASS + target, equivalent_damping=equivalent_damping)
    released = contact_time.force_zero(model)
    ratios, found, expected = np.geomspace(1.6, 40.0, 25), [], []
    for ratio in ratios:
        factor = (float(ratio) / frequencies.frequency_ratio(base)) ** 2
        system = ThreeMasses(
            base.hand_mass,
            base.wrist_mass,
            base.target_mass,
            base.wrist_stiffness,
            base.wrist_damping,
            base.contact_stiffness * factor,
            base.contact_damping * math.sqrt(factor),
        )
        found.append(solve(system, spring.hand_speed).contact_time / released - 1.0)
        expected.append(frequencies.separated(system).low / frequencies.exact(system).low - 1.0)
    all_ratios = [
        frequencies.frequency_ratio(table1.three_masses(s, m)) for s in table1.SPRINGS for m in table1.TARGET_MASSES
    ]
    return Sweep(
        5,
        ratios,
        "omega_c/omega_w",
        (min(all_ratios), max(all_ratios)),
        "contact time, relative change",
        np.array(expected),
        np.array(found),
        f"{spring.label}, {target:g} kg, contact spring varied",
    )


def wrist_mass(equivalent_damping: float) -> Sweep:
    """Restitution over m_w/m_t, m_w + m_t kept."""
    spring = table1.SPRINGS[1]
    lumped = table1.WRIST_MASS + table1.TARGET_MASSES[0]
    base = table1.three_masses(spring, table1.TARGET_MASSES[0], equivalent_damping=equivalent_damping)
    model = table1.reduced(spring, lumped, equivalent_damping=equivalent_damping)
    e = restitution.force_zero(model)
    ratios = np.geomspace(0.005, 0.4, 25)
    target = lumped / (1.0 + ratios)
    found = []
    for mass in target:
        system = ThreeMasses(
            base.hand_mass,
            lumped - float(mass),
            float(mass),
            base.wrist_stiffness,
            base.wrist_damping,
            base.contact_stiffness,
            base.contact_damping,
        )
        motion = solve(system, spring.hand_speed)
        found.append(-float(motion.state(motion.end)[5]) / spring.hand_speed - e)
    at = [table1.WRIST_MASS / m for m in table1.TARGET_MASSES]
    return Sweep(
        6,
        ratios,
        "m_w/m_t",
        (min(at), max(at)),
        "restitution, change",
        e * (target / lumped - 1.0),
        np.array(found),
        f"{spring.label}, m_w + m_t = {lumped:g} kg",
    )


def joint_stiffness(equivalent_damping: float) -> Sweep:
    """Contact time over the arm's stiffness at the hand, the arm a mass on a spring behind the wrist."""
    spring, target = table1.SPRINGS[3], table1.TARGET_MASSES[1]
    model = table1.reduced(spring, table1.WRIST_MASS + target, equivalent_damping=equivalent_damping)
    rigid = _rig(spring, target, equivalent_damping)
    base, _ = _hit(rigid, spring.hand_speed)
    ratios = np.geomspace(2.0, 300.0, 25)
    found = []
    for ratio in ratios:
        stiffness = float(ratio) * spring.stiffness
        values = {
            "mass_kg": ARM_MASS,
            "stiffness_N_m": stiffness,
            "damping_Ns_m": 0.1 * math.sqrt(stiffness * ARM_MASS),
        }
        time, _ = _hit(ArmCompliance().apply(rigid, "arm", values), spring.hand_speed)
        found.append(time / base - 1.0)
    series = np.array([contact_time.force_zero(_series(model, float(r))) for r in ratios])
    at = [1e5 / s.stiffness for s in table1.SPRINGS]
    return Sweep(
        3,
        ratios,
        "arm stiffness at the hand/k_w",
        (min(at), max(at)),
        "contact time, relative change",
        series / contact_time.force_zero(model) - 1.0,
        np.array(found),
        f"{spring.label}, {target:g} kg, arm of {ARM_MASS:g} kg",
    )


def point_mass(equivalent_damping: float) -> Sweep:
    """Restitution of the target's centre over the eccentricity of the hit, the target free to turn."""
    spring, target = table1.SPRINGS[1], table1.TARGET_MASSES[1]
    radius = 0.2
    _, central = _hit(_rig(spring, target, equivalent_damping), spring.hand_speed)
    ratios = np.linspace(0.02, 1.0, 25)
    found, expected = [], []
    e0 = restitution.force_zero(
        table1.reduced(spring, table1.WRIST_MASS + target, equivalent_damping=equivalent_damping)
    )
    for ratio in ratios:
        off_center = {
            "target.yaw_inertia": target * radius**2,
            "target.contact_point.lateral": float(ratio) * radius,
        }
        _, e = _hit(_rig(spring, target, equivalent_damping, off_center), spring.hand_speed)
        found.append(e - central)
        share = 1.0 / (1.0 + float(ratio) ** 2)
        eccentric = table1.reduced(spring, table1.WRIST_MASS + target * share, equivalent_damping=equivalent_damping)
        expected.append((1.0 + restitution.force_zero(eccentric)) * share - 1.0 - e0)
    return Sweep(
        1,
        ratios,
        "offset of the contact line/radius of gyration",
        None,
        "restitution of the centre, change",
        np.array(expected),
        np.array(found),
        f"{spring.label}, {target:g} kg, radius of gyration {radius:g} m, no friction at the point",
    )


def _series(model: Reduced, ratio: float) -> Reduced:
    return Reduced(model.mass, model.stiffness / (1.0 + 1.0 / ratio), model.damping)


def _rig(
    spring: table1.Spring, target: float, equivalent_damping: float, more: Mapping[str, float] | None = None
) -> Mechanism:
    values = {
        "wrist.mass": table1.WRIST_MASS,
        "wrist.stiffness": spring.stiffness,
        "wrist.damping": spring.damping,
        "wrist.equivalent_damping": equivalent_damping,
        "contact.stiffness": table1.CONTACT_STIFFNESS,
        "contact.damping": table1.CONTACT_DAMPING,
        "target.mass": target,
    }
    return rig({**values, **(more or {})})


def _hit(mechanism: Mechanism, speed: float) -> tuple[float, float]:
    """Contact time (first touch to last separation, s) and restitution of the target's centre."""
    end = 3.0
    run = simulate(mechanism, velocity={"target": speed}, end=end, tolerance=1e-9)
    last = contact_intervals(run.events, True, 0.0, end)[-1][1]
    velocity = run.sample(np.array([end])).velocity[0, run.layout.coordinates.index("target")]
    return last, -float(velocity) / speed
