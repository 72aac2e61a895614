"""A lab drawn from what labs have: nothing in it is a number of the rig that the diagnosis grew on."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.proof.draws import by_factors, to_digits
from spacerobot.proof.labs.lab import Instrument, Lab

APPROACHES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))

CAMERAS = (60.0, 100.0, 120.0, 200.0, 250.0, 400.0)
FORCES = (400.0, 1000.0, 2000.0, 5000.0)
"""Samples a second."""

BLIND = 0.25
"""Share of labs without a force sensor."""

UNSTATED = 0.5
"""Share of instruments whose noise the study leaves to be found."""

SURE = (0.4, 1.0)
"""How well values are believed to be known, as a share of what the air bed's lab states."""


def another_lab(rng: np.random.Generator, sigma: dict[str, float]) -> Lab:
    """A lab.

    Args:
        rng: where everything comes from.
        sigma: relative standard deviations of believed values, by dotted name, that it knows no worse than.
    """
    stiffness = to_digits(by_factors(rng, 150.0, 12000.0), 3)
    wrist = to_digits(by_factors(rng, 0.25, 3.0), 3)
    masses = sorted(to_digits(by_factors(rng, 4.0, 80.0), 3) for _ in range(int(rng.integers(1, 4))))
    critical = 2.0 * math.sqrt(stiffness * (wrist + masses[0]))
    slow = by_factors(rng, 0.02, 0.08)
    camera, force = by_factors(rng, 5e-5, 4e-4), by_factors(rng, 0.05, 0.6)
    return Lab(
        stiffness=stiffness,
        damping=to_digits(critical * by_factors(rng, 0.003, 0.02), 2),
        extra=to_digits(critical * by_factors(rng, 0.01, 0.06), 2),
        masses=tuple(dict.fromkeys(masses)),
        sigma={name: to_digits(value * by_factors(rng, *SURE), 2) for name, value in sigma.items()},
        speeds=(slow, slow * float(rng.uniform(1.8, 3.5))),
        wrist_mass=wrist,
        contact_stiffness=to_digits(by_factors(rng, 2e4, 3e5), 2),
        contact_damping=to_digits(by_factors(rng, 20.0, 150.0), 2),
        approach=APPROACHES[int(rng.integers(len(APPROACHES)))],
        camera=Instrument(float(rng.choice(CAMERAS)), camera, camera / 15.0, bool(rng.random() > UNSTATED)),
        force=None
        if rng.random() < BLIND
        else Instrument(float(rng.choice(FORCES)), force, force / 25.0, bool(rng.random() > UNSTATED)),
    )
