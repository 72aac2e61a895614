"""How large a hidden effect is: for each, its numbers at a size s, where s = 1 is an ordinary one and 0 is none.

The number that says how much of it there is grows in proportion to s; the others are drawn once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spacerobot.proof.campaign import Campaign, Trial
from spacerobot.proof.engine.arm import arm_mass
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.whole.scene import BENDING
from spacerobot.support.errors import NotFoundError

Values = dict[str, float]


@dataclass(frozen=True)
class Kind:
    """A family of hidden effects that differ in size alone.

    Attributes:
        effect, where: its name and place.
        values: size -> parameters.
        largest: size beyond which it is no longer physical.
        trials: trials that show it; None for all.
        trend, form: as `Missing` has them.
    """

    effect: str
    where: str
    values: Callable[[float], Values]
    largest: float = 1e3
    trials: tuple[int, ...] | None = None
    trend: float = 0.0
    form: tuple[int, str] = (1, "butterworth")

    def at(self, size: float) -> Missing:
        """The effect of a size."""
        values = self.values(min(size, self.largest))
        return Missing(self.effect, self.where, values, self.trials, self.trend, self.form)


def peak_stroke(trial: Trial) -> float:
    """Deepest travel of the slider [m], from the damped spring that target and slider make together."""
    v = trial.values
    mass = v.wrist_mass + v.target_mass
    omega = math.sqrt(v.wrist_stiffness / mass)
    zeta = min(v.wrist_damping / (2.0 * mass * omega), 0.9)
    root = math.sqrt(1.0 - zeta**2)
    return trial.velocity["target"] / omega * math.exp(-zeta / root * math.acos(zeta))


def kind(effect: str, where: str, rng: np.random.Generator, campaign: Campaign) -> Kind:
    """The effect at a place, its further numbers drawn.

    Raises:
        NotFoundError: the rig cannot have it there.
    """
    key = (effect, where)
    if key in JOINTS:
        return Kind(effect, where, *_one("force_Nm", 0.05)(rng, campaign))
    if key not in DRAWS:
        raise NotFoundError("hidden effect", f"{effect} at {where}", [f"{e} at {w}" for e, w in DRAWS])
    values, largest = DRAWS[key](rng, campaign)
    return Kind(effect, where, values, largest)


Draw = Callable[[np.random.Generator, Campaign], tuple[Callable[[float], Values], float]]


def _one(name: str, unit: float, largest: float = 1e3, *, signed: bool = False) -> Draw:
    def draw(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
        sign = float(rng.choice([-1.0, 1.0])) if signed else 1.0
        return lambda s: {name: sign * unit * s}, largest

    return draw


def _stribeck(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    ratio, speed = float(rng.uniform(2.0, 3.5)), float(rng.uniform(0.01, 0.04))
    return lambda s: {
        "static_force_N": 0.2 * ratio * s,
        "coulomb_force_N": 0.2 * s,
        "velocity_m_s": speed,
    }, 20.0


def _asymmetric(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    ratio = math.exp(float(rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 0.6)))
    return lambda s: {"force_plus_N": 0.2 * ratio * s, "force_minus_N": 0.2 / ratio * s}, 20.0


def _cubic(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    deepest = max(peak_stroke(t) for t in campaign.trials)
    sign = float(rng.choice([-1.0, 1.0]))
    unit = 0.05 * campaign.as_built["wrist.stiffness"] / deepest**2
    return lambda s: {"k3_N_m3": sign * unit * s}, 8.0 if sign < 0.0 else 200.0


def _end_stop(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    deepest = max(peak_stroke(t) for t in campaign.trials)
    stiffness = float(10.0 ** rng.uniform(3.7, 5.0))
    return lambda s: {"travel_m": deepest * (1.0 - 0.05 * s), "stiffness_N_m": stiffness}, 14.0


def _compliance(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    mass, ratio = float(rng.uniform(10.0, 35.0)), float(rng.uniform(0.05, 0.15))
    if campaign.family == "servo arm":
        mass = arm_mass(floating=False)

    def values(s: float) -> Values:
        stiffness = 1e5 / s
        return {
            "mass_kg": mass,
            "stiffness_N_m": stiffness,
            "damping_Ns_m": 2.0 * ratio * math.sqrt(mass * stiffness),
        }

    return values, 20.0


def _hertz(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    return lambda s: {"exponent": 1.0 + 0.1 * s}, 12.0


def _hunt(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    return lambda s: {"exponent": 1.0 + 0.15 * s, "chi_over_k_s_m": 0.4 * s}, 8.0


def _tether(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    slack = float(rng.uniform(0.0, 0.015))
    return lambda s: {"stiffness_N_m": 0.5 * s, "slack_m": slack}, 200.0


def _slosh(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    frequency, ratio = float(math.exp(rng.uniform(0.2, 1.6))), float(rng.uniform(0.02, 0.1))
    lightest = min(t.values.target_mass for t in campaign.trials)
    return lambda s: {"mass_kg": 0.3 * s, "frequency_Hz": frequency, "damping_ratio": ratio}, 0.4 * lightest / 0.3


def _impulse(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    at = float(rng.uniform(0.3, 0.85)) * min(t.duration for t in campaign.trials)
    sign = float(rng.choice([-1.0, 1.0]))
    return lambda s: {"impulse_Ns": 0.01 * sign * s, "time_s": at}, 20.0


def _low_pass(cutoff: float) -> Draw:
    def draw(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
        return lambda s: {"cutoff_Hz": cutoff / s}, 100.0

    return draw


def _scale(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    sign = float(rng.choice([-1.0, 1.0]))
    return lambda s: {"factor": 1.0 + 0.01 * sign * s}, 50.0


def _magnetic(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    length = float(rng.uniform(0.003, 0.008))
    return lambda s: {"force_N": 0.1 * s, "length_m": length}, 30.0


def _warming(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    trials = float(rng.uniform(2.0, 5.0))
    return lambda s: {"share": 0.02 * s, "trials": trials}, 20.0


def _cable(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    frequency = float(rng.uniform(1.0, 4.0))
    return lambda s: {"force_N": 0.01 * s, "frequency_Hz": frequency}, 300.0


def _cogging(rng: np.random.Generator, campaign: Campaign) -> tuple[Callable[[float], Values], float]:
    pitch = float(rng.uniform(0.003, 0.008))
    return lambda s: {"force_N": 0.1 * s, "pitch_m": pitch}, 50.0


DRAWS: dict[tuple[str, str], Draw] = {
    ("coulomb_friction", "wrist"): _one("force_N", 0.15, 30.0),
    ("coulomb_friction", "target"): _one("force_N", 0.005, 20.0),
    ("stribeck_friction", "wrist"): _stribeck,
    ("asymmetric_friction", "wrist"): _asymmetric,
    ("viscous_friction", "wrist"): _one("coefficient_Ns_m", 2.0, 30.0),
    ("quadratic_damping", "wrist"): _one("coefficient_Ns2_m2", 20.0, 60.0),
    ("cubic_stiffness", "wrist"): _cubic,
    ("backlash", "wrist"): _one("half_gap_m", 1e-4, 50.0),
    ("end_stop", "wrist"): _end_stop,
    ("preload", "wrist"): _one("force_N", 0.1, 30.0, signed=True),
    ("hertz_contact", "contact"): _hertz,
    ("hunt_crossley", "contact"): _hunt,
    ("adhesion", "contact"): _one("force_N", 0.3, 40.0),
    ("contact_friction", "contact"): _one("mu", 0.05, 15.0),
    ("eccentric_contact", "target"): _one("offset_m", 0.002, 25.0, signed=True),
    ("arm_compliance", "arm"): _compliance,
    ("viscous_drag", "target"): _one("coefficient_Ns_m", 0.1, 50.0),
    ("quadratic_drag", "target"): _one("coefficient_Ns2_m2", 1.0, 60.0),
    ("table_tilt", "target"): _one("angle_rad", 3e-5, 50.0, signed=True),
    ("tether", "target"): _tether,
    ("hidden_oscillator", "target"): _slosh,
    ("external_impulse", "target"): _impulse,
    ("payload", "target"): _one("mass_kg", 0.1, 100.0),
    ("payload", "wrist"): _one("mass_kg", 0.02, 50.0),
    ("magnus", "target"): _one("coefficient_kg", 0.05, 60.0, signed=True),
    ("time_offset", "force_sensor"): _one("delay_s", 5e-4, 60.0),
    ("time_offset", "mocap"): _one("delay_s", 5e-4, 60.0),
    ("low_pass", "force_sensor"): _low_pass(300.0),
    ("low_pass", "mocap"): _low_pass(60.0),
    ("scale", "force_sensor"): _scale,
    ("scale", "mocap"): _scale,
    ("bias", "force_sensor"): _one("value", 0.05, 100.0, signed=True),
    ("bias", "mocap"): _one("value", 5e-5, 100.0, signed=True),
    ("sensor_inertia", "force_sensor"): _one("mass_kg", 0.02, 30.0),
    ("magnetic_pull", "contact"): _magnetic,
    ("one_sided_damping", "wrist"): _one("coefficient_Ns_m", 1.0, 60.0),
    ("warming_spring", "wrist"): _warming,
    ("periodic_cable", "target"): _cable,
    ("cogging", "wrist"): _cogging,
}
"""(effect, place) -> how its numbers are drawn. Delays are late ones: an early stream is the other one late."""

JOINTS = tuple(("coulomb_friction", f"joint.{name}") for name in BENDING)
"""Friction in the joints of a whole machine, whose motion shows it."""

TURNING = ("contact_friction", "eccentric_contact", "magnus")
"""Effects that only a target which turns can show."""


def places(*, turning: bool, outside: bool = False) -> list[tuple[str, str]]:
    """Effects and places that a rig can hide: of the catalogue, or those outside it."""
    return [key for key in DRAWS if (key[0] in OUTSIDERS) == outside and (turning or key[0] not in TURNING)]
