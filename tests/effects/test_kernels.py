"""What every force law owes: its energy, slope and edges belong to its force, and friction only takes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from spacerobot.effects.kernel import no_energy, padded
from spacerobot.effects.laws import CONTACT, DAMPER, SPRING
from spacerobot.effects.primitives import Force, Friction
from spacerobot.effects.registry import all_effects
from spacerobot.simulation.rig import rig

RIG = rig({"wrist.damping": 3.0, "contact.damping": 30.0, "target.yaw_inertia": 0.4, "hand.mass": 25.0}, lateral=True)
AT = np.concatenate([-np.geomspace(0.08, 1e-5, 40), np.geomspace(1e-5, 0.08, 40)])
GYROSCOPIC = ("magnus", "lift")
"""Effects whose forces are each no friction, and together work on nothing (tests/simulation)."""


def forces() -> dict[str, Force]:
    """Every force of the plain rig and of every effect at every place, with ordinary numbers."""
    found = {f"rig {f.name}": f for f in RIG.forces}
    found["rig contact"] = Force("contact", "wrist", CONTACT, (6e4, 30.0, 1.0, 0.0))
    found["hertz"] = Force("hertz", "wrist", CONTACT, (6e4, 0.0, 1.5, 0.0))
    for name, one in all_effects().items():
        for where in one.places(RIG):
            for k in range(max(len(p.starts) for p in one.parameters)):
                values = {p.name: p.starts[min(k, len(p.starts) - 1)] for p in one.parameters}
                edited = one.apply(RIG, where, values)
                new = [f for f in edited.forces if f not in RIG.forces]
                found.update({f"{name} at {where} {k} {f.name}": f for f in new})
    return found


FORCES = forces()


def law(force: Force) -> Callable[[float, float], float]:
    p = padded(force.p)
    return lambda d, v: float(force.kernel.force(d, v, 0.0, p))


def away_from_edges(force: Force) -> np.ndarray:
    """Displacements at which no kink is near."""
    p = padded(force.p)
    side = np.array([[force.kernel.edge(d * (1 + s), 0.0, 0.0, p) for d in AT] for s in (-2e-4, 0.0, 2e-4)])
    return AT[(np.sign(side) == np.sign(side[1])).all(axis=0)]


@pytest.mark.parametrize("name", [n for n, f in FORCES.items() if f.kernel.energy is not no_energy])
def test_a_force_is_the_gradient_of_its_energy(name: str) -> None:
    """-dE/dd at rest, everywhere but at the kinks, and nothing stored at nothing."""
    force = FORCES[name]
    p, f = padded(force.p), law(force)
    for d in away_from_edges(force):
        h = 1e-4 * abs(d)
        slope = (force.kernel.energy(d + h, 0.0, 0.0, p) - force.kernel.energy(d - h, 0.0, 0.0, p)) / (2.0 * h)
        size = max(abs(f(x, 0.0)) for x in (d, d + h, d - h))
        assert -slope == pytest.approx(f(d, 0.0), abs=2e-3 * size + 1e-9), d
    assert force.kernel.energy(0.0, 0.0, 0.0, p) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", [n for n, f in FORCES.items() if f.kernel.slope is not None])
def test_a_slope_is_the_derivative_of_its_force(name: str) -> None:
    """-df/dd on each side of the edges, where `aux` is the side that is meant."""
    force = FORCES[name]
    p, f = padded(force.p), law(force)
    assert force.kernel.slope is not None
    for d in away_from_edges(force):
        h = 1e-4 * abs(d)
        found = -(f(d + h, 0.0) - f(d - h, 0.0)) / (2.0 * h)
        side = math.copysign(1.0, force.kernel.edge(d, 0.0, 0.0, p))
        stated = force.kernel.slope(d, 0.0, side, p)
        assert stated == pytest.approx(found, rel=1e-6, abs=1e-6 * max(abs(f(0.08, 0.0)), 1e-6)), d
        assert f(d, 0.3) == f(d, 0.0), "such a law is of d alone"


@pytest.mark.parametrize("name", [n for n, f in FORCES.items() if f.kernel.has_edge])
def test_a_law_has_its_kinks_at_its_edges_and_does_not_jump(name: str) -> None:
    force = FORCES[name]
    f, p = law(force), padded(force.p)
    fine = np.linspace(-0.1, 0.1, 40_001)
    value = np.array([f(d, 0.0) for d in fine])
    side = np.array([force.kernel.edge(d, 0.0, 0.0, p) for d in fine])
    bend = np.abs(np.diff(value, 2))
    kink = bend > 1e-3 * np.abs(np.diff(value)).max()
    crossed = np.sign(side[:-2]) != np.sign(side[2:])
    assert not (kink & ~crossed).any()
    assert np.abs(np.diff(value)).max() <= 1.01 * np.abs(np.gradient(value, fine)).max() * (fine[1] - fine[0])


def damps(force: Force) -> bool:
    f = law(force)
    return any(f(d, 0.1) != f(d, 0.0) for d in AT)


@pytest.mark.parametrize(
    "name", [n for n, f in FORCES.items() if damps(f) and not n.startswith(GYROSCOPIC) and "contact" not in n]
)
def test_what_goes_with_the_speed_only_takes_energy(name: str) -> None:
    """(f(v) - f(0)) v is never positive, and the law is the same both ways."""
    f = law(FORCES[name])
    for v in (1e-4, 0.01, 0.3):
        for d in AT[::8]:
            there, back = f(d, v) - f(d, 0.0), f(d, -v) - f(d, 0.0)
            assert there * v < 0.0
            assert back == pytest.approx(-there, rel=1e-12)


RESTORING = ("cubic_stiffness", "end_stop", "tether", "rig wrist.spring", "hertz", "backlash")


@pytest.mark.parametrize("name", [n for n in FORCES if n.startswith(RESTORING)])
def test_a_spring_pulls_back_alike_to_both_sides(name: str) -> None:
    f = law(FORCES[name])
    sign = math.copysign(1.0, -f(0.09, 0.0)) if f(0.09, 0.0) else 0.0
    assert sign
    for d in AT:
        assert f(-d, 0.0) == pytest.approx(-f(d, 0.0), rel=1e-12)
        assert sign * f(d, 0.0) * d <= 0.0


def frictions() -> dict[str, tuple[Friction, dict[str, float]]]:
    found = {}
    for name, one in all_effects().items():
        for where in one.places(RIG):
            values = {p.name: p.starts[0] for p in one.parameters}
            new = [f for f in one.apply(RIG, where, values).frictions if f not in RIG.frictions]
            found.update({f"{name} at {where}": (f, values) for f in new})
    return found


FRICTIONS = frictions()


@pytest.mark.parametrize("name", FRICTIONS)
def test_a_limit_of_friction_is_never_negative_and_does_not_grow_with_speed(name: str) -> None:
    friction, _ = FRICTIONS[name]
    p = padded(friction.p)
    for sign in (1.0, -1.0):
        found = np.array([friction.level(sign * v, 2.0, 0.0, p) for v in np.geomspace(1e-300, 3.0, 60)])
        assert (found >= 0.0).all()
        assert (np.diff(found) <= 1e-15).all()
        if friction.steady:
            assert (found == found[0]).all()
    if friction.normal is not None:
        assert friction.level(0.1, 4.0, 0.0, p) == pytest.approx(2.0 * friction.level(0.1, 2.0, 0.0, p))


def level(name: str, values: dict[str, float], v: float, normal: float = 1.0) -> float:
    where = "contact" if name == "contact_friction" else "wrist"
    (friction,) = [f for f in all_effects()[name].apply(RIG, where, values).frictions if f not in RIG.frictions]
    return float(friction.level(v, normal, 0.0, padded(friction.p)))


def test_each_friction_is_what_its_parameters_say() -> None:
    assert level("coulomb_friction", {"force_N": 0.3}, -0.1) == 0.3
    assert level("contact_friction", {"mu": 0.2}, 0.1, 5.0) == pytest.approx(1.0)
    two = {"force_plus_N": 0.5, "force_minus_N": 0.2}
    assert (level("asymmetric_friction", two, 0.1), level("asymmetric_friction", two, -0.1)) == (0.5, 0.2)
    curve = {"static_force_N": 0.9, "coulomb_force_N": 0.4, "velocity_m_s": 0.02}
    for way in (1.0, -1.0):
        assert level("stribeck_friction", curve, way * 1e-12) == pytest.approx(0.9)
        assert level("stribeck_friction", curve, way * 0.02) == pytest.approx(0.4 + 0.5 / math.e)
        assert level("stribeck_friction", curve, way * 0.04) == pytest.approx(0.4 + 0.5 * math.exp(-4.0))
        assert level("stribeck_friction", curve, way * 1.0) == pytest.approx(0.4)


def test_what_holds_on_already_holds_by_so_much_more() -> None:
    """A surface that is stated to hold, and an adhesion nobody knew of: their tensions add."""
    stated = RIG.with_contact(lambda c: replace(c, hold=2.0))
    edited = all_effects()["adhesion"].apply(stated, "contact", {"force_N": 0.5})
    assert edited.contact is not None
    assert edited.contact.hold == 2.5


def force_of(name: str, where: str, values: dict[str, float]) -> Callable[[float, float], float]:
    (one,) = [f for f in all_effects()[name].apply(RIG, where, values).forces if f not in RIG.forces]
    return law(one)


@pytest.mark.parametrize(
    ("name", "where", "values", "expected"),
    [
        ("viscous_friction", "wrist", {"coefficient_Ns_m": 3.0}, lambda d, v: -3.0 * v),
        ("viscous_drag", "target", {"coefficient_Ns_m": 0.3}, lambda d, v: -0.3 * v),
        ("quadratic_damping", "wrist", {"coefficient_Ns2_m2": 80.0}, lambda d, v: -80.0 * abs(v) * v),
        ("quadratic_drag", "target", {"coefficient_Ns2_m2": 4.0}, lambda d, v: -4.0 * abs(v) * v),
        ("cubic_stiffness", "wrist", {"k3_N_m3": 2e5}, lambda d, v: -2e5 * d**3),
        ("preload", "wrist", {"force_N": -0.4}, lambda d, v: -0.4),
        ("end_stop", "wrist", {"travel_m": 0.01, "stiffness_N_m": 5e3},
         lambda d, v: -5e3 * max(abs(d) - 0.01, 0.0) * math.copysign(1.0, d)),
        ("tether", "target", {"stiffness_N_m": 2.0, "slack_m": 0.02},
         lambda d, v: -2.0 * max(abs(d) - 0.02, 0.0) * math.copysign(1.0, d)),
        ("backlash", "wrist", {"half_gap_m": 5e-4},
         lambda d, v: -1020.0 * max(abs(d) - 5e-4, 0.0) * math.copysign(1.0, d)),
    ],
)  # fmt: skip
def test_each_force_is_its_formula(name: str, where: str, values: dict[str, float], expected: Any) -> None:
    f = force_of(name, where, values)
    for d in (-0.05, -3e-4, 2e-4, 0.015, 0.07):
        for v in (-0.2, 0.0, 0.1):
            assert f(d, v) == pytest.approx(expected(d, v), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("n", "chi"), [(1.0, 0.0), (1.5, 0.0), (1.3, 0.8)])
def test_a_contact_is_its_formula_in_millimetres_of_reference(n: float, chi: float) -> None:
    """k d_ref (d/d_ref)^n (1 + chi v) + c v: every exponent presses alike at one millimetre."""
    p = padded((6e4, 30.0, n, chi))
    assert CONTACT.force(1e-3, 0.0, 0.0, p) == pytest.approx(-60.0)
    for d, v in ((2e-4, 0.1), (3e-3, -0.05)):
        elastic = 6e4 * 1e-3 * (d / 1e-3) ** n
        assert CONTACT.force(d, v, 0.0, p) == pytest.approx(-(elastic * (1.0 + chi * v) + 30.0 * v), rel=1e-12)
        assert CONTACT.force(-d, 0.0, 0.0, p) == pytest.approx(elastic, rel=1e-12)
    assert SPRING.force(0.01, 1.0, 0.0, padded((530.0,))) == -5.3
    assert DAMPER.force(0.01, 0.1, 0.0, padded((3.0,))) == pytest.approx(-0.3)
