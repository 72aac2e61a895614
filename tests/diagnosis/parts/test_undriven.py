"""A cart and a pole that nothing drives: what the pole's motion tells of a body on it, and what it cannot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.diagnosis.answer.shape_errors import spread_of
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.felt_together import alone, felt_by, shapes_of, told
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.primitives import Load
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.settled import shape_of
from spacerobot.recordings.study import load_study

CART, POLE, FAR, SPIN = 1.2, 0.3, 0.25, 0.00625
DRAG, TURN = 2.0, 0.002
LOAD = 0.05  # kg, where the pole has its mass

URDF = f"""<robot name="cartpole">
  <link name="base"/>
  <link name="cart"><inertial><mass value="{CART}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="pole"><inertial><mass value="{POLE}"/><origin xyz="0 0 {-FAR}"/>
    <inertia ixx="{SPIN}" iyy="{SPIN}" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="10"/></joint>
  <joint name="swing" type="continuous"><parent link="cart"/><child link="pole"/><axis xyz="0 1 0"/></joint>
</robot>
"""

STUDY = f"""format = 1
[baseline]
robot = "cartpole.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, -9.81]
[baseline.joint]
slide.damping = {DRAG}
swing.damping = {TURN}
swing.torque = 0
[baseline.sigma]
joint.slide.damping = 0.2
joint.swing.damping = 0.3
[streams.log]
time = "t"
[streams.log.channels]
x = {{ is = "joint.slide.position", sigma = 0.0002 }}
f = {{ is = "joint.slide.torque", use = "input" }}
q = {{ is = "joint.swing.position", sigma = 0.001 }}
[[trials]]
each = [0, 2]
id = "{{n}}"
log = "{{n}}.csv"
"""


@dataclass(frozen=True)
class Push:
    """On the cart, three sines."""

    size: np.ndarray
    often: np.ndarray
    phase: np.ndarray

    def at(self, time: float | np.ndarray) -> np.ndarray:
        """[N]."""
        return np.asarray(np.sin(2.0 * np.pi * np.multiply.outer(time, self.often) + self.phase) @ self.size)


def moved(time: float, y: np.ndarray, push: Push, mass: float) -> list[float]:
    """Rates of cart and pole, the pole's mass all at one distance but for its spin."""
    _, q, v, w = y
    c, s = mass * FAR * np.cos(q), mass * FAR * np.sin(q)
    felt = [float(push.at(time)) - DRAG * v - s * w * w, -9.81 * s - TURN * w]
    return [v, w, *np.linalg.solve([[CART + mass, -c], [-c, SPIN + mass * FAR**2]], felt)]


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Machine, ...]:
    """Of recordings with the load, by equations of motion that are written out."""
    folder = tmp_path_factory.mktemp("cart")
    rng, time = np.random.default_rng(1), np.arange(0.0, 12.0, 0.01)
    for n in range(3):
        push = Push(rng.uniform(1.0, 4.0, 3), rng.uniform(0.3, 1.2, 3), rng.uniform(0.0, 6.28, 3))
        rates = partial(moved, push=push, mass=POLE + LOAD)
        y = solve_ivp(rates, (0.0, 12.0), [0.0, rng.uniform(-1.0, 1.0), 0.0, 0.0], t_eval=time, rtol=1e-7, atol=1e-9).y
        x, q = y[0] + 2e-4 * rng.standard_normal(time.size), y[1] + 1e-3 * rng.standard_normal(time.size)
        rows = np.stack([time, x, push.at(time), q], axis=1)
        np.savetxt(folder / f"{n}.csv", rows, "%.7f", ",", header="t,x,f,q", comments="")
    (folder / "cartpole.urdf").write_text(URDF)
    (folder / "study.toml").write_text(STUDY)
    return models_for(load_study(folder))


