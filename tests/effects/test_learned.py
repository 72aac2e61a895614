"""A learned law's curve, its name, and the laws of the catalogue that it holds as special cases."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from spacerobot.effects.effect import Placed
from spacerobot.effects.kernel import padded
from spacerobot.effects.learned import CREEP, LearnedLaw, Shape, curve, in_plane, parsed, remembered_rate, ripple
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import rig
from spacerobot.support.errors import InputError

SHAPES = st.builds(
    Shape,
    kind=st.sampled_from(["force", "friction"]),
    of=st.sampled_from(["d", "v"]),
    low=st.floats(-1.0, -1e-3),
    high=st.floats(1e-3, 1.0),
    cells=st.integers(2, 29),
    roughness=st.floats(1e-4, 10.0),
    size=st.floats(1e-2, 100.0),
)


def _by_scipy(shape: Shape, coefficients: np.ndarray, x: np.ndarray) -> np.ndarray:
    width = (shape.high - shape.low) / shape.cells
    knots = shape.low + width * np.arange(-3, shape.cells + 4)
    return np.asarray(BSpline(knots, coefficients, 3)(np.clip(x, shape.low, shape.high)))


@given(shape=SHAPES, seed=st.integers(0, 2**32 - 1))
def test_a_curve_is_the_cubic_spline_of_its_coefficients_held_beyond_its_ends(shape: Shape, seed: int) -> None:
    random = np.random.default_rng(seed)
    inside = random.uniform(0.1, 2.0, shape.cells + 3)
    x = random.uniform(1.5 * shape.low, 1.5 * shape.high, 40)
    width = (shape.high - shape.low) / shape.cells
    p = padded((0.0, 1.0, shape.low, width, float(shape.cells), *inside))
    expected = _by_scipy(shape, inside, x)
    np.testing.assert_allclose([curve(v, 0.0, 0.0, p) for v in x], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(shape.rows(x) @ inside, expected, rtol=1e-9, atol=1e-9)
    q = (0.0, shape.low, width, float(shape.cells), *inside)
    np.testing.assert_allclose([remembered_rate(v, 0.0, 0.0, 1.0, 1.0, 1.0, q) for v in x], expected, rtol=1e-9)


@given(low=st.floats(-2.0, 2.0), period=st.floats(1e-3, 10.0), cells=st.integers(4, 29), seed=st.integers(0, 2**32 - 1))
def test_a_ripple_goes_round_and_is_smooth_where_it_closes(low: float, period: float, cells: int, seed: int) -> None:
    shape = Shape("force", "q", low, low + period, cells, 0.1, 1.0)
    assert parsed(shape.name) == shape
    random = np.random.default_rng(seed)
    inside = random.uniform(-1.0, 1.0, shape.count)
    x = low + period * random.uniform(0.0, 1.0, 20)
    p = padded((0.0, -1.0, low, period / cells, float(cells), *inside, *inside[:3]))
    expected = -shape.rows(x) @ inside
    np.testing.assert_allclose([ripple(v, 0.0, 0.0, p) for v in x], expected, atol=1e-9)
    np.testing.assert_allclose([ripple(v + 3.0 * period, 0.0, 0.0, p) for v in x], expected, atol=1e-6)
    seam = [ripple(low + period * h, 0.0, 0.0, p) for h in (-1e-6, 0.0, 1e-6)]
    assert abs(seam[0] - 2.0 * seam[1] + seam[2]) < 1e-8
    assert np.abs(shape.bends() @ np.full(shape.count, 3.0)).max() < 1e-12  # a constant is smooth all around


@given(v=st.floats(-2.0, 2.0), across=st.floats(-2.0, 2.0))
def test_what_resists_a_body_in_the_plane_acts_against_its_velocity(v: float, across: float) -> None:
    shape = Shape("force", "v", 0.0, 4.0, 8, 0.1, 1.0)
    drag = padded((1.0, -1.0, 0.0, 0.5, 8.0, *(0.7 * shape.places)))
    speed = float(np.hypot(v, across))
    expected = -0.7 * v * speed / np.hypot(speed, CREEP)
    assert in_plane(0.0, v, across, drag) == pytest.approx(expected, abs=1e-9)


@given(shape=SHAPES)
def test_a_name_holds_all_of_a_shape(shape: Shape) -> None:
    assert parsed(shape.name) == shape
    assert effect(shape.name).name == shape.name


@pytest.mark.parametrize(
    "name",
    [
        "learned_law[force|v|0|1|29|0.1]",
        "learned_law[force|z|0.0|1.0|29|0.1|1.0]",
        "learned_law[force|v|1.0|0.0|29|0.1|1.0]",
        "learned_law[force|v|0.0|nan|29|0.1|1.0]",
        "learned_law[force|v|0.0|1.0|99|0.1|1.0]",
        "learned_law[__import__('os')|v|0.0|1.0|29|0.1|1.0]",
        "learned_law[formula|force|v|0.0|1.0]",
        "learned_law[formula|force|v|0.0|1.0|sinus=1.0]",
        "learned_law[formula|force|v|1.0|0.0|line=1.0]",
        "learned_law[formula|force|v|0.0|1.0|line=-1.0]",
        "learned_law[formula|memory|v|0.0|1.0|line=1.0]",
        "learned_law[formula|force|v|0.0|1.0|line]",
    ],
)
def test_a_name_that_is_none_is_refused_in_a_line(name: str) -> None:
    with pytest.raises(InputError) as raised:
        effect(name)
    assert "learned law" in str(raised.value)
    assert "\n" not in str(raised.value)


@given(shape=SHAPES)
@settings(max_examples=20)
def test_a_straight_curve_is_smooth_and_a_bent_one_is_not(shape: Shape) -> None:
    straight = shape.places / shape.size
    bent = straight + 5.0 * shape.roughness * (-1.0) ** np.arange(straight.size)
    ridge = shape.bends() @ straight
    assert np.abs(ridge).max() < 1e-9 * max(np.abs(straight).max(), 1.0)
    precision = shape.precision()
    assert bent @ precision @ bent > straight @ precision @ straight + straight.size


@given(shape=SHAPES)
@settings(max_examples=20)
def test_a_curve_of_depth_has_no_force_where_there_is_none(shape: Shape) -> None:
    """Lifting it as a whole costs where its range begins at nothing, and only there."""
    for begins, costs in ((0.0, True), (0.1, False)):
        depth = Shape("force", "d", begins, begins + 1.0, shape.cells, shape.roughness, shape.size)
        lifted = np.ones(depth.count)
        assert (lifted @ depth.precision() @ lifted > 1e3 * depth.count) == costs
        rising = depth.places - depth.low
        assert rising @ depth.precision() @ rising < 1.0 + depth.count


def _run(name: str, values: dict[str, float]) -> ReducedRun:
    mechanism = Placed(effect(name), "wrist", values).apply(rig({"target.mass": 9.0}))
    return simulate(mechanism, position={"target": -0.01}, velocity={"target": 0.08}, end=1.2, tolerance=1e-10)


def _law(
    kind: str, of: str, curve_of: np.ndarray, low: float, high: float, **more: float
) -> tuple[str, dict[str, float]]:
    shape = parsed(f"learned_law[{kind}|{of}|{low}|{high}|{curve_of.size - 3}|0.1|1.0]")
    law = LearnedLaw(shape)
    return law.name, {**{f"c_{k:02d}": float(x) for k, x in enumerate(curve_of)}, **more}


def _straight(slope: float, low: float, high: float) -> np.ndarray:
    return slope * parsed(f"learned_law[force|v|{low}|{high}|29|0.1|1.0]").places


@pytest.mark.parametrize(
    ("learned", "known"),
    [
        (
            _law("friction", "d", np.full(32, 0.3), -0.01, 0.04),
            ("coulomb_friction", {"force_N": 0.3}),
        ),
        (
            _law("force", "v", _straight(6.0, -0.3, 0.3), -0.3, 0.3),
            ("viscous_friction", {"coefficient_Ns_m": 6.0}),
        ),
        (
            _law("memory", "z", np.full(32, 150.0), -9.0, 9.0, rate_1_s=12.5),
            ("maxwell", {"stiffness_N_m": 150.0, "relaxation_s": 0.08}),
        ),
    ],
)
def test_a_plain_curve_is_a_law_of_the_catalogue(
    learned: tuple[str, dict[str, float]], known: tuple[str, dict[str, float]]
) -> None:
    times = np.linspace(0.0, 1.2, 200)
    one, other = (_run(*law).states(times)[0] for law in (learned, known))
    np.testing.assert_allclose(one, other, atol=2e-8)
    without = _run("coulomb_friction", {"force_N": 0.0}).states(times)[0]
    assert np.abs(one - without).max() > 1e-4  # it is seen at all


def test_in_the_contact_a_line_is_a_stiffer_spring_and_a_bend_is_hertz() -> None:
    def contact(name: str, values: dict[str, float], stiffness: float) -> np.ndarray:
        made = rig({"target.mass": 9.0, "contact.stiffness": stiffness, "contact.damping": 20.0})
        mechanism = Placed(effect(name), "contact", values).apply(made)
        run = simulate(mechanism, position={"target": -0.01}, velocity={"target": 0.08}, end=1.2, tolerance=1e-10)
        return run.states(np.linspace(0.0, 1.2, 200))[0]

    line = _law("force", "d", _straight(4000.0, 0.0, 3e-3), 0.0, 3e-3)
    stiff = contact("hertz_contact", {"exponent": 1.0}, 20_000.0)
    np.testing.assert_allclose(contact(*line, 16_000.0), stiff, atol=2e-8)
    assert np.abs(contact("hertz_contact", {"exponent": 1.0}, 16_000.0) - stiff).max() > 1e-6  # it is seen at all
    shape = parsed("learned_law[force|d|0.0|0.003|29|0.1|1.0]")
    x = np.linspace(0.0, 3e-3, 200)
    wanted = 20.0 * (x / 1e-3) ** 2 - 16_000.0 * x  # which a cubic spline can be
    power = np.linalg.lstsq(shape.rows(x), wanted, rcond=None)[0]
    bent = _law("force", "d", power, 0.0, 3e-3)
    hertz = contact("hertz_contact", {"exponent": 2.0}, 20_000.0)
    np.testing.assert_allclose(contact(*bent, 16_000.0), hertz, atol=2e-8)


def test_friction_that_the_press_makes_holds_only_while_it_is_pressed() -> None:
    """mu N in the guide: where mu is above one, a push along it cannot move the wrist; without a press it is free."""
    name, values = _law("friction", "N", 2.0 * np.linspace(0.0, 50.0, 32), 0.0, 50.0)
    pressed = _run(name, values)
    times = np.linspace(0.0, 1.2, 400)
    assert np.abs(pressed.port("wrist", pressed.states(times)[0])).max() < 1e-4
    weak = {k: 0.05 * v for k, v in values.items()}
    assert np.abs(_run(name, weak).port("wrist", _run(name, weak).states(times)[0])).max() > 1e-3


def test_friction_whose_level_grows_with_displacement_holds_still_where_it_is_strong_enough() -> None:
    name, values = _law("friction", "d", np.linspace(0.0, 60.0, 32), 0.0, 0.03)
    run = _run(name, values)
    position, rate = run.states(np.linspace(1.0, 1.2, 50))
    where, speed = run.port("wrist", position), run.port("wrist", rate)
    assert np.abs(speed).max() < 1e-9
    assert where[0] > 1e-3
