"""Friction at the tip is Coulomb's: a disc in the tangent plane, blind to where its axes are, set-valued at rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.primitives import Impulse
from spacerobot.simulation.multibody import dynamics, ports
from spacerobot.simulation.multibody.run import MultibodyRun, integrate_scene
from spacerobot.simulation.multibody.sliding import against
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.reduced.arrays import NONE
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory

WRIST = Wrist(stiffness=2000.0, damping=3.0)
TANGENTIAL = ("contact.slip", "contact.friction", "target.position", "target.velocity", "target.angular_velocity")


def turned(angle: float, across: float, spin: tuple[float, float, float], mu: float) -> Scene:
    """A hit off the centre, the whole target turned about the approach; its inertia knows no direction across."""
    c, s = math.cos(angle), math.sin(angle)
    target = Target(
        speed=0.06,
        contact_point=(0.12, c * across, s * across),
        inertia=(0.2, 0.3, 0.3),
        spin=(spin[0], c * spin[1] - s * spin[2], s * spin[1] + c * spin[2]),
        gap=0.002,
    )
    return Scene(approach=(1.0, 0.0, 0.0), wrist=WRIST, contact=ContactLaw(damping=30.0, mu=mu), target=target)


def across(found: Trajectory, name: str) -> np.ndarray:
    """A vector's part in the tangent plane, as complex numbers, shape (T,)."""
    value = found[f"{name}.y"] + 1j * found[f"{name}.z"]
    return value - value[0] if name == "target.position" else value


@settings(max_examples=10, derandomize=True, deadline=None)
@given(
    angle=st.floats(0.0, 2.0 * math.pi),
    offset=st.floats(0.0, 0.05),
    spin=st.tuples(*[st.floats(-0.3, 0.3)] * 3),
    mu=st.sampled_from([0.02, 0.1, 0.6]),
)
def test_turning_everything_about_the_approach_turns_the_answer(
    angle: float, offset: float, spin: tuple[float, float, float], mu: float
) -> None:
    one, other = (
        simulate(turned(a, offset, spin, mu), duration=0.3, tolerance=1e-11, rate=500.0, must_touch=False)
        for a in (0.0, angle)
    )
    assert one.restitution.target == pytest.approx(other.restitution.target, abs=1e-8, nan_ok=True)
    # at the very moment of a switch the two are on either side of it
    near = np.array([min((abs(t - e.time) for e in (*one.events, *other.events)), default=1.0) for t in one.time])
    for name in TANGENTIAL:
        apart = np.abs(across(other, name) - across(one, name) * np.exp(1j * angle))
        assert apart[near > 1e-6].max() < 1e-6, name


