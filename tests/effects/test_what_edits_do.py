"""What an effect's parameters mean, in the mechanism that it makes: frequencies, shares and places of closed forms."""

from __future__ import annotations

import itertools
import math

import pytest

from spacerobot.effects.laws import CONTACT
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Contact, Coordinate
from spacerobot.effects.registry import effect


def bodies(*names: str, mass: float = 4.0, contact: Contact | None = None) -> Mechanism:
    return Mechanism(
        coordinates={n: Coordinate(n, mass) for n in names}, ports={n: {n: 1.0} for n in names}, contact=contact
    )


def test_a_bowl_swings_with_g_times_its_curvature() -> None:
    made = effect("table_curvature").edit(bodies("target"), "target", {"curvature_rad_m": 0.02})
    (spring,) = made.forces
    assert math.sqrt(spring.p[0] / 4.0) == pytest.approx(math.sqrt(9.80665 * 0.02))


def test_slosh_swings_and_dies_out_as_its_parameters_say() -> None:
    values = {"mass_kg": 1.5, "frequency_Hz": 0.7, "damping_ratio": 0.1}
    made = effect("hidden_oscillator").edit(bodies("target"), "target", values)
    spring, damper = (next(f for f in made.forces if f.name.endswith(k)) for k in ("spring", "damper"))
    assert math.sqrt(spring.p[0] / 1.5) == pytest.approx(2.0 * math.pi * 0.7)
    assert damper.p[0] / (2.0 * math.sqrt(spring.p[0] * 1.5)) == pytest.approx(0.1)


def test_a_drive_sees_the_joint_before_it() -> None:
    joints = ("joint.a", "joint.b", "joint.c", "joint.d")
    coupling = effect("transmission_coupling")
    for before, where in itertools.pairwise(joints):
        row = coupling.edit(bodies(*joints), where, {"ratio": 0.3}).ports[where]
        assert row == {where: 1.0, before: 0.3}


def test_an_offset_adds_to_the_one_that_is_there() -> None:
    contact = Contact(CONTACT, (1e4, 0.0, 1.0, 0.0), lateral=0.01)
    made = effect("eccentric_contact").edit(
        bodies("target", "target.yaw", contact=contact), "target", {"offset_m": 0.005}
    )
    assert made.contact is not None
    assert made.contact.lateral == pytest.approx(0.015)
