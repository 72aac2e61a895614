"""Eqs. 2 to 4 solved exactly: against an independent integrator, conservation laws and limits."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.theory import equations_of_motion, table1
from spacerobot.theory.exact import Motion, solve

SOFT = table1.three_masses(table1.SPRINGS[0], 9.0, damping="wrist")
STIFF = table1.three_masses(table1.SPRINGS[3], 51.0)
SMALL = dataclasses.replace(SOFT, hand_mass=8.0)


def integrate(system: equations_of_motion.ThreeMasses, speed: float, end: float, times: np.ndarray) -> np.ndarray:
    """Bilateral motion without friction by DOP853, equations written out anew; shape (n, 6)."""
    mobility = 1 / system.hand_mass

    def field(t: float, y: np.ndarray) -> list[float]:
        xh, xw, xt, vh, vw, vt = y
        wrist = system.wrist_stiffness * (xw - xh) + system.wrist_damping * (vw - vh)
        contact = system.contact_stiffness * (xt - xw) + system.contact_damping * (vt - vw)
        return [
            vh,
            vw,
            vt,
            wrist * mobility,
            (contact - wrist) / system.wrist_mass,
            -contact / system.target_mass,
        ]

    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-15, "t_eval": times}
    return solve_ivp(field, (0, end), [0, 0, 0, 0, 0, speed], **options).y.T


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference over the largest value, channel by channel that moves."""
    peak = np.abs(b).max(axis=0)
    moving = peak > 1e-6 * peak.max()
    return float((np.abs(a - b).max(axis=0)[moving] / peak[moving]).max())


@pytest.mark.parametrize("system", [SOFT, STIFF, SMALL], ids=["soft", "stiff", "free hand"])
def test_bilateral_agrees_with_integration(system: equations_of_motion.ThreeMasses) -> None:
    motion = solve(system, 0.1, adhesive=True, stop="returned")
    times = np.linspace(0, motion.end, 200)
    assert difference(motion.state(times), integrate(system, 0.1, motion.end, times)) < 1e-8


def test_another_stiffness_would_be_caught() -> None:
    motion = solve(SOFT, 0.1, adhesive=True, stop="returned")
    times = np.linspace(0, motion.end, 50)
    wrong = dataclasses.replace(SOFT, contact_stiffness=SOFT.contact_stiffness * (1 + 1e-5))
    assert difference(motion.state(times), integrate(wrong, 0.1, motion.end, times)) > 1e-8


@pytest.mark.parametrize("system", [SOFT, STIFF, SMALL], ids=["soft", "stiff", "free hand"])
def test_first_contact_ends_where_the_integrated_force_vanishes(
    system: equations_of_motion.ThreeMasses,
) -> None:
    motion = solve(system, 0.1, stop="release")
    assert motion.first_release == motion.end
    times = np.linspace(0, motion.end, 50)
    reference = integrate(system, 0.1, motion.end, times)
    assert difference(motion.state(times), reference) < 1e-8
    force = reference @ system.contact_force
    assert abs(force[-1]) < 1e-8 * force.max()
    assert (force[1:-1] > 0).all()


def regularised(system: equations_of_motion.ThreeMasses, speed: float, end: float) -> np.ndarray:
    """Final state of the unilateral motion with friction, by small steps and a steep tanh; shape (6,)."""
    step, width = 2e-6, 1e-7
    y = np.array([0, 0, 0, 0, 0, speed])
    masses = np.array([1 / system.hand_mass, 1 / system.wrist_mass, 1 / system.target_mass])
    k, c, kc, cc = (
        system.wrist_stiffness,
        system.wrist_damping,
        system.contact_stiffness,
        system.contact_damping,
    )
    for _ in range(round(end / step)):
        for share in (0.5, 0.5):  # symplectic Euler twice per step
            d, rate = y[2] - y[1], y[5] - y[4]
            contact = max(0.0, kc * d + cc * rate) if d > 0 else 0.0
            slide = y[4] - y[3]
            wrist = k * (y[1] - y[0]) + c * slide + system.guide_friction * max(-1.0, min(1.0, slide / width / 300))
            y[3:] += share * step * masses * np.array([wrist, contact - wrist, -contact])
            y[:3] += share * step * y[3:]
    return y


def test_unilateral_with_friction_against_small_steps() -> None:
    system = dataclasses.replace(SMALL, guide_friction=0.8)
    motion = solve(system, 0.1, duration=0.4)
    kinds = {e.kind for e in motion.events}
    assert {"touch", "release", "slip", "stick", "reverse"} <= kinds
    assert np.abs(motion.state(0.4)[3:] - regularised(system, 0.1, 0.4)[3:]).max() < 2e-5


