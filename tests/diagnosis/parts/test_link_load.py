"""A load that nobody stated: all joints tell together where it is, each of them how heavy; what is none is none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from helpers_models import ARM, arm_log
from msgspec.structs import replace as replace_struct

from spacerobot.diagnosis.answer.agreed import agreed
from spacerobot.diagnosis.answer.record import Effect, Value
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.links import mass_of, with_masses
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.selection.felt_together import alone, felt_by, shapes_of, told
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.one_amount import differ
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.selection.shared_sources import placed
from spacerobot.diagnosis.selection.shown_elsewhere import settled_by_others
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import said_name
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.settled import shape_of
from spacerobot.model.library import load
from tests.welded import heavier

GRAVITY = (0.0, 0.0, -9.81)
JOINTS = ("shoulder", "elbow")
FRICTION = {"shoulder": (1.2, 0.4, 0.0), "elbow": (0.3, 0.2, 0.0)}
PLACE = (0.25, 0.0, 0.06)
OFFERED = ("link_load", "heavier_link", "coulomb_friction", "viscous_friction", "payload", "scale", "preload", "bias")
CATALOGUE = [one for name, one in all_effects().items() if name in OFFERED]


def machines(
    urdf: str,
    change: dict[str, float] | None = None,
    sigma: dict[str, float] | None = None,
    values: dict[str, float] | None = None,
    loud: float = 0.0,
) -> list[Machine]:
    """The joints of an arm whose logs another made; with torques that read so many times too much, or scatter so."""
    built, random = load(urdf), np.random.default_rng(8)
    grids: dict[str, tuple[Grid, str, dict[str, float]]] = {}
    for n in range(2):
        grid = arm_log(built, n, FRICTION)
        value = {c: x * (change or {}).get(c, 1.0) for c, x in grid.value.items()}
        value = {c: x + loud * c.endswith(".torque") * random.standard_normal(x.shape) for c, x in value.items()}
        grids[f"run{n}"] = replace(grid, value=value), f"motion {n}", {}
    noise = {f"joint.{j}.torque": loud or 0.02 for j in JOINTS} | {f"joint.{j}.position": 1e-5 for j in JOINTS}
    robot = load(ARM)
    return [
        InverseDynamics(
            robot, GRAVITY, grids, JOINTS, compared=[j], noise=noise, sigma=dict(sigma or {}), values=dict(values or {})
        )
        for j in JOINTS
    ]


def with_shapes(models: list[Machine]) -> list[Machine]:
    """Each told what all of them feel together."""
    parts = [alone(m, CATALOGUE) for m in models]
    shapes = shapes_of(models, CATALOGUE, lambda some, *of: [felt_by(parts[k], *of) for k in some])
    return [told(m, shapes) for m in models]


@pytest.fixture(scope="module")
def carrying() -> list[Machine]:
    return with_shapes(machines(heavier(ARM, "fore", 0.8, PLACE)))


def test_a_load_is_found_where_it_is(carrying: list[Machine]) -> None:
    """Along the joints' axes its place is nothing that a plane arm could tell."""
    for machine in carrying:
        ((name, where),) = machine.shapes
        assert (name, where) == ("link_load", "link.fore")
        x, _, z = shape_of(machine.shapes[name, where])
        assert np.hypot(x - PLACE[0], z - PLACE[2]) < 0.003


@pytest.mark.parametrize("k", [0, 1])
def test_each_joint_names_it_and_how_heavy_it_is(carrying: list[Machine], k: int) -> None:
    growth = grow(carrying[k], effects=CATALOGUE)
    friction = {(f"{kind}_friction", f"joint.{JOINTS[k]}") for kind in ("coulomb", "viscous")}
    others = {(name, where) for name, where in growth.after.label if (said_name(name), where) not in friction}
    ((form, where),) = others
    assert where == "link.fore"
    values = growth.after.fit.values()
    assert values[f"{form}@{where}.mass_kg"] == pytest.approx(0.8, rel=0.01)
    (level,) = (v for name, v in values.items() if name.startswith("coulomb_friction") and name.endswith(".force_N"))
    assert level == pytest.approx(FRICTION[JOINTS[k]][0], rel=0.03)