def pyramid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Plants the mistake: each direction has the whole limit for itself."""
    alone = lambda mechanism: np.full(len(mechanism.frictions), NONE)  # noqa: E731
    monkeypatch.setattr(dynamics, "mates", alone)


def test_a_pyramid_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    pyramid(monkeypatch)
    one, other = (simulate(turned(a, 0.03, (0.0, 0.0, 0.0), 0.05), duration=0.3) for a in (0.0, 0.25 * math.pi))
    assert abs(one.restitution.target - other.restitution.target) > 1e-3


@settings(max_examples=12, derandomize=True, deadline=None)
@given(
    angle=st.floats(0.0, 2.0 * math.pi),
    offset=st.floats(0.0, 0.05),
    spin=st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    mu=st.floats(0.0, 1.5),
)
def test_friction_keeps_to_its_disc_opposes_the_sliding_and_never_gives_energy(
    angle: float, offset: float, spin: tuple[float, float, float], mu: float
) -> None:
    found = simulate(turned(angle, offset, spin, mu), duration=0.3, tolerance=1e-11, rate=2000.0, must_touch=False)
    force, slip, normal = across(found, "contact.friction"), across(found, "contact.slip"), found["contact.force"]
    unit = max(float(normal.max()), 1.0)
    assert (np.abs(force) <= mu * normal * (1.0 + 1e-9) + 1e-9 * unit).all()
    power = (force * slip.conjugate()).real
    assert power.max() <= 1e-12 * unit
    sliding = np.abs(slip) > 1e-9
    assert (
        np.abs(force + mu * normal * slip / np.where(sliding, np.abs(slip), 1.0))[sliding].max(initial=0) < 1e-6 * unit
    )
    if mu > 0.0:
        taken = found.ledger.dissipated["contact_friction"]
        assert np.diff(taken).min() >= -1e-12
        assert taken[-1] == pytest.approx(-np.trapezoid(power, found.time), abs=0.02 * max(taken[-1], 1e-6))
    assert found.ledger.closure < 1e-8


def test_what_sticks_does_not_slip() -> None:
    found = simulate(turned(0.7, 0.03, (0.0, 0.0, 0.0), 5.0), duration=0.1, tolerance=1e-11)
    pressed = found["contact.force"] > 0.0
    assert pressed.sum() > 20
    assert np.abs(across(found, "contact.slip")).max() < 1e-10
    assert np.abs(across(found, "contact.friction"))[pressed].max() > 0.01, "and something is held"


GRAVITY, MASS, MU = 0.4, 6.0, 0.3
BLOCK = Scene(
    approach=(1.0, 0.0, 0.0),
    wrist=Wrist(stiffness=2e4, damping=200.0),
    contact=ContactLaw(stiffness=5e4, damping=300.0, mu=MU),
    target=Target(mass=MASS, speed=0.01),
    gravity=(GRAVITY, 0.0, 0.0),
)


def pushed(
    scene: Scene, sideways: float, upwards: float, end: float, pulls: tuple[float, float] = (0.0, 0.0)
) -> MultibodyRun:
    """A body lying on the face of the tip, struck across it at the start [m/s], on a face that is not level [m/s^2]."""
    scene = replace(scene, gravity=(GRAVITY, *pulls))
    plain = scene.mechanism()
    mechanism = replace(plain, ports={**plain.ports, ports.RISE: {}}).with_impulse(
        Impulse("contact.slide", MASS * sideways, 0.0)
    )
    mechanism = mechanism.with_impulse(Impulse(ports.RISE, MASS * upwards, 0.0))
    return integrate_scene(scene, end, mechanism=mechanism, tolerance=1e-10)


@pytest.mark.parametrize("degrees", [0.0, 20.0, 45.0, 90.0, 137.0])
def test_a_block_slides_to_rest_as_the_closed_form_says(degrees: float) -> None:
    """However the surfaces press: v_t = v - mu (v_n - v_n0 - g t) in size, along one line, and then at rest."""
    speed, angle = 0.05, math.radians(degrees)
    y, z = speed * math.cos(angle), speed * math.sin(angle)
    run = pushed(BLOCK, y, z, 0.6)
    times = np.linspace(0.0, 0.6, 601)
    taken = run.sample(times)
    rate = taken.contact[:, 3] + 1j * taken.contact[:, 5]
    falling = taken.velocity[:, list(run.mechanism.coordinates).index("target")]
    left = speed - MU * (
        0.01 + GRAVITY * times - falling
    )  # momentum along the approach gives the impulse of the normal
    rest = float(times[np.argmax(left <= 0.0)])
    assert 0.2 < rest < 0.5
    expected = np.where(times < rest, np.maximum(left, 0.0), 0.0) * np.exp(1j * angle)
    assert np.abs(rate - expected).max() < 1e-7
    assert abs(rate[-1]) < 1e-12, "at rest, not creeping"
    assert rest == pytest.approx((speed / MU - 0.01) / GRAVITY, rel=0.02), "v / (mu g), once the landing has died away"


def test_a_block_on_a_slope_stays_below_the_angle_of_friction_and_slides_down_it_above() -> None:
    down = np.exp(0.6j)
    for share in (0.9, 1.2):
        pull = share * MU * GRAVITY
        run = pushed(BLOCK, 0.0, 0.02, 2.5, (pull * down.real, pull * down.imag))
        late = run.sample(np.linspace(2.0, 2.5, 51))
        rate = late.contact[:, 3] + 1j * late.contact[:, 5]
        friction = late.friction[:, 0] + 1j * late.friction[:, 1]
        if share < 1.0:
            assert np.abs(rate).max() < 1e-10
            assert np.abs(friction + MASS * pull * down).max() < 1e-6
        else:
            gained = (rate[-1] - rate[0]) / 0.5
            assert abs(gained - (pull - MU * GRAVITY) * down) < 1e-3 * pull, "struck across, it turns down the slope"


def test_struck_across_a_slope_it_turns_as_the_plane_problem_does() -> None:
    """m v' = F - R v/|v| integrated on its own (SciPy), the normal force that of our own run."""
    from scipy.integrate import solve_ivp

    pull = 0.25
    run = pushed(BLOCK, 0.04, 0.0, 0.5, (0.0, pull))
    times = np.linspace(0.0, 0.5, 101)
    taken = run.sample(times)

    def rate(t: float, v: np.ndarray) -> np.ndarray:
        normal = float(run.contact_at(np.array([t]))[0])
        return np.array([0.0, pull]) - MU * normal / MASS * v / max(float(np.hypot(*v)), 1e-15)

    own = solve_ivp(rate, (0.0, 0.5), [0.04, 0.0], t_eval=times, rtol=1e-8, atol=1e-10, max_step=2e-3)
    assert np.abs(taken.contact[:, [3, 5]].T - own.y).max() < 1e-6


