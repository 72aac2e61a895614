"""Straight modes: a step by Taylor series against the general method, which knows nothing of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force, Friction
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.affine import DEGREE
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.reduced.stepper import ORDER
from spacerobot.simulation.rig import rig

PLAIN = {
    "wrist.mass": 0.7,
    "wrist.stiffness": 530.0,
    "wrist.damping": 1.4,
    "contact.stiffness": 6.8e4,
    "contact.damping": 40.0,
    "target.mass": 9.0,
}
EFFECTS = {
    "coulomb_friction": ("wrist", {"force_N": 0.35}),
    "asymmetric_friction": ("wrist", {"force_plus_N": 0.5, "force_minus_N": 0.2}),
    "backlash": ("wrist", {"half_gap_m": 3e-4}),
    "end_stop": ("wrist", {"travel_m": 3e-3, "stiffness_N_m": 4e3}),
    "preload": ("wrist", {"force_N": 0.3}),
    "tether": ("target", {"stiffness_N_m": 0.8, "slack_m": 0.02}),
    "hidden_oscillator": ("target", {"mass_kg": 1.0, "frequency_Hz": 2.0, "damping_ratio": 0.05}),
    "arm_compliance": ("arm", {"mass_kg": 8.0, "stiffness_N_m": 2e4, "damping_Ns_m": 30.0}),
    "adhesion": ("contact", {"force_N": 0.5}),
    "stribeck_friction": ("wrist", {"static_force_N": 0.4, "coulomb_force_N": 0.2, "velocity_m_s": 0.02}),
    "hertz_contact": ("contact", {"exponent": 1.5}),
    "external_impulse": ("target", {"impulse_Ns": 0.05, "time_s": 0.9}),
}
MOSTLY_CURVED = {"stribeck_friction", "hertz_contact"}


def made(*names: str) -> Mechanism:
    mechanism = rig(PLAIN)
    for name in names:
        where, values = EFFECTS[name]
        mechanism = effect(name).apply(mechanism, where, values)
    return mechanism


def general(mechanism: Mechanism) -> Mechanism:
    """The same without anything that says it is straight: every force through a law of which nothing is known."""

    def hidden(force: Force) -> Force:
        return replace(force, kernel=unknown(force.kernel))

    frictions: tuple[Friction, ...] = tuple(replace(f, steady=False) for f in mechanism.frictions)
    return replace(mechanism, forces=tuple(map(hidden, mechanism.forces)), frictions=frictions)


def _twin(law):  # type: ignore[no-untyped-def]
    def same(d, v, aux, p):  # type: ignore[no-untyped-def]
        return law(d, v, aux, p)

    return same


KNOWN: dict[Kernel, Kernel] = {}


def unknown(kernel: Kernel) -> Kernel:
    if kernel not in KNOWN:
        from spacerobot.support.jit import numba

        KNOWN[kernel] = Kernel(_twin(numba().njit(kernel.force)), kernel.edge, kernel.energy)
    return KNOWN[kernel]


def run(mechanism: Mechanism, speed: float, tolerance: float, end: float = 2.0) -> ReducedRun:
    return simulate(mechanism, position={"target": -0.005}, velocity={"target": speed}, end=end, tolerance=tolerance)


def difference(a: ReducedRun, b: ReducedRun, scale: float) -> float:
    times = np.linspace(0.0, 2.0, 401)
    (qa, va), (qb, vb) = a.states(times), b.states(times)
    return max(float(np.abs(qa - qb).max()) / scale, 0.01 * float(np.abs(va - vb).max()) / scale)


@pytest.mark.parametrize("name", EFFECTS)
def test_both_methods_agree(name: str) -> None:
    mechanism = made(name)
    ours, theirs = run(mechanism, 0.05, 1e-9), run(general(mechanism), 0.05, 1e-11)
    assert (theirs.steps.order == ORDER).all()
    share = (ours.steps.order == DEGREE).mean()
    assert share > (0.03 if name in MOSTLY_CURVED else 0.4)
    assert ours.touches().size == theirs.touches().size > 0
    assert difference(ours, theirs, 0.01) < 2e-8
    if name not in MOSTLY_CURVED:
        assert ours.steps.time.size < 0.5 * theirs.steps.time.size


@settings(max_examples=25, deadline=None)
@given(
    st.sets(st.sampled_from([n for n in EFFECTS if n not in ("hertz_contact", "stribeck_friction")]), max_size=3),
    st.floats(0.02, 0.2),
)
def test_any_few_effects_together(names: set[str], speed: float) -> None:
    if {"coulomb_friction", "asymmetric_friction"} <= names:
        names = names - {"asymmetric_friction"}
    mechanism = made(*sorted(names))
    at_first = run(mechanism, speed, 1e-9).touches()
    ours, theirs = run(mechanism, speed, 1e-9, 0.3), run(general(mechanism), speed, 1e-11, 0.3)
    # before the first touches everything is smooth in the start; after many, a graze may go either way
    assert at_first.size > 0
    assert theirs.touches()[:1] == pytest.approx(at_first[:1], abs=1e-9)
    assert np.abs(ours.states(at_first[:1] + 0.003)[0] - theirs.states(at_first[:1] + 0.003)[0]).max() < 1e-9


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10])
def test_error_follows_the_tolerance(tolerance: float) -> None:
    mechanism = made("coulomb_friction", "arm_compliance")
    assert difference(run(mechanism, 0.05, tolerance), run(mechanism, 0.05, 1e-12), 0.01) < 3.0 * tolerance


@settings(max_examples=30, deadline=None)
@given(st.floats(-6.0, -3.0), st.floats(0.03, 0.12))
def test_no_gap_is_jumped_over(exponent: float, speed: float) -> None:
    """However small, and however long a step: a long one may enter and leave it."""
    mechanism = effect("backlash").apply(rig(PLAIN), "wrist", {"half_gap_m": 10.0**exponent})
    rough, fine = (run(mechanism, speed, tolerance) for tolerance in (1e-6, 1e-11))
    assert (rough.steps.order == DEGREE).any()
    kinks = [[e.time for e in r.events if e.kind == "edge"][:8] for r in (rough, fine)]
    assert len(kinks[1]) > 4
    assert kinks[0] == pytest.approx(kinks[1], abs=1e-6)
    reference = simulate(
        general(mechanism),
        position={"target": -0.005},
        velocity={"target": speed},
        end=kinks[1][4] + 1e-4,
        tolerance=1e-9,
        max_step=min(1e-3, 10.0**exponent / speed),
    )
    assert [e.time for e in reference.events if e.kind == "edge"][:5] == pytest.approx(kinks[1][:5], abs=1e-7)


@pytest.mark.parametrize("beside", ["a spinning target", "quadratic_damping", "hunt_crossley"])
@settings(max_examples=8, deadline=None)
@given(st.floats(-5.5, -3.5), st.floats(0.03, 0.12))
def test_no_gap_is_jumped_over_beside_what_is_curved(beside: str, exponent: float, speed: float) -> None:
    """There other guards are looked for at a few moments of a step; the gap's edges are not."""
    values, start, gap = PLAIN, {"target": -0.005}, 10.0**exponent
    if beside == "a spinning target":
        values = {**PLAIN, "target.yaw_inertia": 0.43, "target.contact_point.lateral": 0.05}
        start["target.yaw"] = 0.01
    mechanism = effect("backlash").apply(rig(values), "wrist", {"half_gap_m": gap})
    if beside == "quadratic_damping":
        mechanism = effect(beside).apply(mechanism, "wrist", {"coefficient_Ns2_m2": 1e-9})
    if beside == "hunt_crossley":
        mechanism = effect(beside).apply(mechanism, "contact", {"exponent": 1.2, "chi_over_k_s_m": 0.5})
    runs = [
        simulate(mechanism, position=start, velocity={"target": speed}, end=1.0, tolerance=1e-9, max_step=step)
        for step in (0.05, min(1e-3, gap / speed))
    ]
    rough, fine = ([e.time for e in r.events if e.kind == "edge"] for r in runs)
    assert len(fine) > 4
    assert rough[: len(fine)] == pytest.approx(fine, abs=1e-6)