@pytest.mark.parametrize("hand_mass", [3.0, 100.0])
def test_momentum_is_kept_through_all_events(hand_mass: float) -> None:
    system = dataclasses.replace(SMALL, hand_mass=hand_mass, guide_friction=0.3)
    motion = solve(system, 0.1, hand_velocity=-0.05)
    masses = np.array([hand_mass, system.wrist_mass, system.target_mass])
    momentum = motion.state(np.linspace(0, motion.end, 300))[:, 3:] @ masses
    assert len(motion.events) > 3
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * masses.max() * 0.1


def test_energy_is_kept_without_damping_and_only_falls_with_it() -> None:
    free = dataclasses.replace(SMALL, wrist_damping=0.0, contact_damping=0.0)
    motion = solve(free, 0.1)
    assert len(motion.times_of("touch")) > 2, "the wrist rattles on the target"
    energy = energy_of(motion)
    assert np.abs(energy - energy[0]).max() < 1e-11 * energy[0]
    lossy = energy_of(solve(dataclasses.replace(SMALL, guide_friction=0.2), 0.1))
    assert (np.diff(lossy) < 1e-12 * lossy[0]).all()
    assert lossy[-1] < 0.9 * lossy[0]


def energy_of(motion: Motion) -> np.ndarray:
    times = np.linspace(0, motion.end, 400)
    states = motion.state(times)
    held = np.array([any(s.touching and s.start <= t <= s.end for s in motion.segments) for t in times])
    return motion.system.energy(states, held)


def test_a_locked_hand_is_the_limit_of_a_heavy_one() -> None:
    locked = solve(dataclasses.replace(SOFT, hand_mass=math.inf), 0.1, adhesive=True, stop="returned")
    gaps = []
    for mass in (1e3, 1e4, 1e5):
        heavy = solve(dataclasses.replace(SOFT, hand_mass=mass), 0.1, adhesive=True, stop="returned")
        gaps.append(abs(heavy.end - locked.end) / locked.end)
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=0.02)
    assert gaps[1] / gaps[2] == pytest.approx(10, rel=0.02)
    table = solve(dataclasses.replace(SOFT, hand_mass=1e9), 0.1, adhesive=True, stop="returned")
    assert abs(table.end - locked.end) / locked.end < 3e-8
    assert float(locked.state(locked.end)[3]) == 0.0


def test_contact_never_pulls_and_events_alternate() -> None:
    motion = solve(SOFT, 0.1)
    force = motion.contact_force(np.linspace(0, motion.end, 2000))
    assert force.min() > -1e-9
    assert force.max() > 5
    kinds = [e.kind for e in motion.events]
    assert kinds[::2] == ["touch"] * len(kinds[::2])
    assert kinds[1::2] == ["release"] * len(kinds[1::2])
    assert motion.summed_contact_time < motion.contact_time < motion.end
    assert all(a.end == b.start for a, b in zip(motion.segments, motion.segments[1:], strict=False))


def test_stuck_guide_lets_the_hand_take_the_hit() -> None:
    stuck = solve(dataclasses.replace(SMALL, guide_friction=1e3), 0.1)
    states = stuck.state(np.linspace(0, stuck.end, 100))
    assert np.abs(states[:, 1] - states[:, 0]).max() < 1e-13
    assert not stuck.times_of("slip")
    one_mass = 8.0 + 0.7
    reduced = 1 / (1 / one_mass + 1 / 9.0)
    zeta = SMALL.contact_damping / (2 * math.sqrt(68000.0 * reduced))
    expected = math.exp(-2 * zeta * math.acos(zeta) / math.sqrt(1 - zeta**2))
    final = states[-1]
    assert (final[3] - final[5]) / 0.1 == pytest.approx(expected, rel=1e-10)


def test_rejections() -> None:
    with pytest.raises(ValueError, match="approach"):
        solve(SOFT, 0.0)
    with pytest.raises(ValueError, match="stop"):
        solve(SOFT, 0.1, stop="never")
    with pytest.raises(ValueError, match="times"):
        solve(SOFT, 0.1).state(99.0)
    with pytest.raises(ValueError, match="target_mass"):
        dataclasses.replace(SOFT, target_mass=-1.0)
    with pytest.raises(ValueError, match="hand_mass"):
        dataclasses.replace(SOFT, hand_mass=0.0)
