"""A base that leans and an encoder whose zero is wrong: all joints feel them, all together say which it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.felt_together import alone, felt_by, shapes_of, told
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.shared_sources import Source
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.settled import shape_of
from spacerobot.model.library import load
from tests.welded import heavier

G = 9.81
JOINTS = ("shoulder", "elbow")
FRICTION = {"shoulder": (0.6, 0.4, 0.0), "elbow": (0.2, 0.2, 0.0)}
FELT_BY_ALL = ("link_load", "heavier_link", "other_gravity", "encoder_zero")
OFFERED = (*FELT_BY_ALL, "coulomb_friction", "viscous_friction", "scale")
CATALOGUE = [one for name, one in all_effects().items() if name in OFFERED]
HEAD, TAIL = ARM.split('<joint name="elbow"')
SPATIAL = HEAD + '<joint name="elbow"' + TAIL.replace('axis xyz="0 1 0"', 'axis xyz="0 0 1"')
"""Its elbow turns across its shoulder. A base that leans about the shoulder alone is what a wrong zero there is."""


def machines(
    urdf: str,
    gravity: tuple[float, float, float] = (0.0, 0.0, -G),
    zeros: dict[str, float] | None = None,
    doubted: dict[str, float] | None = None,
    built: str = "",
) -> list[Machine]:
    """The joints of an arm in another gravity than stated, with encoders whose zeros are wrong [rad], or built
    otherwise than it is believed to be."""
    grids: dict[str, tuple[Grid, str, dict[str, float]]] = {}
    leaning = load(built or urdf)
    before = leaning.model.gravity.linear.copy()
    leaning.model.gravity.linear = np.array(gravity)
    for n in range(2):
        grid = arm_log(leaning, n, FRICTION)
        late = {f"joint.{j}.position": z for j, z in (zeros or {}).items()}
        grids[f"run{n}"] = replace(grid, value={c: x + late.get(c, 0.0) for c, x in grid.value.items()}), f"m{n}", {}
    leaning.model.gravity.linear = before
    noise = {f"joint.{j}.torque": 0.02 for j in JOINTS} | {f"joint.{j}.position": 1e-5 for j in JOINTS}
    made = [
        InverseDynamics(load(urdf), (0.0, 0.0, -G), grids, JOINTS, compared=[j], noise=noise, absolute=doubted)
        for j in JOINTS
    ]
    parts = [alone(m, CATALOGUE) for m in made]
    shapes = shapes_of(made, CATALOGUE, lambda some, *of: [felt_by(parts[k], *of) for k in some])
    return [told(m, shapes) for m in made]


LEANING = (0.02 * G, 0.03 * G, -G)


def test_a_base_that_leans_is_found_with_its_direction_and_named_by_each_joint() -> None:
    for machine, joint in zip(machines(SPATIAL, LEANING), JOINTS, strict=True):
        (((name, where), form),) = machine.shapes.items()
        assert (name, where) == ("other_gravity", "base")
        assert np.allclose(shape_of(form), np.array([0.02, 0.03, 0.0]) / np.hypot(0.02, 0.03), atol=0.03)
        growth = grow(machine, effects=CATALOGUE)
        friction = {(f"{kind}_friction", f"joint.{joint}") for kind in ("coulomb", "viscous")}
        assert set(growth.after.label) == {(f"{name}~{form}", where), *friction}
        pull = growth.after.fit.values()[f"{name}~{form}@{where}.pull_m_s2"]
        assert pull == pytest.approx(G * np.hypot(0.02, 0.03), rel=0.03)


@pytest.mark.slow
def test_gravity_that_the_log_does_not_have_is_the_whole_of_it() -> None:
    """Torques of a controller that takes the arm's weight off before it logs them."""
    for machine in machines(SPATIAL, (0.0, 0.0, 0.0)):
        (((name, where), form),) = machine.shapes.items()
        assert (name, where) == ("other_gravity", "base")
        assert np.allclose(shape_of(form), (0.0, 0.0, 1.0), atol=0.01)


