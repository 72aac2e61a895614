"""Impacts, tables and clocks of free bodies: laws of the models' own arithmetic."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.answer.turning import of_turning, turning_unit
from spacerobot.diagnosis.machines.impacts import _impulse
from spacerobot.diagnosis.machines.windows import Drive, commanded
from spacerobot.diagnosis.selection.model_choice import slack
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Readout
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import simulate

MASS, INERTIA = 0.04, 1.3e-5
INVERSE = np.array([1.0 / MASS, 1.0 / MASS, 1.0 / INERTIA])


def impact(mu: float, restitution: float = 0.6) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(0)
    v = np.array([random.normal(0.0, 0.5, 200), -random.uniform(1.0, 3.0, 200), random.normal(0.0, 5.0, 200)])
    ahead, height = random.uniform(-0.005, 0.005, 200), random.uniform(0.02, 0.03, 200)
    n = np.array([np.zeros(200), np.ones(200), ahead])
    d = np.array([np.ones(200), np.zeros(200), height])
    return v, v + INVERSE[:, None] * _impulse(v, n, d, INVERSE, restitution, mu), n, d


def test_without_friction_the_contact_parts_with_the_restitution() -> None:
    before, after, n, _ = impact(0.0)
    np.testing.assert_allclose((n * after).sum(0), -0.6 * (n * before).sum(0), rtol=1e-9)


@pytest.mark.parametrize("mu", [0.05, 0.2, 1.0])
@pytest.mark.slow
def test_an_impact_is_what_many_small_impulses_make_of_it(mu: float) -> None:
    """Coulomb's law at every moment; restitution gives 0.6 of the impulse until the contact is most compressed."""
    before, after, n, d = impact(mu)
    small = 2e-4 * MASS
    for k in range(20):
        v, spent, pressed = before[:, k].copy(), 0, None
        while pressed is None or spent < 1.6 * pressed:
            sliding = d[:, k] @ v
            hold = -(d[:, k] @ (INVERSE * n[:, k])) / (d[:, k] @ (INVERSE * d[:, k])) - sliding / (
                small * (d[:, k] @ (INVERSE * d[:, k]))
            )  # would end the sliding at once
            v = v + small * INVERSE * (n[:, k] + np.clip(hold, -mu, mu) * d[:, k])
            spent += 1
            if pressed is None and n[:, k] @ v >= 0.0:
                pressed = spent
        assert np.all(np.abs(v - after[:, k]) < [3e-3, 3e-3, 0.3]), k


def test_without_friction_nothing_pulls_sideways() -> None:
    before, after, _, _ = impact(0.0)
    np.testing.assert_allclose(after[0], before[0], atol=1e-12)


def test_enough_friction_stops_the_sliding_and_never_more_than_its_cone() -> None:
    _, after, _, d = impact(50.0)
    np.testing.assert_allclose((d * after).sum(0), 0.0, atol=1e-9)
    before, after, n, d = impact(0.1)
    rows = np.stack([n, d], axis=2).transpose(1, 0, 2)
    momentum = ((after - before) / INVERSE[:, None]).T
    both = np.array(
        [
            np.linalg.lstsq(r * [[1], [1], [1e3]], m * [1, 1, 1e3], rcond=None)[0]
            for r, m in zip(rows, momentum, strict=True)
        ]
    )
    assert np.all(np.abs(both[:, 1]) <= 0.1 * both[:, 0] * (1.0 + 1e-6))


def gliding() -> Mechanism:
    body = {"target": Coordinate("target", 1.2)}
    return Mechanism(
        coordinates=body, ports={"target": {"target": 1.0}}, readouts={"x": Readout("x", "position", "target")}
    )


def test_a_table_that_is_no_bowl_changes_nothing_and_a_bowl_swings() -> None:
    bowl = effect("table_curvature")
    assert bowl.places(gliding()) == ("target",)
    for curvature in (0.0, 0.01):
        edited = bowl.edit(gliding(), "target", {"curvature_rad_m": curvature})
        run = simulate(edited, position={"target": 0.3}, velocity={"target": 0.0}, start=0.0, end=5.0)
        found = run.sample(np.array([5.0]))
        wanted = 0.3 * np.cos(np.sqrt(9.80665 * curvature) * 5.0)
        assert float(np.ravel(found.position)[0]) == pytest.approx(wanted, abs=1e-4)


def test_a_command_comes_out_weaker_and_later() -> None:
    time = np.linspace(0.0, 10.0, 101)
    drive = Drive(time, {"f": np.sin(time)})
    assert drive.through((), 0.0, 10.0) is drive
    weak = drive.through((ChannelMap("f", "gain", 0.5),), 0.0, 10.0)
    np.testing.assert_allclose(weak.value["f"], 0.5 * np.sin(time))
    late = drive.through((ChannelMap("f", "delay", 0.4),), 2.0, 8.0)
    inside = (late.time > 2.0) & (late.time < 8.0)
    np.testing.assert_allclose(late.value["f"][inside], np.sin(late.time[inside] - 0.4), atol=2e-3)


def test_names_and_units_about_an_axis() -> None:
    assert of_turning("force_plus_N") == "force_plus_Nm"
    assert of_turning("coefficient_Ns2_m2") == "coefficient_Nms2_rad2"
    assert of_turning("angle_rad") == "angle_rad"
    assert (turning_unit("N"), turning_unit("N s/m"), turning_unit("kg")) == ("N m", "N m s/rad", "kg m^2")


def test_slack_grows_with_the_baseline() -> None:
    assert slack(1.0, 1.0) == pytest.approx(1.0 / 0.95)
    assert slack(0.1, 10.0) == pytest.approx(0.3)


def test_a_held_command_that_comes_out_sluggish_does_not_hang_on_where_a_run_begins() -> None:
    """Corners of the command lie on multiples of the step: points that moved with the start would leap over them."""
    drive = commanded({"f": (np.arange(0.0, 20.0, 0.125), np.random.default_rng(3).normal(size=160))})
    maps = (ChannelMap("f", "low_pass", 2.0),)
    here, moved = (drive.through(maps, start, 15.0) for start in (10.0, 10.0 - 1e-9))
    at = np.linspace(10.0, 14.9, 500)
    a, b = (np.interp(at, d.time, d.value["f"]) for d in (here, moved))
    np.testing.assert_allclose(a, b, atol=1e-6)
