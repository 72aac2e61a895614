"""Simulated trials of the paper's rig, measured as the paper measures them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.effects.catalogue.coulomb_friction import CoulombFriction
from spacerobot.simulation.events import contact_intervals
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import rig
from spacerobot.support.errors import SimulationError
from spacerobot.theory import contact_time, table1
from spacerobot.theory.coulomb_slider import equivalent_friction

AVERAGED_OVER = 1.0
"""The time over which velocities are averaged before and after the contact, s."""

MOCAP_RATE = 120.0
"""Positions are recorded at this rate, Hz."""

MOCAP_NOISE = 1.5e-4
"""One standard deviation of a recorded position, m."""

SPEED_SCATTER = 0.1
"""One standard deviation of the hand's speed from trial to trial, relative."""

TRIALS = 5
"""To a condition, as in the paper."""

_MARGIN = 0.05


@dataclass(frozen=True)
class Trial:
    """One simulated trial and what its recording says.

    Attributes:
        stiffness: k_w, N/m.
        target_mass: m_t, kg.
        speed: hand against target before the contact, m/s.
        friction: Coulomb friction in the guide, N.
        restitution: from velocities averaged over 1 s before and after.
        contact_time: first touch to last separation, s.
        touches: how often the surfaces met.
    """

    stiffness: float
    target_mass: float
    speed: float
    friction: float
    restitution: float
    contact_time: float
    touches: int


def campaign(seed: int, equivalent_damping: float) -> list[Trial]:
    """Five trials for each spring and target mass of Table 1, hand speeds scattered.

    The guide's friction is Coulomb friction of the size that c_eq stands for at the mean speed, F = pi c_eq v/4, in
    place of c_eq.

    Args:
        seed: of speeds and sensor noise.
        equivalent_damping: c_eq, N s/m.
    """
    random = np.random.default_rng(seed)
    trials = []
    for spring in table1.SPRINGS:
        friction = equivalent_friction(equivalent_damping, spring.hand_speed)
        for mass in table1.TARGET_MASSES:
            for _ in range(TRIALS):
                factor = float(np.clip(1.0 + SPEED_SCATTER * random.standard_normal(), 0.6, 1.4))
                trials.append(trial(spring, mass, spring.hand_speed * factor, friction, random))
    return trials


def trial(
    spring: table1.Spring, target_mass: float, speed: float, friction: float, random: np.random.Generator
) -> Trial:
    """Simulate one trial with the reduced backend and measure it.

    Seen from the hand, which moves on unhurried (the arm is locked to the ground): the target approaches at `speed`.

    Raises:
        SimulationError: the target does not come back.
    """
    mechanism = rig(
        {
            "wrist.mass": table1.WRIST_MASS,
            "wrist.stiffness": spring.stiffness,
            "wrist.damping": spring.damping,
            "contact.stiffness": table1.CONTACT_STIFFNESS,
            "contact.damping": table1.CONTACT_DAMPING,
            "target.mass": target_mass,
        }
    )
    if friction > 0:
        mechanism = CoulombFriction().apply(mechanism, "wrist", {"force_N": friction})
    lead = AVERAGED_OVER + 2 * _MARGIN
    reduced = table1.reduced(spring, table1.WRIST_MASS + target_mass, damping="wrist")
    expected = contact_time.displacement_zero(reduced)
    end = lead + 3.0 * expected + AVERAGED_OVER + 2 * _MARGIN
    run = simulate(
        mechanism,
        position={"target": -speed * lead},
        velocity={"target": speed},
        end=end,
        tolerance=1e-9,
        max_step=0.5,
    )
    touches = contact_intervals(run.events, False, 0.0, end)
    first, last = touches[0][0], touches[-1][1]
    if last + _MARGIN + AVERAGED_OVER > end:
        raise SimulationError(
            f"the target is still in touch {3.0 * expected:.3g} s after the first contact; "
            f"friction of {friction:.3g} N holds it at {speed:.3g} m/s"
        )
    before = _velocity(run, first - _MARGIN - AVERAGED_OVER, random)
    after = _velocity(run, last + _MARGIN, random)
    return Trial(spring.stiffness, target_mass, speed, friction, -after / before, last - first, len(touches))


def _velocity(run: ReducedRun, start: float, random: np.random.Generator) -> float:
    """Mean velocity of the recorded target over a second, m/s: the mean of the differences of its samples."""
    times = start + np.arange(round(AVERAGED_OVER * MOCAP_RATE) + 1) / MOCAP_RATE
    taken = run.sample(times)
    column = run.layout.coordinates.index("target")
    recorded = taken.position[:, column] + MOCAP_NOISE * random.standard_normal(times.size)
    return float(np.diff(recorded).mean() * MOCAP_RATE)