def readings(
    machine: Machine, trial: TrialData, mass: float, place: tuple[float, float, float] | None, drag: float = 1.0
) -> np.ndarray:
    """Weighted, with a load on the pole, and so many times the drag in its bearing."""
    plain = machine.mechanism({**machine.base, "joint.swing.damping": drag * TURN}, trial)
    made = plain.with_load(Load("link.pole", mass, place)) if mass else plain
    (shown,) = machine.predict(made, trial, np.zeros(0)).blocks
    (block,) = trial.blocks
    return np.concatenate([w * shown[c] for c, w in enumerate(block.weight)])


@pytest.mark.parametrize("there", [0.0, 0.05])
@pytest.mark.parametrize("place", [(0.0, 0.0, -FAR), (0.02, 0.0, -0.4)])
def test_readings_rise_as_differences_say(
    loaded: tuple[Machine, ...], there: float, place: tuple[float, float, float]
) -> None:
    for machine in loaded:
        trial, numbers = machine.trials[0], machine.numbers("link.pole", np.array(place))
        near = machine.near({"link.pole": there * numbers}) if there else machine
        step = 1e-4
        by = readings(machine, trial, there + step, place) - readings(machine, trial, there - step, place)
        rises = numbers @ near.felt(trial, "link.pole")
        np.testing.assert_allclose(rises, by / (2.0 * step), atol=1e-6 * np.abs(rises).max())
        moved = readings(machine, trial, there, place) - readings(machine, trial, 0.0, place)
        np.testing.assert_allclose(near.bent(trial) + there * rises, moved, atol=1e-6 * np.abs(rises).max())


def test_a_pole_of_more_of_the_same_swings_alike(loaded: tuple[Machine, ...]) -> None:
    _, swing = loaded
    trial = swing.trials[0]
    once = readings(swing, trial, 0.0, None)
    for share in (-0.9, -0.5, 0.5, 2.0):
        alike = readings(swing, trial, share * POLE, None, 1.0 + share)
        np.testing.assert_allclose(alike, once, atol=1e-5 * np.abs(once).max())
    aside = readings(swing, trial, 0.5 * POLE, (0.0, 0.0, -0.1), 1.5) - once  # a body elsewhere is told
    assert np.abs(aside).max() > np.abs(once).max()


Shapes = dict[tuple[str, str], str]


@pytest.fixture(scope="module")
def shapes(loaded: tuple[Machine, ...]) -> Shapes:
    effects = list(all_effects().values())
    parts = [alone(machine, effects) for machine in loaded]
    found = shapes_of(loaded, effects, lambda which, places, near: [felt_by(parts[k], places, near) for k in which])
    return dict(found)


def test_the_load_is_found_by_cart_and_pole_together(shapes: Shapes) -> None:
    ((name, where),) = shapes
    assert (name, where) == ("link_load", "link.pole")
    place = np.array(shape_of(shapes[name, where]))
    np.testing.assert_allclose(place[[0, 2]], [0.0, -FAR], atol=0.003)
    assert place[1] == 0.0  # across the plane that it swings in nothing tells


def test_where_it_is_shares_in_how_heavy_it_may_be(loaded: tuple[Machine, ...], shapes: Shapes) -> None:
    (form,) = shapes.values()
    grown = [grow(told(m, shapes), effects=[effect("link_load")]) for m in loaded]
    named = [(g.bench, g.after.fit, site) for g in grown for site in g.after.sites]
    assert len(named) == len(loaded)
    spread = spread_of(named)
    assert spread.wider > 1.0
    x, _, z = np.abs(np.array(shape_of(form)) - [0.0, 0.0, -FAR])
    assert x < 3.0 * spread.shape["x_m"] < 0.003
    assert z < 3.0 * spread.shape["z_m"] < 0.003
    assert spread.shape["y_m"] == np.inf
    slide, _ = (fit.values()[site.key("mass_kg")] for _, fit, site in named)
    assert abs(slide - LOAD) < 3.0 * spread.held * spread.wider < 0.1 * LOAD
    twice = spread_of([*named, *named])  # as much again tells the square root of two better
    assert twice.held * np.sqrt(2.0) == pytest.approx(spread.held, rel=1e-6)
    assert twice.shape["z_m"] * np.sqrt(2.0) == pytest.approx(spread.shape["z_m"], rel=1e-6)
