"""Stiff, light, heavy, slow, fast and degenerate scenes: right, or refused; never a wrong number with a straight face.

The reference is `theory.exact`, which propagates Eqs. 2 to 4 by matrix exponentials and so knows no stiffness.
"""

from __future__ import annotations

import math

import pytest

from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.prediction import predict_exact
from spacerobot.simulation.reduced.run import simulate as simulate_reduced
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import USUAL_SAMPLES, default_duration, simulate
from spacerobot.support.errors import InputError, SimulationError, SpacerobotError

STIFFNESS = (1.0, 1e3, 1e6, 1e9)
MASS = (1e-3, 1.0, 1e3)
SPEED = (1e-6, 0.07, 10.0)


def scene(stiffness: float, mass: float, speed: float, **options: object) -> Scene:
    """A hit of the held arm's wrist without any damping, where errors cannot die out."""
    return Scene(
        "pa10_wrist",
        wrist=Wrist(stiffness=stiffness),
        contact=ContactLaw(stiffness=68000.0),
        target=Target(mass=mass, speed=speed, gap=0.1 * speed),
        backend="reduced",
        **options,  # type: ignore[arg-type]
    )


CASES = [
    (k, m, v)
    for k in STIFFNESS
    for m in MASS
    for v in SPEED
    if (k, m) != (1.0, 1e3) or v == 0.07  # seconds each, of 370 touches
]


@pytest.mark.parametrize(("stiffness", "mass", "speed"), CASES)
def test_right_or_refused(stiffness: float, mass: float, speed: float) -> None:
    hit = scene(stiffness, mass, speed)
    try:
        found = simulate(hit)
    except SpacerobotError as error:
        pytest.skip(f"refused: {error}")
    expected = predict_exact(hit, default_duration(hit))
    assert expected is not None
    few = expected.touches < 30  # each further one multiplies what is left of an error by what the bounce makes of it
    assert abs(found.restitution.touches - expected.touches) <= (0 if few else 1)
    assert found.restitution.hand == pytest.approx(expected.restitution_hand, abs=2e-5 if few else 2e-2)
    if few:
        assert found.restitution.contact_time == pytest.approx(expected.contact_time, rel=1e-6)
    assert found.ledger.closure < 1e-6


def test_most_of_them_are_right_not_refused() -> None:
    done = 0
    for stiffness, mass, speed in ((1e9, 1e3, 0.07), (1.0, 1e-3, 1e-6), (1e6, 1.0, 10.0)):
        done += simulate(scene(stiffness, mass, speed)).restitution.touches > 0
    assert done == 3


@pytest.mark.parametrize("stiffness", [1.0, 1e9])
def test_a_body_of_a_million_tons_is_refused_in_words_that_help(
    stiffness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert simulate_reduced.__kwdefaults__ is not None
    monkeypatch.setitem(simulate_reduced.__kwdefaults__, "step_limit", 20_000)
    with pytest.raises(SimulationError, match=r"too many steps at t = .* s of .* s: .*give a shorter duration"):
        simulate(scene(stiffness, 1e9, 10.0))


def test_a_heavy_body_on_a_soft_spring_is_read_less_often_where_nobody_says_how_often() -> None:
    """A collision of a quarter of an hour, whose surfaces are soft and damped enough to stay together."""
    hit = Scene("pa10_wrist", wrist=Wrist(stiffness=1.0), contact=ContactLaw(stiffness=50.0, damping=50.0),
                target=Target(mass=1e5, speed=0.07, gap=0.01), backend="reduced")  # fmt: skip
    found = simulate(hit)
    assert found.time.size == pytest.approx(USUAL_SAMPLES, abs=2)
    expected = predict_exact(hit, default_duration(hit))
    assert expected is not None
    assert expected.contact_time > 900.0
    assert found.restitution.contact_time == pytest.approx(expected.contact_time, rel=1e-6)
    assert found.restitution.hand == pytest.approx(expected.restitution_hand, abs=2e-5)


def test_a_contact_of_a_year_is_refused() -> None:
    with pytest.raises(InputError, match=r"duration: the run would last too long; given: .* s in all"):
        simulate(scene(1e-12, 9.0, 0.07))
    with pytest.raises(InputError, match=r"duration: the run would last too long; given: 3.2e\+07 s"):
        simulate(scene(1e3, 9.0, 0.07), duration=3.2e7)


def test_too_many_samples_are_refused_with_the_rate_that_would_do() -> None:
    with pytest.raises(InputError, match=r"rate: too many samples for 4000 s; given: 1000 Hz; valid: at most 500 Hz"):
        simulate(scene(1e3, 1.0, 0.07), duration=4000.0, rate=1000.0)


def test_a_prediction_of_thousands_of_touches_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    hit = scene(1.0, 1.0, 0.07)
    assert predict_exact(hit, default_duration(hit)) is not None
    monkeypatch.setattr("spacerobot.theory.exact._MAX_SEGMENTS", 2)
    assert predict_exact(hit, default_duration(hit)) is None


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_the_outcome_of_a_linear_hit_does_not_depend_on_its_speed(backend: str) -> None:
    """Everything but the absolute errors of an integrator scales with the speed."""
    outcomes = [simulate(scene(530.0, 9.0, v), backend=backend).restitution for v in (1e-6, 1e-3, 0.07)]
    for one in outcomes[1:]:
        assert one.touches == outcomes[0].touches
        assert one.hand == pytest.approx(outcomes[0].hand, rel=1e-5)
        assert one.contact_time == pytest.approx(outcomes[0].contact_time, rel=1e-6)


def test_behind_a_wrist_that_hardly_gives_the_surfaces_decide_how_long() -> None:
    hit = scene(1e9, 9.0, 0.07)
    found = simulate(hit).restitution
    assert found.contact_time == pytest.approx(math.pi * math.sqrt(9.0 / 68000.0), rel=1e-3)
    assert math.isfinite(found.hand)


@pytest.mark.parametrize("law", ["hertz", "hunt_crossley"])
@pytest.mark.parametrize("speed", [1e-6, 0.07, 10.0])
def test_curved_surfaces_behind_a_hard_wrist_part_again(law: str, speed: float) -> None:
    hit = Scene("pa10_wrist", wrist=Wrist(stiffness=1e9), contact=ContactLaw(law=law),
                target=Target(mass=9.0, speed=speed, gap=0.1 * speed), backend="reduced")  # fmt: skip
    assert simulate(hit).restitution.hand == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("pose", [(0.0,) * 7, (0.0, 0.0, 0.0, math.pi, 0.0, 0.0, 0.0), (1e-9, 0, 0, 1e-9, 0, 1e-9, 0)])
def test_singular_poses(pose: tuple[float, ...]) -> None:
    """A stretched arm cannot give along itself: refused in words, or the hit of a wall behind the wrist."""
    try:
        hit = Scene("pa10_wrist", joints="free", pose=pose, approach=(0.0, 0.0, -1.0),
                    target=Target(mass=9.0, speed=0.07), backend="reduced")  # fmt: skip
        found = simulate(hit)
    except InputError:
        return
    assert 0.0 <= found.restitution.hand <= 1.0 + 1e-9
    assert found.ledger.closure < 1e-6


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, 1e13, 1e-13])
def test_masses_that_cannot_be_are_refused(value: float) -> None:
    with pytest.raises(InputError, match=r"target\.mass"):
        scene(530.0, value, 0.07)