@settings(max_examples=100, derandomize=True, deadline=None)
@given(
    b=st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)).filter(lambda b: math.hypot(*b) > 1e-3),
    give=st.tuples(st.floats(0.01, 3.0), st.floats(0.01, 3.0), st.floats(-0.9, 0.9)),
    share=st.floats(1e-6, 0.99),
)
def test_breaking_away_dissipates_most(b: tuple[float, float], give: tuple[float, float, float], share: float) -> None:
    """Of all forces in the disc: it opposes the acceleration that it leaves."""
    mixed = give[2] * math.sqrt(give[0] * give[1])
    matrix = np.array([[give[0], mixed], [mixed, give[1]]])
    limit = share * float(np.hypot(*np.linalg.solve(matrix, b)))
    force = np.array(against(*b, *matrix.ravel(), limit))
    assert float(np.hypot(*force)) == pytest.approx(limit, rel=1e-9)
    left = np.array(b) + matrix @ force
    assert float(left @ force) == pytest.approx(-float(np.hypot(*left)) * limit, rel=1e-6, abs=1e-9)


def test_two_roughnesses_add() -> None:
    whole = turned(0.4, 0.03, (0.1, 0.0, 0.2), 0.3)
    parts = replace(whole, contact=replace(whole.contact, mu=0.1))
    parts = parts.with_effects(EffectAt("contact_friction", "contact", {"mu": 0.2}))
    one, two = (simulate(s, duration=0.2, tolerance=1e-10) for s in (whole, parts))
    for name in ("target.position", "contact.friction"):
        assert np.abs(across(one, name) - across(two, name)).max() < 1e-8


@pytest.mark.slow
def test_mujocos_elliptic_cone_slides_as_far_and_its_pyramid_does_not() -> None:
    """Another engine, another method: a body that only slides, struck at 45 degrees on a level plane."""
    mujoco = pytest.importorskip("mujoco")
    pull, speed, mu = 9.81, 1.0, 0.3

    def distance(cone: str) -> np.ndarray:
        engine = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option timestep="2e-4" cone="{cone}" impratio="100" gravity="0 0 -{pull}"/><worldbody>
            <geom type="plane" size="9 9 1" friction="{mu}" solref="0.002 1"/><body pos="0 0 .0999">
            <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>
            <geom size=".1" mass="6" friction="{mu}" condim="3" solref="0.002 1"/></body></worldbody></mujoco>"""
        )
        data = mujoco.MjData(engine)
        data.qvel[:2] = speed * math.sqrt(0.5)
        for _ in range(2500):
            mujoco.mj_step(engine, data)
        return data.qpos[:2].copy()

    elliptic, faceted = distance("elliptic"), distance("pyramidal")
    scene = replace(BLOCK, contact=replace(BLOCK.contact, mu=mu), target=replace(BLOCK.target, speed=0.0005))
    run = pushed(scene, speed * math.sqrt(0.5), speed * math.sqrt(0.5), 10.0)
    slid = run.sample(np.array([0.0, 10.0])).contact[:, [2, 4]]
    ours = (slid[1] - slid[0]) * GRAVITY / pull  # the distance goes with v^2 / (mu g)
    assert ours == pytest.approx(elliptic, rel=0.01)
    assert ours != pytest.approx(faceted, rel=0.1)