@pytest.mark.parametrize("names", [(), ("coulomb_friction", "backlash")])
def test_a_target_hit_in_line_with_its_centre_is_straight_although_it_could_turn(names: tuple[str, ...]) -> None:
    mechanism = rig({**PLAIN, "target.yaw_inertia": 0.3}, lateral=True)
    for name in names:
        where, values = EFFECTS[name]
        mechanism = effect(name).apply(mechanism, where, values)

    def hit(spin: float, mechanism: Mechanism = mechanism) -> ReducedRun:
        velocity = {"target": 0.05, "target.y": 0.01, "target.yaw": spin}
        return simulate(mechanism, position={"target": -0.005}, velocity=velocity, end=2.0, tolerance=1e-10)

    ours, turning = hit(0.0), hit(1e-14)
    assert (ours.steps.order == DEGREE).all()
    assert not (turning.steps.order == DEGREE).all()
    assert difference(ours, turning, 0.01) < 1e-8
    contact = mechanism.contact
    assert contact is not None
    beside = replace(mechanism, contact=replace(contact, lateral=0.02))
    assert not (hit(0.0, beside).steps.order == DEGREE).all()
    assert abs(hit(0.0, beside).states(np.array([2.0]))[1]).max() > 0.01


def test_a_wrong_slope_is_seen() -> None:
    """The comparison above has teeth: a kernel that says a wrong slope ends elsewhere."""
    mechanism = made("backlash")

    def liar(force: Force) -> Force:
        if force.role != "spring":
            return force
        return replace(force, kernel=replace(force.kernel, slope=wrong))

    bent = replace(mechanism, forces=tuple(map(liar, mechanism.forces)))
    assert difference(run(bent, 0.05, 1e-9), run(general(mechanism), 0.05, 1e-11), 0.01) > 1e-4


def wrong(d, v, aux, p):  # type: ignore[no-untyped-def]
    return 0.99 * p[0] if aux > 0.0 else 0.0


def test_energy_is_accounted_for_over_long_steps() -> None:
    mechanism = made("coulomb_friction", "end_stop")
    ours = run(mechanism, 0.2, 1e-9)
    taken = ours.sample(ours.boundaries())
    kinetic = ours.kinetic(taken.velocity)
    done = sum(ours.work().values())
    assert np.abs(kinetic - kinetic[0] - done).max() < 1e-9 * kinetic[0]


@pytest.mark.parametrize("name", EFFECTS)
def test_accelerations_are_what_the_forces_make_them(name: str) -> None:
    """Of a series its slope, which no force is asked for; before the run and after it, those at its ends."""
    ours = run(made(name), 0.05, 1e-8)
    times = np.setdiff1d(np.linspace(-0.1, 2.1, 2000), ours.switches())
    forced = ours.sample(times).acceleration
    assert np.abs(forced).max() > 0.1
    assert ours.accelerations(times) == pytest.approx(forced, abs=1e-6 * np.abs(forced).max())
