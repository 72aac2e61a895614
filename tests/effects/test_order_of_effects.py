"""Effects are physics, not steps: whichever is written down first, the machine is the same."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Field
from spacerobot.effects.registry import all_effects
from spacerobot.simulation.rig import rig

RIG = rig(
    {
        "wrist.damping": 3.0,
        "contact.damping": 30.0,
        "target.yaw_inertia": 0.4,
        "target.contact_point.ahead": 0.15,
        "hand.mass": 25.0,
        "gravity.along": 0.02,
    }
)


def placed(machine: Mechanism) -> list[tuple[str, str]]:
    """Every effect at every place."""
    return [(name, where) for name, one in all_effects().items() for where in one.places(machine)]


def values(name: str) -> dict[str, float]:
    """Ordinary numbers of an effect."""
    return {p.name: p.starts[0] for p in all_effects()[name].parameters}


def content(machine: Mechanism) -> dict[str, Any]:
    """What there is, in no order."""
    return {
        "coordinates": {n: (round(c.mass, 12), c.angular, c.carrier) for n, c in machine.coordinates.items()},
        "ports": {n: dict(row) for n, row in machine.ports.items()},
        "forces": Counter((f.port, f.kernel, f.p, f.sense, f.aux) for f in machine.forces),
        "frictions": Counter((f.port, f.level, f.p, f.normal) for f in machine.frictions),
        "fields": Counter((f.body, round(f.acceleration, 12)) for f in machine.fields),
        "impulses": Counter((i.port, i.impulse, i.time) for i in machine.impulses),
        "contact": replace(machine.contact, p=tuple(machine.contact.p)) if machine.contact else None,
        "maps": Counter((m.channel, m.kind, m.value, m.of) for m in machine.maps),
    }


def applied(*steps: tuple[str, str]) -> Mechanism:
    machine = RIG
    for name, where in steps:
        machine = all_effects()[name].apply(machine, where, values(name))
    return machine


PAIRS = [(a, b) for a, b in itertools.combinations(placed(RIG), 2) if a[0] != b[0]]


def differing() -> list[Any]:
    return [(a, b) for a, b in PAIRS if content(applied(a, b)) != content(applied(b, a))]


def test_any_two_effects_in_either_order_are_the_same_machine() -> None:
    assert len(PAIRS) > 200
    assert differing() == []


def test_the_check_notices_a_tilt_that_forgets_what_is_carried(monkeypatch: pytest.MonkeyPatch) -> None:
    tilt = all_effects()["table_tilt"]

    def careless(machine: Mechanism, where: str, values: dict[str, float]) -> Mechanism:
        return machine.with_field(Field(where, 9.80665 * math.sin(values["angle_rad"]), tilt.name))

    monkeypatch.setattr(tilt, "edit", careless)
    assert (("table_tilt", "target"), ("hidden_oscillator", "target")) in [
        tuple(sorted(p, reverse=True)) for p in differing()
    ]


def weight(machine: Mechanism) -> float:
    """What all fields together pull at a rig with [N]."""
    return sum(f.acceleration * machine.coordinates[f.body].mass for f in machine.fields)


@pytest.mark.parametrize("share", [0.3, 4.0])
def test_a_tilted_table_pulls_at_the_whole_target_whatever_moves_inside(share: float) -> None:
    """m g sin(angle) with the mass that is put on the scales, before and after a part of it is let go."""
    angle = 2e-3
    plain = rig({})
    tilted = all_effects()["table_tilt"].apply(plain, "target", {"angle_rad": angle})
    slosh = {"mass_kg": share, "frequency_Hz": 2.0, "damping_ratio": 0.05}
    first = all_effects()["hidden_oscillator"].apply(tilted, "target", slosh)
    last = all_effects()["table_tilt"].apply(
        all_effects()["hidden_oscillator"].apply(plain, "target", slosh), "target", {"angle_rad": angle}
    )
    for machine in (tilted, first, last):
        assert weight(machine) == pytest.approx(9.0 * 9.80665 * math.sin(angle), rel=1e-12)
        assert sum(c.mass for n, c in machine.coordinates.items() if n.startswith("target")) == pytest.approx(9.0)
