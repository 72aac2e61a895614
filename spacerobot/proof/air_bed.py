"""Air-bed campaigns: springs, masses, speeds and instruments as a lab would have them, drawn from a seed."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.proof.campaign import Belief, Campaign, Trial
from spacerobot.proof.engine.rig import Values
from spacerobot.proof.engine.sensors import Channel, Stream
from spacerobot.proof.labs.lab import Instrument, Lab

HEAD = {
    "robot": "pa10_wrist",
    "base": "fixed",
    "joints": "locked",
    "approach": [1, 0, 0],
    "gravity": [0, 0, 0],
}

SPRINGS = {530.0: 1.4, 1020.0: 2.1, 3600.0: 2.4, 5100.0: 2.7}
"""Spring [N/m] -> the damping that the lab measured with the guide taken off [N s/m]."""

MASSES = (9.0, 23.2, 51.0)
"""Targets [kg]; every mass is a condition of its own."""

SIGMA = {
    "wrist.stiffness": 0.01,
    "wrist.mass": 0.01,
    "wrist.equivalent_damping": 0.15,
    "contact.stiffness": 0.03,
    "target.mass": 0.002,
}

SCATTER = {"wrist.stiffness": 0.003}
"""The spring is remounted with the mass."""


def own_lab(rng: np.random.Generator, spring: float | None = None) -> Lab:
    """The lab of the PA10: one of its springs, drawn unless it is given [N/m]."""
    stiffness = float(rng.choice(list(SPRINGS))) if spring is None else spring
    extra = round(float(rng.uniform(4.0, 7.0)), 1)
    return Lab(stiffness, SPRINGS[stiffness], extra, MASSES, SIGMA)


def air_bed(
    rng: np.random.Generator,
    *,
    lab: Lab | None = None,
    per_mass: int = 4,
    spring: float | None = None,
    turning: bool = False,
    spinning: bool = False,
    hand_marker: bool = False,
) -> Campaign:
    """A campaign with nothing missing.

    Args:
        rng: where everything comes from.
        lab: whose; the PA10's if None.
        per_mass: trials with each target.
        spring: the PA10's lab's [N/m]; drawn if None.
        turning: a target that can turn, with its yaw recorded.
        spinning: that arrives turning, off its centre, and is followed sideways too.
        hand_marker: whether the hand is tracked.
    """
    lab = own_lab(rng, spring) if lab is None else lab
    believed, sigma = lab.believed, dict(lab.sigma)
    turning = turning or spinning
    if turning:
        believed["target.yaw_inertia"] = 0.45
        sigma["target.yaw_inertia"] = 0.02
    built = {n: v * (1.0 + sigma.get(n, 0.0) * rng.standard_normal()) for n, v in believed.items()}
    over = 1.0 + sigma["target.mass"] * rng.standard_normal()
    lateral = round(float(rng.choice([-1.0, 1.0]) * rng.uniform(0.01, 0.03)), 4) if spinning else 0.0
    trials: list[Trial] = []
    for mass in lab.masses:
        remounted = built["wrist.stiffness"] * (1.0 + SCATTER["wrist.stiffness"] * rng.standard_normal())
        for speed in rng.permutation(_speeds(rng, per_mass, *lab.speeds)):
            values = Values(
                wrist_mass=built["wrist.mass"],
                wrist_stiffness=remounted,
                wrist_damping=built["wrist.damping"] + built["wrist.equivalent_damping"],
                contact_stiffness=built["contact.stiffness"],
                contact_damping=lab.contact_damping,
                target_mass=mass * over,
                yaw_inertia=built.get("target.yaw_inertia", math.nan),
                ahead=0.15 if turning else 0.0,
                lateral=lateral,
                sideways=spinning,
            )
            gap = float(rng.uniform(0.02, 0.03))
            spin = float(rng.uniform(-0.3, 0.3)) if spinning else 0.0
            position, velocity = {"target": -gap}, {"target": float(speed)}
            if spinning:
                position["target.yaw"] = -spin * gap / float(speed)
                velocity["target.yaw"] = spin
                velocity["target.y"] = float(rng.normal(0.0, 0.002))
            contact = math.pi * math.sqrt((mass + lab.wrist_mass) / lab.stiffness)
            name = f"{len(trials) + 1:02d}"
            duration = round(gap / float(speed) + 1.4 * contact + 0.7, 2)
            trials.append(Trial(name, values, {"target.mass": mass}, position, velocity, duration))
    values_stated: dict[str, object] = dict(believed)
    if turning:
        values_stated["target.contact_point"] = [0.15, lateral]
    return Campaign(
        "Air-bed collisions",
        Belief({**HEAD, "approach": list(lab.approach)}, values_stated, sigma, SCATTER),
        {
            **built,
            "contact.damping": lab.contact_damping,
            "target.mass over believed": over,
            "target.contact_point.lateral": lateral,
        },
        tuple(trials),
        instruments(rng, lab, turning, spinning, hand_marker),
        seed=int(rng.integers(2**31)),
    )


def instruments(rng: np.random.Generator, lab: Lab, turning: bool, sideways: bool, hand: bool) -> tuple[Stream, ...]:
    """Motion capture and a force sensor, if there is one, with the nuisance of the day."""
    names = ["target.x", "wrist.x", *(["hand.x"] if hand else []), *(["target.y"] if sideways else [])]
    tracked = [_channel(name, lab.camera) for name in names]
    if turning:
        tracked.append(Channel("target.yaw", 5e-4, 1e-5))

    def nuisance() -> dict[str, float]:
        return {
            "coloured": float(rng.uniform(0.0, 0.05)),
            "memory": float(rng.uniform(0.5, 0.85)),
            "late": float(rng.normal(0.0, 5e-6)),
            "dropouts": float(rng.uniform(0.0, 0.6)),
        }

    found = [Stream("mocap", "mocap", lab.camera.rate, tuple(tracked), **nuisance())]
    if lab.force is not None:
        press = (_channel("contact.force", lab.force),)
        found.append(Stream("force", "force_sensor", lab.force.rate, press, **nuisance()))
    return tuple(found)


def _channel(name: str, by: Instrument) -> Channel:
    return Channel(name, by.sigma, by.quantum, by.stated)


def _speeds(rng: np.random.Generator, count: int, slow: float, fast: float) -> np.ndarray:
    """Speeds [m/s] set by hand: spread from slow to fast, each a little off."""
    nominal = np.geomspace(slow, fast, count)
    return nominal * np.exp(0.06 * rng.standard_normal(count))
