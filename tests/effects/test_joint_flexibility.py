"""A joint's inertia divided in two swings at the frequency of two masses on one spring; driven laws stay in bounds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacerobot.effects.laws import SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force, Readout
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.affine import shorten
from spacerobot.simulation.reduced.run import simulate
from spacerobot.support.errors import InputError

NAME = "joint.motor"
WHOLE, LINK, STIFFNESS = 0.02, 0.012, 3.0


def joint() -> Mechanism:
    return Mechanism(
        coordinates={NAME: Coordinate(NAME, WHOLE, angular=True)},
        ports={NAME: {NAME: 1.0}},
        readouts={f"{NAME}.position": Readout(f"{NAME}.position", "position", NAME)},
    )


def flexible(share: float = LINK) -> Mechanism:
    values = {"link_inertia_kg_m2": share, "stiffness_N_m": STIFFNESS, "damping_Ns_m": 0.0}
    return effect("joint_flexibility").apply(joint(), NAME, values)


def test_motor_and_link_swing_against_each_other() -> None:
    """omega^2 = k (1/J_m + 1/J_l); the common motion is free."""
    made = flexible()
    omega = math.sqrt(STIFFNESS * (1.0 / (WHOLE - LINK) + 1.0 / LINK))
    time = np.linspace(0.0, 1.0, 200)
    run = simulate(made, velocity={NAME: 1.0, f"{NAME}.link": 0.0}, end=1.0 + 1e-9, tolerance=1e-10)
    speed = run.states(time)[1][:, 0]
    common = (WHOLE - LINK) / WHOLE
    assert speed == pytest.approx(common + (1.0 - common) * np.cos(omega * time), abs=1e-6)


def test_it_starts_at_rest_behind_its_motor() -> None:
    start = flexible().at_start({NAME: 0.7})
    assert start == {NAME: 0.7, f"{NAME}.link": 0.7}


def test_without_a_link_nothing_changes_and_no_link_has_all() -> None:
    assert flexible(0.0) == joint()
    with pytest.raises(InputError, match="a part of it"):
        flexible(WHOLE)


def test_it_sits_where_motion_is_simulated_alone() -> None:
    blind = Mechanism(coordinates={NAME: Coordinate(NAME, 1.0, angular=True)}, ports={NAME: {NAME: 1.0}})
    assert effect("joint_flexibility").places(blind) == ()
    assert effect("joint_flexibility").places(joint()) == (NAME,)
    assert Force("spring", NAME, SPRING, (1.0,)).port == NAME


def test_a_shortened_step_leaves_what_lies_beyond_its_coefficients_alone() -> None:
    """A driven mechanism keeps four coefficients a state; writing sixteen spoiled the memory behind them."""
    beyond = np.ones((3, 20))
    shorten(beyond[:, :4], 0.5)
    assert beyond[:, :4] == pytest.approx(np.tile([1.0, 0.5, 0.25, 0.125], (3, 1)))
    assert (beyond[:, 4:] == 1.0).all()
