"""Laws with a memory: closed forms, limits, an independent integrator, passivity and order of convergence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.effects.catalogue.maxwell import LAW as MAXWELL
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory
from spacerobot.effects.primitives import Coordinate, Field, Force, Impulse, State
from spacerobot.effects.registry import effect
from spacerobot.simulation import simulate as front
from spacerobot.simulation.exact.structure import NotLinearError, piecewise_linear
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.result import reduced_ledger
from spacerobot.simulation.rig import rig
from spacerobot.simulation.scene import Scene

VALUES = {"wrist.damping": 2.1, "contact.damping": 60.0}
LAWS: dict[str, Mapping[str, float]] = {
    "maxwell": {"stiffness_N_m": 180.0, "relaxation_s": 0.09},
    "bouc_wen": {"force_N": 2.0, "displacement_m": 4e-3},
    "dahl_friction": {"force_N": 0.4, "stiffness_N_m": 2e3},
    "lugre_friction": {
        "coulomb_force_N": 0.3,
        "static_force_N": 0.5,
        "velocity_m_s": 0.02,
        "bristle_stiffness_N_m": 1e5,
        "bristle_damping_Ns_m": 100.0,
    },
}


def made(name: str, values: Mapping[str, float]) -> Mechanism:
    return effect(name).apply(rig(VALUES), "wrist", values)


def strike(machine: Mechanism, tolerance: float = 1e-8) -> ReducedRun:
    return simulate(
        machine, position={"target": -0.004}, velocity={"target": 0.07}, end=0.8, tolerance=tolerance, max_step=0.02
    )


def motion(machine: Mechanism, tolerance: float = 1e-8) -> np.ndarray:
    return strike(machine, tolerance).positions(np.linspace(0.0, 0.8, 161))


def mass(*forces: Force, states: tuple[State, ...] = (), mass: float = 2.0, **more: object) -> Mechanism:
    """One mass at one port, as Newton's second law has it."""
    return Mechanism(
        coordinates={"x": Coordinate("x", mass)},
        ports={"x": {"x": 1.0}},
        forces=forces,
        states=states,
        **more,  # type: ignore[arg-type]
    )


def hidden(law: Memory) -> Memory:
    """The same law without the word that it is linear."""
    return replace(law, linear=False)


@pytest.mark.parametrize("law", [MAXWELL, hidden(MAXWELL)])
def test_a_stretch_relaxes_exponentially(law: Memory) -> None:
    """A mass so heavy that it just drifts: f(t) = k v T (1 - exp(-t/T)), and after it was stopped exp(-t/T)."""
    k, relaxation, speed = 180.0, 0.09, 0.3
    heavy = mass(states=(State("s", "x", law, (k, relaxation), 1e-3),), mass=1e9)
    machine = replace(heavy, impulses=(Impulse("x", -1e9 * speed, 0.2),))
    run = simulate(machine, velocity={"x": speed}, end=0.5, tolerance=1e-10)
    t = np.linspace(0.0, 0.49, 50)
    pulled = k * speed * relaxation * (1.0 - np.exp(-np.minimum(t, 0.2) / relaxation))
    expected = -pulled * np.exp(-np.maximum(t - 0.2, 0.0) / relaxation)
    np.testing.assert_allclose(run.sample(t).remembered[:, 0], expected, atol=1e-8 * k)


@pytest.mark.parametrize("frequency", [0.3, 3.0, 30.0])
def test_dynamic_stiffness_of_a_relaxing_spring(frequency: float) -> None:
    """f = -k (i w T) / (1 + i w T) x once the start is forgotten, for a motion forced through a heavy mass."""
    k, relaxation, w = 180.0, 0.05, 2.0 * np.pi * frequency
    m = 1e9
    machine = mass(
        Force("drive", "x", SPRING, (m * w * w,)), states=(State("s", "x", MAXWELL, (k, relaxation), 1e-3),), mass=m
    )
    t = np.linspace(1.0, 1.0 + 2.0 / frequency, 100)
    run = simulate(machine, position={"x": 0.01}, end=float(t[-1]) + 0.1, tolerance=1e-11)
    stiffness = k * (1j * w * relaxation) / (1.0 + 1j * w * relaxation)
    expected = -(stiffness * 0.01 * np.exp(1j * w * t)).real
    np.testing.assert_allclose(run.sample(t).remembered[:, 0], expected, atol=1e-6 * k * 0.01)