@pytest.mark.parametrize("joint", [pytest.param(JOINTS[0], marks=pytest.mark.slow), *JOINTS[1:]])
def test_a_zero_that_nobody_doubted_is_found_at_its_joint(joint: str) -> None:
    """By what leans along with it, that of the shoulder is as well a base that leans about its axis."""
    found = machines(SPATIAL, zeros={joint: 0.02})
    for machine in found:
        assert ("encoder_zero", f"joint.{joint}") in machine.shapes
        assert (("other_gravity", "base") in machine.shapes) == (joint == "shoulder")
    (elbow,) = (m for m in found if m.name == "elbow")
    growth = grow(elbow, effects=CATALOGUE)
    if joint == "elbow":
        zero = growth.after.fit.values()["encoder_zero@joint.elbow.zero_m"]
        assert zero == pytest.approx(0.02, rel=0.03)


def test_a_zero_that_is_doubted_is_a_wrong_value_and_no_effect() -> None:
    for machine in machines(SPATIAL, zeros={"elbow": 0.02}, doubted={"joint.elbow.zero": 0.05}):
        assert all(name != "encoder_zero" or where != "joint.elbow" for name, where in machine.shapes)


def test_a_zero_that_nothing_reads_is_not_found() -> None:
    """About a vertical axis an arm weighs the same wherever it stands: what a zero would do is rounding."""
    source = Source(effect("encoder_zero"), "joint.shoulder", slice(0, 1), load_numbers, lambda where, place: np.inf)
    read, unread = (source.best(np.array([[s**2]]), np.array([30.0 * s])).gain for s in (1e3, 1e-15))
    assert read == pytest.approx(900.0)
    assert unread == 0.0


def load_numbers(where: str, place: np.ndarray | None) -> np.ndarray:
    raise AssertionError("a zero is no body")


def test_friction_alone_is_neither() -> None:
    assert all(not m.shapes for m in machines(SPATIAL))
    assert all(not m.shapes for m in machines(ARM))


@pytest.mark.slow
def test_a_load_on_an_arm_that_leans_leans_with_it() -> None:
    """What a pull asks for is in proportion to all that the arm carries: neither is told rightly without the other."""
    place = (0.25, 0.03, 0.06)
    for machine in machines(SPATIAL, LEANING, built=heavier(SPATIAL, "fore", 0.8, place)):
        where = dict(machine.shapes.keys())
        assert where == {"link_load": "link.fore", "other_gravity": "base"}
        growth = grow(machine, effects=CATALOGUE)
        values = {key.split("~")[0]: x for key, x in growth.after.fit.values().items()}
        assert values["link_load"] == pytest.approx(0.8, rel=0.02)
        assert values["other_gravity"] == pytest.approx(G * np.hypot(0.02, 0.03), rel=0.03)


@pytest.mark.slow
def test_a_zero_beside_a_load_is_that_of_the_loaded_arm() -> None:
    """A tenth of a radian: what the arm asks for bends with where it stands. A load aside of the fore arm is nearly an
    elbow that stands otherwise: beside the other each is told to some per cent."""
    found = machines(SPATIAL, zeros={"elbow": 0.1}, built=heavier(SPATIAL, "fore", 0.8, (0.25, 0.03, 0.06)))
    (shoulder,) = (m for m in found if m.name == "shoulder")
    assert dict(shoulder.shapes.keys()) == {"link_load": "link.fore", "encoder_zero": "joint.elbow"}
    values = {key.split("~")[0]: x for key, x in grow(shoulder, effects=CATALOGUE).after.fit.values().items()}
    assert values["link_load"] == pytest.approx(0.8, rel=0.01)
    assert values["encoder_zero@joint.elbow.zero_m"] == pytest.approx(0.1, rel=0.07)
