"""Laws of every effect there is, a newcomer's too: what its file says of it is true of its physics."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import spacerobot.diagnosis
from spacerobot.effects.catalogue.viscous_drag import ViscousDrag
from spacerobot.effects.effect import Effect
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import all_effects
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.result import reduced_ledger
from spacerobot.simulation.rig import rig

VALUES = {
    "wrist.damping": 3.0,
    "wrist.equivalent_damping": 4.0,
    "contact.damping": 30.0,
    "target.yaw_inertia": 0.4,
    "target.contact_point.ahead": 0.15,
    "hand.mass": 25.0,
}
PASSIVE = ("force", "contact", "body")
"""Kinds of effects that take energy or store it; gravity brings some, and so does a knock."""


def strike(machine: Mechanism) -> ReducedRun:
    """A target that meets the wrist at 0.1 m/s and leaves it."""
    return simulate(machine, position={"target": -0.01}, velocity={"target": 0.1}, end=0.8)


def brought(machine: Mechanism) -> float:
    """By how much [J] what moves and what is stored grow together at most, above their least before."""
    ledger = reduced_ledger(strike(machine))
    held = ledger.kinetic + np.sum([np.asarray(e) for e in ledger.stored.values()], axis=0)
    return float(np.max(held - np.minimum.accumulate(held)))


def numbers(one: Effect, share: float = 1.0) -> dict[str, float]:
    return {p.name: p.starts[0] if p.shape else share * p.starts[0] for p in one.parameters}


def placed(kinds: tuple[str, ...]) -> list[tuple[str, str]]:
    machine = rig(VALUES)
    return [
        (name, where)
        for name, one in all_effects().items()
        if one.kind in kinds and not one.once
        for where in one.places(machine)
    ]


@pytest.mark.parametrize(("name", "where"), placed(PASSIVE))
def test_nothing_passive_brings_energy(name: str, where: str) -> None:
    one = all_effects()[name]
    assert brought(one.apply(rig(VALUES), where, numbers(one))) < 1e-9


def test_a_brake_with_its_sign_turned_is_noticed() -> None:
    class Pushing(ViscousDrag):
        name: ClassVar[str] = "pushing"

        def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
            (value,) = values.values()
            return super().edit(mechanism, where, {"coefficient_Ns_m": -value})

    assert brought(Pushing().edit(rig(VALUES), "target", {"coefficient_Ns_m": 0.5})) > 1e-6


def motion(machine: Mechanism) -> np.ndarray:
    return strike(machine).positions(np.linspace(0.0, 0.8, 81))


@pytest.mark.parametrize(("general", "special"), [(n, s) for n, one in all_effects().items() for s in one.refines])
def test_a_refined_law_is_the_plain_one_where_its_levels_agree(general: str, special: str) -> None:
    rich, plain = all_effects()[general], all_effects()[special]
    own = {p.name: 2.0 * p.starts[0] for p in plain.parameters}
    level = plain.strength
    levels = {p.name: own[level.name] if p.unit == level.unit else p.starts[0] for p in rich.parameters}
    alike = levels | {name: x for name, x in own.items() if name in levels} | rich.limits
    for where in set(rich.places(rig(VALUES))) & set(plain.places(rig(VALUES))):
        machines = (plain.apply(rig(VALUES), where, own), rich.apply(rig(VALUES), where, alike))
        np.testing.assert_allclose(*map(motion, machines), atol=1e-6 if rich.limits else 1e-9)


@pytest.mark.parametrize(
    ("name", "where", "word"),
    [
        (n, where, word)
        for n, one in all_effects().items()
        for where in one.places(rig({**VALUES, "target.mass": 9.0, "wrist.mass": 0.7}))
        for word in one.same_as
        if f"{where}.{word}" in {**VALUES, "target.mass": 9.0, "wrist.mass": 0.7}
    ],
)
def test_a_value_that_stands_for_an_effect_is_the_effect(name: str, where: str, word: str) -> None:
    one = all_effects()[name]
    values: dict[str, Any] = {**VALUES, "target.mass": 9.0, "wrist.mass": 0.7}
    added = {**values, f"{where}.{word}": values[f"{where}.{word}"] + one.strength.starts[0]}
    effect = one.apply(rig(values), where, numbers(one))
    np.testing.assert_allclose(motion(effect), motion(rig(added)), atol=1e-9)


@pytest.mark.parametrize("name", all_effects())
def test_every_effect_has_a_null_a_unit_and_a_source(name: str) -> None:
    one = all_effects()[name]
    assert one.source
    assert one.formula
    assert one.title
    assert all(p.unit and p.lower <= p.null <= p.upper for p in one.parameters if not p.shape)


ANSWERED = {
    "answer/events.py": {"time_offset"},
    "answer/clock_offsets.py": {"time_offset"},
    "machines/measured.py": {"low_pass"},
}
"""A stream that is late is answered under that name; and a sensor's map, a primitive, is called as its effect is."""


def test_the_diagnosis_knows_no_effect_by_name() -> None:
    top = Path(spacerobot.diagnosis.__path__[0])
    for path in sorted(top.rglob("*.py")):
        told = {n.value for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.Constant)}
        known = told & set(all_effects()) - {"scale", "bias"}  # words of every day
        assert known == ANSWERED.get(str(path.relative_to(top).as_posix()), set()), path