def test_a_relaxing_spring_that_never_relaxes_is_a_spring() -> None:
    stiff = rig({**VALUES, "wrist.stiffness": 1020.0 + 180.0})
    never = made("maxwell", {"stiffness_N_m": 180.0, "relaxation_s": 1e3})
    np.testing.assert_allclose(motion(never), motion(stiff), atol=1e-5)


def test_one_that_relaxes_at_once_is_a_damper() -> None:
    errors = []
    for relaxation in (2e-3, 1e-3):
        damper = rig({**VALUES, "wrist.damping": VALUES["wrist.damping"] + 4.0})
        quick = made("maxwell", {"stiffness_N_m": 4.0 / relaxation, "relaxation_s": relaxation})
        errors.append(np.abs(motion(quick) - motion(damper)).max())
    assert errors[0] < 2e-3
    assert errors[1] < 0.6 * errors[0]


def reference(law: Callable[[float, float], float], force: float) -> np.ndarray:
    """A mass on a spring with a force -F z beside it, by scipy; z' = law(z, v)."""

    def slope(t: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        return [v, (-50.0 * x - 0.3 * v - force * z) / 2.0, law(z, v)]

    t = np.linspace(0.0, 3.0, 31)
    found = solve_ivp(slope, (0.0, 3.0), [0.02, 0.0, 0.0], "DOP853", t, rtol=1e-11, atol=1e-13, max_step=2e-3)
    return np.asarray(found.y[0])


def ours(name: str, values: Mapping[str, float], tolerance: float = 1e-10) -> np.ndarray:
    forces = (Force("spring", "wrist", SPRING, (50.0,)), Force("damper", "wrist", DAMPER, (0.3,)))
    machine = Mechanism({"wrist": Coordinate("wrist", 2.0)}, {"wrist": {"wrist": 1.0}}, forces=forces)
    run = simulate(effect(name).apply(machine, "wrist", values), position={"wrist": 0.02}, end=3.0, tolerance=tolerance)
    return run.positions(np.linspace(0.0, 3.0, 31))[:, 0]


def bouc_wen(z: float, v: float) -> float:
    return float(v / 5e-3 * (1.0 - abs(z) * (1.0 + np.sign(v * z)) / 2.0))


def test_hysteresis_against_another_integrator() -> None:
    np.testing.assert_allclose(
        ours("bouc_wen", {"force_N": 0.4, "displacement_m": 5e-3}), reference(bouc_wen, 0.4), atol=1e-9
    )
    assert np.abs(ours("bouc_wen", {"force_N": 0.4, "displacement_m": 6e-3}) - reference(bouc_wen, 0.4)).max() > 1e-5


def dahl(z: float, v: float) -> float:
    return float(v / 5e-3 * (1.0 - np.sign(v) * z))


def test_dahls_bristle_against_another_integrator() -> None:
    found = ours("dahl_friction", {"force_N": 0.4, "stiffness_N_m": 0.4 / 5e-3})
    np.testing.assert_allclose(found, reference(dahl, 0.4), atol=1e-9)


def test_dahls_loop_in_closed_form() -> None:
    """Over a stroke from z0 one way, f = F (1 - (1 - z0) exp(-x / x0)), whatever the speed."""
    level, stiffness, stroke = 0.4, 80.0, 0.012
    x0, m, w = level / stiffness, 1e9, 20.0
    drive = (Force("drive", "wrist", SPRING, (m * w * w,)),)
    machine = Mechanism({"wrist": Coordinate("wrist", m)}, {"wrist": {"wrist": 1.0}}, forces=drive)
    run = simulate(
        effect("dahl_friction").apply(machine, "wrist", {"force_N": level, "stiffness_N_m": stiffness}),
        position={"wrist": 0.5 * stroke}, end=4.5 * np.pi / w, tolerance=1e-11,
    )  # fmt: skip
    z, half = 0.0, np.pi / w
    for k in range(4):
        t = (k + np.linspace(0.01, 0.99, 20)) * half
        way = -1.0 if k % 2 == 0 else 1.0
        gone = stroke * 0.5 * (1.0 - np.cos(w * (t - k * half)))
        share = way + (z - way) * np.exp(-gone / x0)
        np.testing.assert_allclose(run.sample(t).remembered[:, 0], -level * share, atol=1e-7 * level)
        z = way + (z - way) * np.exp(-stroke / x0)


def test_bristles_slide_at_stribecks_level() -> None:
    """In steady sliding LuGre's force is the Stribeck curve."""
    values = LAWS["lugre_friction"]
    for speed in (0.002, 0.01, 0.03, 0.2):
        machine = Mechanism({"wrist": Coordinate("wrist", 1e9)}, {"wrist": {"wrist": 1.0}})
        machine = effect("lugre_friction").apply(machine, "wrist", values)
        run = simulate(machine, velocity={"wrist": speed}, end=1.0, tolerance=1e-10)
        level = 0.3 + 0.2 * np.exp(-((speed / 0.02) ** 2))
        assert run.sample(np.array([1.0])).remembered[0, 0] == pytest.approx(-level, rel=1e-6)


@pytest.mark.parametrize("name", ["dahl_friction", "lugre_friction"])
def test_stiff_bristles_approach_dry_friction(name: str) -> None:
    level = {"dahl_friction": {"force_N": 0.4}, "lugre_friction": {"coulomb_force_N": 0.4, "static_force_N": 0.4}}[name]
    # what is left of the bristles' swing, and so the difference, is of the order of their period: 1 / sqrt(stiffness)
    dry = motion(made("coulomb_friction", {"force_N": 0.4}))
    apart = []
    for stiffness in (1e4, 1e5, 1e6):
        more = {"stiffness_N_m": stiffness}
        if name == "lugre_friction":
            bristles = {"bristle_stiffness_N_m": stiffness, "bristle_damping_Ns_m": 0.5 * np.sqrt(stiffness)}
            more = {"velocity_m_s": 0.02, **bristles}
        apart.append(np.abs(motion(made(name, {**level, **more})) - dry).max())
    assert apart[0] < 2e-4
    assert apart[1] < 0.4 * apart[0]
    assert apart[2] < 0.4 * apart[1]


@pytest.mark.parametrize("name", LAWS)
def test_a_smaller_tolerance_is_a_smaller_error(name: str) -> None:
    machine = made(name, LAWS[name])
    exact = motion(machine, 1e-12)
    errors = [np.abs(motion(machine, tolerance) - exact).max() for tolerance in (1e-5, 1e-7, 1e-9)]
    assert errors[0] < 2e-5
    assert errors[1] < 2e-7
    assert errors[2] < 2e-9


@pytest.mark.parametrize("name", LAWS)
def test_the_ledger_closes_and_the_branch_takes_energy(name: str) -> None:
    ledger = reduced_ledger(strike(made(name, LAWS[name]), 1e-10))
    assert ledger.closure < 1e-8
    lost = ledger.dissipated[f"{name} at wrist"]
    assert lost[-1] > 1e-5
    assert np.diff(lost).min() > -1e-12


@pytest.mark.parametrize("name", LAWS)
def test_a_step_by_series_is_the_general_step(name: str) -> None:
    machine = made(name, LAWS[name])
    general = replace(machine, states=tuple(replace(s, law=hidden(s.law)) for s in machine.states))
    np.testing.assert_allclose(motion(machine, 1e-11), motion(general, 1e-11), atol=1e-10)


def follow(z: float, rate: float, d: float, v: float, way: float, normal: float, p: tuple[float, ...]) -> float:
    return (d - z) / p[1]


def held(z: float, rate: float, d: float, v: float, way: float, normal: float, p: tuple[float, ...]) -> float:
    return -p[0] * (d - z)


@pytest.mark.parametrize("linear", [True, False])
def test_a_state_starts_at_rest_where_its_port_stands(linear: bool) -> None:
    """The same relaxing spring written with its damper's stretch as the state: stretched at the start, but at rest."""
    state = State("s", "x", Memory(follow, held, linear=linear), (180.0, 0.09), 1e-3)
    run = simulate(mass(states=(state,)), position={"x": 0.03}, end=0.5)
    np.testing.assert_allclose(run.positions(np.array([0.0, 0.5])), 0.03, atol=1e-12)


def knotted(z: float, rate: float, d: float, v: float, way: float, normal: float, p: tuple[float, ...]) -> float:
    """z' = v phi(z way), phi piecewise linear through 24 values over -1.2 to 1.2, the first of p the scale."""
    at = (z * way + 1.2) / 2.4 * 23.0
    i = min(max(int(at), 0), 22)
    return v / p[0] * (p[1 + i] + (at - i) * (p[2 + i] - p[1 + i]))


def full(z: float, rate: float, d: float, v: float, way: float, normal: float, p: tuple[float, ...]) -> float:
    return -2.0 * z


def test_a_table_of_coefficients_serves_as_a_law() -> None:
    x = np.linspace(-1.2, 1.2, 24)
    p = (4e-3, *(1.0 - np.maximum(x, 0.0)))
    table = rig(VALUES).with_state(State("table", "wrist", Memory(knotted, full), p, 1.0))
    exact = motion(made("bouc_wen", {"force_N": 2.0, "displacement_m": 4e-3}))
    np.testing.assert_allclose(motion(table), exact, atol=2e-4)


def test_a_field_does_not_pull_on_the_memory() -> None:
    """Under a steady pull a relaxing spring gives way at the speed F T / k, all of it in the branch's damper."""
    machine = mass(states=(State("s", "x", MAXWELL, (180.0, 0.02), 1e-3),)).with_field(Field("x", 1.0))
    run = simulate(machine, end=20.0)
    assert run.sample(np.array([19.0])).velocity[0, 0] == pytest.approx(2.0 / (180.0 * 0.02), rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_both_backends_agree_and_account_for_it(name: str) -> None:
    scene = Scene(
        "pa10_wrist",
        approach=(1.0, 0.0, 0.0),
        wrist=Wrist(mass=0.7, stiffness=1020.0, damping=2.1),
        contact=ContactLaw(stiffness=6.8e4, damping=60.0),
        target=Target(mass=9.0, speed=0.07, gap=0.004),
        effects=(EffectAt(name, "wrist", LAWS[name]),),
        duration=0.6,
    )
    one, other = (front.simulate(scene, backend=b) for b in ("reduced", "multibody"))
    travel = np.ptp(one.channels["target.x"])
    for channel in ("target.x", "wrist.x"):
        assert np.abs(one.channels[channel] - other.channels[channel]).max() < 1e-5 * travel
    assert other.ledger.closure < 1e-7
    took = [t.ledger.dissipated[f"{name} at wrist"][-1] for t in (one, other)]
    assert took[0] == pytest.approx(took[1], rel=1e-4)


def test_exact_propagation_says_what_it_does_not_hold() -> None:
    scene = Scene("pa10_wrist", approach=(1.0, 0.0, 0.0), effects=(EffectAt("maxwell", "wrist", LAWS["maxwell"]),))
    with pytest.raises(NotLinearError, match="memory"):
        piecewise_linear(scene)
