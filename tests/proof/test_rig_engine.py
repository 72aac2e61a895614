"""The MuJoCo rig against the project's own reduced model: two codes, one physics."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest

from spacerobot.effects.learned import Shape
from spacerobot.effects.registry import all_effects, effect
from spacerobot.proof.engine.laws import LAWS
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.engine.physics import EDITS, apply
from spacerobot.proof.engine.rig import Rig, Values
from spacerobot.proof.engine.run import Log, run
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import rig

pytest.importorskip("mujoco")

START, SPEED, DURATION = -0.01, 0.1, 0.9

CASES = [
    Missing("coulomb_friction", "wrist", {"force_N": 0.35}),
    Missing("coulomb_friction", "target", {"force_N": 0.01}),
    Missing("stribeck_friction", "wrist", {"static_force_N": 0.5, "coulomb_force_N": 0.2, "velocity_m_s": 0.02}),
    Missing("asymmetric_friction", "wrist", {"force_plus_N": 0.5, "force_minus_N": 0.2}),
    Missing("viscous_friction", "wrist", {"coefficient_Ns_m": 3.0}),
    Missing("quadratic_damping", "wrist", {"coefficient_Ns2_m2": 80.0}),
    Missing("cubic_stiffness", "wrist", {"k3_N_m3": 2.5e5}),
    Missing("backlash", "wrist", {"half_gap_m": 5e-4}),
    Missing("end_stop", "wrist", {"travel_m": 0.006, "stiffness_N_m": 12000.0}),
    Missing("tether", "target", {"stiffness_N_m": 2.0, "slack_m": 0.005}),
    Missing("preload", "wrist", {"force_N": 0.3}),
    Missing("hertz_contact", "contact", {"exponent": 1.5}),
    Missing("hunt_crossley", "contact", {"exponent": 1.5, "chi_over_k_s_m": 1.0}),
    Missing("adhesion", "contact", {"force_N": 2.0}),
    Missing("contact_friction", "contact", {"mu": 0.2}),
    Missing("eccentric_contact", "target", {"offset_m": 0.02}),
    Missing("arm_compliance", "arm", {"mass_kg": 22.0, "stiffness_N_m": 4e4, "damping_Ns_m": 180.0}),
    Missing("table_tilt", "target", {"angle_rad": 2e-4}),
    Missing("hidden_oscillator", "target", {"mass_kg": 1.6, "frequency_Hz": 2.6, "damping_ratio": 0.04}),
    Missing("external_impulse", "target", {"impulse_Ns": 0.05, "time_s": 0.6345}),
    Missing("payload", "target", {"mass_kg": 0.5}),
    Missing("viscous_drag", "target", {"coefficient_Ns_m": 0.5}),
    Missing("quadratic_drag", "target", {"coefficient_Ns2_m2": 4.0}),
    Missing("magnus", "target", {"coefficient_kg": 0.5}),
]


def both(values: Values, missing: tuple[Missing, ...], spin: float = 0.0) -> tuple[Log, ReducedRun]:
    """One meeting in MuJoCo and in the reduced model."""
    built = apply(Rig(values), missing)
    log = run(built, {"target": START}, {"target": SPEED, **({"target.yaw": spin} if spin else {})}, DURATION)
    return log, reduced(values, missing, spin, sideways="target.y" in built.joints)


def reduced(values: Values, missing: tuple[Missing, ...], spin: float = 0.0, *, sideways: bool = False) -> ReducedRun:
    named = {
        "wrist.mass": values.wrist_mass,
        "wrist.stiffness": values.wrist_stiffness,
        "wrist.damping": values.wrist_damping,
        "contact.stiffness": values.contact_stiffness,
        "contact.damping": 0.0 if any(m.effect == "hunt_crossley" for m in missing) else values.contact_damping,
        "target.mass": values.target_mass,
        "target.contact_point.ahead": values.ahead,
        "target.contact_point.lateral": values.lateral,
        "hand.mass": values.hand_mass,
    }
    if math.isfinite(values.yaw_inertia):
        named["target.yaw_inertia"] = values.yaw_inertia
    mechanism = rig(named, lateral=sideways)
    for item in missing:
        mechanism = effect(item.effect).apply(mechanism, item.where, item.values)
    position: dict[str, float] = {"target": START}
    velocity: dict[str, float] = {"target": SPEED, "target.yaw": spin}
    for name, coordinate in mechanism.coordinates.items():
        if coordinate.carrier:
            position[name], velocity[name] = START, SPEED
    velocity = {k: v for k, v in velocity.items() if k in mechanism.coordinates}
    return simulate(mechanism, position=position, velocity=velocity, end=DURATION, tolerance=1e-9)


def restitutions(log: Log, ours: ReducedRun) -> tuple[float, float]:
    """Of the target, in either code."""
    index = list(ours.layout.coordinates).index("target")
    end = ours.sample(np.array([DURATION])).velocity[0, index]
    return -float(log.velocity["target"][-1]) / SPEED, -float(end) / SPEED


def test_clean_scene_agrees() -> None:
    for stiffness in (530.0, 1020.0, 5100.0):
        theirs, ours = restitutions(*both(Values(wrist_stiffness=stiffness), ()))
        assert theirs == pytest.approx(ours, abs=5e-6)


def test_free_hand_agrees() -> None:
    log, ours = both(Values(hand_mass=25.0), ())
    theirs, own = restitutions(log, ours)
    assert theirs == pytest.approx(own, abs=1e-4)
    momentum = 25.0 * log.velocity["hand"] + 0.7 * log.slider[1] + 9.0 * log.velocity["target"]
    np.testing.assert_allclose(momentum, 0.9, rtol=1e-9)


@pytest.mark.parametrize("item", CASES, ids=lambda m: f"{m.effect}-{m.where}")
def test_every_effect_agrees(item: Missing) -> None:
    turning = item.effect in ("contact_friction", "eccentric_contact", "magnus")
    values = Values(
        wrist_stiffness=1020.0,
        yaw_inertia=0.45 if turning else math.nan,
        ahead=0.15 if turning else 0.0,
    )
    spin = 0.3 if item.effect in ("contact_friction", "magnus") else 0.0
    log, ours = both(values, (item,), spin)
    theirs, own = restitutions(log, ours)
    assert theirs == pytest.approx(own, abs=1e-4)
    touches = [e.time for e in ours.events if e.element == "contact" and e.kind == "touch"]
    np.testing.assert_allclose(log.touches, touches, atol=2e-4)
    grid = np.linspace(0.0, DURATION, 300)
    taken = ours.sample(grid)
    index = list(ours.layout.coordinates).index("wrist")
    np.testing.assert_allclose(np.interp(grid, log.time, log.slider[0]), taken.position[:, index], atol=3e-5)


@pytest.mark.parametrize("item", CASES, ids=lambda m: f"{m.effect}-{m.where}")
def test_the_comparison_notices_a_left_out_effect(item: Missing) -> None:
    """Each effect of these sizes moves the target or the slider by more than the two codes differ."""
    turning = item.effect in ("contact_friction", "eccentric_contact", "magnus")
    values = Values(yaw_inertia=0.45 if turning else math.nan, ahead=0.15 if turning else 0.0)
    spin = 0.3 if item.effect in ("contact_friction", "magnus") else 0.0
    without = reduced(values, (), spin, sideways=turning)
    with_it = reduced(values, (item,), spin, sideways=turning)
    grid = np.linspace(0.0, DURATION, 300)

    def path(taken: ReducedRun, name: str) -> np.ndarray:
        return taken.sample(grid).position[:, list(taken.layout.coordinates).index(name)]

    seen = ["wrist", "target", *(["target.y"] if turning else [])]
    moved = max(abs(path(without, n) - path(with_it, n)).max() for n in seen)
    assert moved > 6e-5


def test_every_edit_of_the_engine_is_of_an_effect_and_is_compared() -> None:
    inside = set(EDITS) - set(OUTSIDERS) - set(LAWS)
    assert inside <= set(all_effects())
    assert {c.effect for c in CASES} == inside


@pytest.mark.parametrize("name", sorted(LAWS))
def test_every_law_of_no_catalogue_is_where_and_of_what_it_says(name: str) -> None:
    """A spline through its curve, at its port in the reduced model, moves as the engine does."""
    law = LAWS[name]
    values = law.numbers(np.random.default_rng(3), 0.01)(
        {"valve": 5.0, "loaded": 5.0, "stiffening": 20.0}.get(name, 2.0)
    )
    low, high = {"d": (-0.012, 0.012), "v": (-0.15, 0.15), "N": (0.0, 30.0)}[law.of]
    low, high = (0.0, 5e-4) if law.where == "contact" else (low, high)
    low, high = (-0.09, 0.02) if law.where == "target" else (low, high)
    shape = Shape(law.kind, law.of, low, high, 29, 1.0, 1.0)  # type: ignore[arg-type]
    x = np.linspace(low, high, 400)
    inside = np.linalg.lstsq(shape.rows(x), np.array([law.curve(u, values) for u in x]), rcond=None)[0]
    floor = 0.0 if law.kind == "friction" else -np.inf
    spline = {f"c_{k:02d}": float(max(c, floor)) for k, c in enumerate(inside)}
    log = run(apply(Rig(Values()), (Missing(name, law.where, values),)), {"target": START}, {"target": SPEED}, DURATION)
    ours = reduced(Values(), (Missing(shape.name, law.where, spline),))
    plain = reduced(Values(), ())
    grid = np.linspace(0.0, DURATION, 300)
    index = list(ours.layout.coordinates).index("wrist")
    theirs = np.interp(grid, log.time, log.slider[0])
    off = np.abs(theirs - ours.sample(grid).position[:, index]).max()
    assert off < 4e-5
    assert np.abs(plain.sample(grid).position[:, index] - ours.sample(grid).position[:, index]).max() > 3.0 * off


OUTSIDE: dict[str, tuple[str, Mapping[str, float]]] = {
    "magnetic_pull": ("contact", {"force_N": 1.0, "length_m": 0.005}),
    "one_sided_damping": ("wrist", {"coefficient_Ns_m": 5.0}),
    "warming_spring": ("wrist", {"share": 0.1, "trials": 3.0}),
    "periodic_cable": ("target", {"force_N": 0.05, "frequency_Hz": 1.5}),
    "cogging": ("wrist", {"force_N": 0.5, "pitch_m": 0.004}),
}


@pytest.mark.parametrize("name", sorted(OUTSIDERS))
def test_outsiders_do_something(name: str) -> None:
    where, values = OUTSIDE[name]
    plain, _ = both(Values(), ())
    odd = run(
        apply(Rig(Values(), trial=4), (Missing(name, where, values),)), {"target": START}, {"target": SPEED}, DURATION
    )
    assert abs(odd.velocity["target"][-1] - plain.velocity["target"][-1]) > 1e-4 * SPEED


def test_magnetic_pull_stores_what_it_gives() -> None:
    """Without damping the pull is conservative: what leaves is as fast as what came, far away."""
    values = Values(wrist_damping=0.0, contact_damping=0.0)
    pull = Missing("magnetic_pull", "contact", {"force_N": 0.5, "length_m": 0.002})
    rig_ = apply(Rig(values), (pull,))
    log = run(rig_, {"target": START}, {"target": SPEED}, DURATION)
    wrist, speed = log.position["wrist"], log.velocity["wrist"]
    gap = wrist - log.position["target"]
    kinetic = 0.5 * 9.0 * log.velocity["target"] ** 2 + 0.5 * 0.7 * speed**2 + 0.5 * 1020.0 * wrist**2
    open_ = gap > 0.0
    stored = -0.5 * 0.002 / (1.0 + gap[open_] / 0.002)
    energy = kinetic[open_] + stored
    np.testing.assert_allclose(energy, energy[0], rtol=2e-4)