@pytest.mark.parametrize("change", [None, {"joint.elbow.torque": 1.05}], ids=["friction", "a sensor"])
def test_what_a_joint_lacks_itself_is_no_load(change: dict[str, float] | None) -> None:
    assert all(not m.shapes for m in with_shapes(machines(ARM, change)))


def test_a_load_beside_friction_and_wrong_damping_is_no_scale_of_every_sensor() -> None:
    """Each joint's sensor that reads a tenth too much would do as well: there are as many of these as joints."""
    damping = {f"joint.{j}.damping": 0.05 for j in JOINTS}
    models = machines(heavier(ARM, "fore", 0.3, PLACE), sigma=dict.fromkeys(damping, 0.3), values=damping, loud=0.3)
    for machine in with_shapes(models):
        (((name, where), form),) = machine.shapes.items()
        assert (name, where) == ("link_load", "link.fore")
        x, _, z = shape_of(form)
        assert np.hypot(x - PLACE[0], z - PLACE[2]) < 0.05


STATED = {"link.fore.mass": 0.05, "link.upper.mass": 0.02}


@pytest.mark.slow
def test_a_link_that_is_heavier_than_stated_is_a_wrong_value_and_no_load() -> None:
    """By sixteen of its deviations. A load beside links as they are stated is found all the same."""
    heavy = with_masses(load(ARM), {"fore": 1.8}).urdf
    assert all(not m.shapes for m in with_shapes(machines(heavy, sigma=STATED)))
    loaded = with_shapes(machines(heavier(ARM, "fore", 0.8, PLACE), sigma=STATED))
    (form,) = {form for m in loaded for form in m.shapes.values()}
    assert np.hypot(shape_of(form)[0] - PLACE[0], shape_of(form)[2] - PLACE[2]) < 0.005


LOAD = Site(effect("link_load"), "link.fore")


def test_a_link_that_is_heavier_than_its_model_is_no_load_on_it() -> None:
    """Nobody stated how well its mass is known: it is said which link, and each joint says by how much."""
    heavy = with_shapes(machines(with_masses(load(ARM), {"fore": 1.8}).urdf))
    for machine in heavy:
        assert dict(machine.shapes) == {("heavier_link", "link.fore"): ""}
        growth = grow(machine, effects=CATALOGUE)
        more = growth.after.fit.values()["heavier_link@link.fore.mass_kg"]
        assert more == pytest.approx(0.8 * mass_of(load(ARM), "fore"), rel=0.02)


@pytest.mark.parametrize(("more", "loud"), [(1.2, 0.3), pytest.param(1.4, 2.0, marks=pytest.mark.slow)])
def test_what_one_joint_cannot_mistake_settles_what_another_cannot_tell(more: float, loud: float) -> None:
    """At the last joint a heavier link is nearly a sensor that reads too much; at the one before it is not."""
    heavy = with_shapes(machines(with_masses(load(ARM), {"fore": more}).urdf, loud=loud))
    shoulder, elbow = (Part(grow(machine, effects=CATALOGUE)) for machine in heavy)
    link = ("heavier_link", "link.fore")

    def holding(part: Part) -> set[bool]:
        return {link in one.label for one in (part.chosen, *part.rivals)}

    assert (holding(shoulder), holding(elbow)) == ({True}, {True, False})
    assert holding(settled_by_others([elbow])[0]) == {True, False}
    assert [holding(part) for part in settled_by_others([shoulder, elbow])] == [{True}, {True}]


def test_torques_without_an_arm_in_them_ask_for_no_link_of_negative_weight() -> None:
    """What would leave nothing of a link, or less, is not there: an arm without mass moves anyhow."""
    grid = arm_log(load(ARM), 4, {}, noise=0.02, seconds=4.0)
    random = np.random.default_rng(0)
    silent = {f"joint.{j}.torque": 1e-3 * random.standard_normal(grid.time.size) for j in JOINTS}
    grids: dict[str, tuple[Grid, str, dict[str, float]]] = {
        "run": (replace(grid, value={**grid.value, **silent}), "motion", {})
    }
    arms = [InverseDynamics(load(ARM), GRAVITY, grids, JOINTS, compared=[j]) for j in JOINTS]
    for source in placed([effect("heavier_link")], arms[0].shared, arms):
        carried = arms[0].carried(source.where, None)
        assert carried > 0.0
        assert source.possible(np.array([-0.9 * carried]), None)
        assert not source.possible(np.array([-carried]), None)
    assert np.isinf(arms[0].carried("joint.elbow", None))
    for machine in with_shapes(list(arms)):
        assert all(name != "heavier_link" for name, _ in machine.shapes)


