"""What each effect of the catalogue does to the MuJoCo rig: MuJoCo's own elements where it has them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from spacerobot.proof.engine import laws
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.engine.rig import STANDARD_GRAVITY, Joint, Level, Rig, Tendon
from spacerobot.support.errors import NotFoundError

Edit = Callable[[Rig, str, Mapping[str, float]], None]


def coulomb_friction(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """MuJoCo's friction loss; a torque at a joint that turns."""
    (level,) = p.values()
    rig.joints[where].friction += level


def stribeck_friction(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """MuJoCo's friction loss, its level set at every step."""
    static, coulomb, speed = p["static_force_N"], p["coulomb_force_N"], p["velocity_m_s"]

    def level(v: float, net: float, q: float, f: float) -> float:
        return coulomb + (static - coulomb) * math.exp(-((v / speed) ** 2))

    rig.levels[where] = level


def asymmetric_friction(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """MuJoCo's friction loss, its level set at every step from the direction of motion, or of the push at rest."""
    rig.levels[where] = two_levels(p["force_plus_N"], p["force_minus_N"])


def two_levels(forwards: float, backwards: float) -> Level:
    """A level for each direction of motion, or of the push at rest."""

    def level(v: float, net: float, q: float, f: float) -> float:
        way = v if abs(v) > 1e-5 else net
        return forwards if way > 0.0 else backwards

    return level


def viscous(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """MuJoCo's joint damping."""
    rig.joints[where].damping += p["coefficient_Ns_m"]


def quadratic(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """An explicit force -c |v| v."""
    i, c = rig.index[where], p["coefficient_Ns2_m2"]
    rig.laws.append(lambda q, v, t, f, out: _add(out, i, -c * abs(v[i]) * v[i]))


def cubic_stiffness(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """An explicit force -k3 d^3."""
    i, k3 = rig.index[where], p["k3_N_m3"]
    rig.laws.append(lambda q, v, t, f, out: _add(out, i, -k3 * q[i] ** 3))


def backlash(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """The joint's spring made a tendon with a dead band."""
    joint, gap = rig.joints[where], p["half_gap_m"]
    rig.tendons.append(Tendon(where, joint.stiffness, -gap, gap))
    joint.stiffness = 0.0


def end_stop(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A tendon with a dead band."""
    rig.tendons.append(Tendon(where, p["stiffness_N_m"], -p["travel_m"], p["travel_m"]))


def tether(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A tendon with a dead band."""
    rig.tendons.append(Tendon(where, p["stiffness_N_m"], -p["slack_m"], p["slack_m"]))


def preload(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A constant force, let go as the recording starts."""
    i, force = rig.index[where], p["force_N"]
    rig.laws.append(lambda q, v, t, f, out: _add(out, i, force))


def hertz_contact(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """The tip's law with an exponent."""
    rig.contact.exponent = p["exponent"]


def hunt_crossley(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """The tip's law with damping that grows with its force."""
    rig.contact.exponent, rig.contact.chi, rig.contact.damping = p["exponent"], p["chi_over_k_s_m"], 0.0


def adhesion(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A tip that holds on."""
    rig.contact.hold += p["force_N"]


def contact_friction(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """Friction across the tip."""
    rig.contact.mu = p["mu"]


def eccentric_contact(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """The contact point moved sideways."""
    rig.contact.lateral += p["offset_m"]


def arm_compliance(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A hand on a spring, the slider on the hand."""
    rig.add_hand(p["mass_kg"], p["stiffness_N_m"], p["damping_Ns_m"])


def table_tilt(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """MuJoCo's gravity, with slider and hand compensated."""
    rig.tilt += STANDARD_GRAVITY * math.sin(p["angle_rad"])


def hidden_oscillator(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """Part of the target's mass on a sliding joint inside it."""
    mass, omega = p["mass_kg"], 2.0 * math.pi * p["frequency_Hz"]
    rig.masses["target"] -= mass
    rig.masses["slosh"] = mass
    rig.joints["slosh"] = Joint(stiffness=mass * omega**2, damping=2.0 * p["damping_ratio"] * omega * mass)


def external_impulse(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A jump of the velocity."""
    rig.kicks.append((p["time_s"], where, p["impulse_Ns"]))


def payload(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """More mass."""
    rig.masses[where] += p["mass_kg"]


def magnus(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A force across the velocity of a spinning target."""
    at, c = rig.index, p["coefficient_kg"]
    x, y, yaw = at["target"], at["target.y"], at["target.yaw"]

    def law(q: list[float], v: list[float], t: float, f: float, out: list[float]) -> None:
        out[x] -= c * v[yaw] * v[y]
        out[y] += c * v[yaw] * v[x]

    rig.laws.append(law)


def _add(out: list[float], i: int, force: float) -> None:
    out[i] += force


EDITS: dict[str, Edit] = {
    "coulomb_friction": coulomb_friction,
    "stribeck_friction": stribeck_friction,
    "asymmetric_friction": asymmetric_friction,
    "viscous_friction": viscous,
    "viscous_drag": viscous,
    "quadratic_damping": quadratic,
    "quadratic_drag": quadratic,
    "cubic_stiffness": cubic_stiffness,
    "backlash": backlash,
    "end_stop": end_stop,
    "tether": tether,
    "preload": preload,
    "hertz_contact": hertz_contact,
    "hunt_crossley": hunt_crossley,
    "adhesion": adhesion,
    "contact_friction": contact_friction,
    "eccentric_contact": eccentric_contact,
    "arm_compliance": arm_compliance,
    "table_tilt": table_tilt,
    "hidden_oscillator": hidden_oscillator,
    "external_impulse": external_impulse,
    "payload": payload,
    "magnus": magnus,
    **OUTSIDERS,
    **laws.EDITS,
}
"""Name -> what it does to the rig; sensors' effects are in `sensors`."""

_LATE = ("backlash", "arm_compliance", "hidden_oscillator")
"""What changes joints goes first, so that laws find the final numbering."""


def apply(rig: Rig, missing: tuple[Missing, ...]) -> Rig:
    """The rig with the left-out physics in it, in place; what sensors do is skipped.

    Raises:
        NotFoundError: an effect that the rig does not know.
    """
    for item in sorted(missing, key=lambda m: m.effect not in _LATE):
        if item.at_sensor or not item.shows(rig.trial):
            continue
        if item.effect not in EDITS:
            raise NotFoundError("effect of the rig", item.effect, EDITS)
        EDITS[item.effect](rig, item.where, item.values)
    return rig


__all__ = ["EDITS", "Level", "apply"]
