"""A tracked point beside the centre of mass: the centre moves as it would, the point goes round it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Readout
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.sensors import read_channels

KINDS = {"position": "body.position", "velocity": "body.velocity", "acceleration": "body.acceleration"}
NAMES = {"x": "target", "y": "target.y"}
TIMES = np.linspace(0.0, 3.0, 3001)


def gliding() -> Mechanism:
    """A body that nothing pushes, in the plane, with all that a track may show of it."""
    names = (*NAMES.values(), "target.yaw")
    readouts = {
        f"{group}.{letter}": Readout(f"{group}.{letter}", kind, NAMES[letter])
        for kind, group in KINDS.items()
        for letter in NAMES
    }
    return Mechanism(
        coordinates={n: Coordinate(n, 4.0, angular=n == "target.yaw") for n in names},
        ports={n: {n: 1.0} for n in names},
        readouts={**readouts, "body.yaw": Readout("body.yaw", "position", "target.yaw")},
    )


def read(ahead: float, aside: float, spin: float) -> dict[str, np.ndarray]:
    machine = effect("off_centre").apply(gliding(), "target", {"ahead_m": ahead, "aside_m": aside})
    start, rate = {"target": 0.1, "target.yaw": 0.4}, {"target": 0.2, "target.y": -0.1, "target.yaw": spin}
    run = simulate(machine, position=start, velocity=rate, end=3.0, tolerance=1e-9)
    return read_channels(run, machine, machine.readouts, TIMES)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-2.0, 2.0))
def test_the_centre_of_mass_moves_straight_on(ahead: float, aside: float, spin: float) -> None:
    shown = read(ahead, aside, spin)
    point = shown["body.position.x"] + 1j * shown["body.position.y"]
    centre = point + (ahead + 1j * aside) * np.exp(1j * shown["body.yaw"])
    np.testing.assert_allclose(centre, 0.1 + (0.2 - 0.1j) * TIMES, atol=1e-8)


def test_at_its_null_it_is_not_there() -> None:
    shown = read(0.0, 0.0, 1.7)
    np.testing.assert_allclose(shown["body.position.x"], 0.1 + 0.2 * TIMES, atol=1e-12)
    np.testing.assert_allclose(shown["body.velocity.y"], -0.1, atol=1e-12)


@pytest.mark.parametrize("letter", NAMES)
def test_rates_are_those_of_the_place(letter: str) -> None:
    shown = read(0.05, -0.12, 1.7)
    place, rate, bend = (shown[f"{group}.{letter}"] for group in KINDS.values())
    step = TIMES[1] - TIMES[0]
    np.testing.assert_allclose(np.gradient(place, step)[1:-1], rate[1:-1], atol=1e-6)
    np.testing.assert_allclose(np.gradient(rate, step)[1:-1], bend[1:-1], atol=1e-6)


def test_a_body_that_hits_something_or_flies_has_no_such_place() -> None:
    one, plain = effect("off_centre"), gliding()
    up = plain.with_appendage(Coordinate("target.z", 4.0), "target.z", {"target.z": 1.0})
    assert one.places(plain) == ("target",)
    assert one.places(up) == ()