@pytest.mark.parametrize("away", [0.0, 0.5, 1.0, 3.0])
def test_no_more_can_be_missing_at_a_place_than_a_link_may_have_there(away: float) -> None:
    """Of a ball of mass m and radius r, m / (1 + 5 d^2 / r^2) at a distance d from its middle."""
    mass, radius = 2.0, 0.1
    size = 0.4 * mass * radius**2
    ball = f"""<robot name="ball"><link name="stand"/><link name="ball"><inertial><origin xyz="0.3 0 0.1"/>
      <mass value="{mass}"/><inertia ixx="{size}" ixy="0" ixz="0" iyy="{size}" iyz="0" izz="{size}"/></inertial></link>
      <joint name="turn" type="continuous"><origin xyz="0 0 0.2"/><parent link="stand"/><child link="ball"/>
      <axis xyz="0 1 0"/></joint></robot>"""
    robot = load(ball)
    columns = BodyColumns(robot, Rigid(robot, GRAVITY, ["turn"]))
    place = np.array([0.3, 0.0, 0.1]) + away * radius * np.array([0.6, 0.0, 0.8])
    assert columns.carried("ball", place) == pytest.approx(mass / (1.0 + 5.0 * away**2), rel=1e-9)
    assert columns.carried("ball", None) == mass


def feeling(mass: float, error: float) -> Fit:
    """As much of a fit with a load as its agreement hangs on."""
    key = LOAD.key("mass_kg")
    return cast(Fit, SimpleNamespace(values=lambda: {key: mass}, errors=lambda: {key: (mass - error, mass + error)}))


def test_masses_that_differ_by_a_good_part_are_no_load() -> None:
    """However surely they are told: joints whose links are not as the model has them find a mass each. One that hardly
    tells speaks against nothing."""
    assert not differ([feeling(2.404, 0.003), feeling(2.397, 0.0004), feeling(2.400, 0.0005)], LOAD)
    assert not differ([feeling(2.404, 0.003), feeling(2.397, 0.0004), feeling(-5.0, 3.0)], LOAD)
    assert differ(
        [feeling(-0.134, 0.003), feeling(-0.100, 0.003), feeling(-0.083, 0.003), feeling(-0.061, 0.003)], LOAD
    )
    assert not differ([feeling(-0.134, 0.003)], LOAD)


def load_told(mass: float, half: float, part: str, where: str = "link.fore") -> Effect:
    value = Value(value=mass, ci95=(mass - half, mass + half), unit="kg")
    return Effect(effect="link_load", where=where, parameters={"mass_kg": value}, part=part)


def test_what_all_joints_tell_of_one_load_is_one_value() -> None:
    """The surer counts for more; who disagree by more than they may widen the interval."""
    friction = Effect(effect="coulomb_friction", where="joint.elbow", parameters={}, part="elbow")
    law = replace_struct(friction, effect="learned_law")
    assert agreed([friction, law]) == [friction, law]
    one, other = load_told(2.0, 0.2, "shoulder"), load_told(2.1, 0.1, "elbow")
    load, beside = agreed([one, friction, other])
    value = load.parameters["mass_kg"]
    assert value.value == pytest.approx(2.08)
    assert beside == friction
    far = agreed([one, load_told(3.0, 0.1, "elbow")])[0].parameters["mass_kg"]
    assert isinstance(far.ci95, tuple)
    assert isinstance(value.ci95, tuple)
    assert np.ptp(np.array(far.ci95, dtype=float)) > 3.0 * np.ptp(np.array(value.ci95, dtype=float))
    assert agreed([one, load_told(2.0, 0.1, "elbow", "link.upper")]) == [
        one,
        load_told(2.0, 0.1, "elbow", "link.upper"),
    ]
