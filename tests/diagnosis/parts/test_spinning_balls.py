"""A ball that spins curves: about whatever axis, along whatever axes it is tracked, and whether the spin is logged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.body_axes import spins_of
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import PLACES
from spacerobot.effects.primitives import Coordinate
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.simulation.reduced.run import simulate

MASS, DRAG, MAGNUS, CAMERA, GYRO = 0.06, 4e-4, 4e-4, 1e-3, 0.3
APPROACHES = ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, 0, -1])


def turning(time: np.ndarray, spin: np.ndarray, tumbles: bool) -> np.ndarray:
    """Spins in a flight, shape (T, 3)."""
    if not tumbles:
        return np.tile(spin, (time.size, 1))
    return np.linalg.norm(spin) * np.stack([np.cos(5.0 * time), np.sin(5.0 * time), 0.1 + 0.0 * time], axis=1)


def thrown(folder: Path, *, approach: list[int], logged: bool, tumbles: bool = False, camera: float = CAMERA) -> Study:
    """Six throws of a ball; one spin for all unless it is logged."""
    random = np.random.default_rng(5)
    time, common = np.arange(0.0, 1.0, 1.0 / 120.0), np.array([12.0, -25.0, 30.0])
    text = (
        f'format = 1\ntitle = "Spin"\n[baseline]\nbase = "free"\napproach = {approach}\ngravity = [0, 0, -9.80665]\n'
        f'[baseline.body]\nmass = {MASS}\n[streams.camera]\ntime = "t"\n[streams.camera.channels]\n'
    )
    text += "".join(f'{a} = {{ is = "body.position.{a}", sigma = {camera} }}\n' for a in "xyz")
    if logged:
        text += "".join(f'w{a} = {{ is = "body.angular_velocity.{a}", sigma = {GYRO} }}\n' for a in "xyz")
    for n in range(6):
        spin = random.normal(0.0, 25.0, 3) if logged else common
        start = np.concatenate([[0.0, 0.0, 1.5], np.array([4.0, 4.0, 2.0]) + random.normal(0.0, 3.0, 3)])

        def rate(_: float, s: np.ndarray, spin: np.ndarray = spin) -> np.ndarray:
            v = s[3:]
            return np.concatenate(
                [v, [0, 0, -9.80665] + (MAGNUS * np.cross(spin, v) - DRAG * np.linalg.norm(v) * v) / MASS]
            )

        path = solve_ivp(rate, (0.0, 1.0), start, t_eval=time, rtol=1e-9, atol=1e-9).y[:3].T
        spins = turning(time, spin, tumbles) + GYRO * random.standard_normal((time.size, 3))
        rows = np.column_stack([time, path + camera * random.standard_normal(path.shape), spins])
        np.savetxt(folder / f"{n}.csv", rows, delimiter=",", header="t,x,y,z,wx,wy,wz", comments="")
        text += f'[[trials]]\nid = "{n}"\ncamera = "{n}.csv"\n'
    (folder / "study.toml").write_text(text)
    return load_study(folder)


@pytest.mark.parametrize("approach", APPROACHES)
def test_whichever_axes_it_is_tracked_along_the_same_physics_foretells_it(approach: list[int], tmp_path: Path) -> None:
    """A cross product does not look the same in left-handed axes."""
    (model,) = models_for(thrown(tmp_path, approach=approach, logged=True, camera=1e-5))
    trial = model.trials[0]
    known = (("quadratic_drag", "coefficient_Ns2_m2", DRAG), ("magnus", "coefficient_kg", MAGNUS))
    left = {}
    for sign in (1.0, -1.0):
        machine = model.mechanism(model.believed.values, trial)
        for name, parameter, value in known:
            machine = effect(name).apply(machine, "target", {parameter: sign * value if name == "magnus" else value})
        start = np.array([n.guess for n in model.nuisances(trial)])
        blocks = model.predict(machine, trial, start).blocks
        errors = [b - t.value for b, t in zip(blocks, trial.blocks, strict=True) if "position" in t.channels[0]]
        left[sign] = float(np.sqrt(np.mean(np.square(errors))))
    assert left[-1.0] > 10.0 * left[1.0]


def test_lift_turns_the_path_and_does_no_work() -> None:
    """dv/dt = W x v: Rodrigues' rotation about W at |W| / m."""
    still = Mechanism(
        coordinates={n: Coordinate(n, MASS) for n in PLACES}, ports={n: {n: 1.0} for n in PLACES}, forces=()
    )
    lift, start = np.array([0.03, -0.05, 0.02]), np.array([3.0, -1.0, 2.0])
    machine = still
    for where, c in zip(still.coordinates, lift, strict=True):
        machine = effect("lift").apply(machine, where, {"coefficient_Ns_m": float(c)})
    speeds = dict(zip(still.coordinates, start.tolist(), strict=True))
    run = simulate(machine, position={}, velocity=speeds, start=0.0, end=2.0, tolerance=1e-11)
    found = run.sample(np.array([2.0])).velocity[0]
    axis, angle = lift / np.linalg.norm(lift), 2.0 * np.linalg.norm(lift) / MASS
    turned = (
        start * np.cos(angle) + np.cross(axis, start) * np.sin(angle) + axis * (axis @ start) * (1.0 - np.cos(angle))
    )
    np.testing.assert_allclose(found, turned, atol=1e-8)


def test_no_lift_is_none() -> None:
    still = Mechanism(
        coordinates={n: Coordinate(n, MASS) for n in PLACES}, ports={n: {n: 1.0} for n in PLACES}, forces=()
    )
    for where in PLACES:
        for force in effect("lift").apply(still, where, effect("lift").nulls).forces:
            assert force.kernel.force(0.3, 2.0, 0.1, force.p) == 0.0


def test_what_tumbles_has_no_steady_spin(tmp_path: Path) -> None:
    (tmp_path / "ball").mkdir()
    (tmp_path / "box").mkdir()
    ball = thrown(tmp_path / "ball", approach=[1, 0, 0], logged=True)
    box = thrown(tmp_path / "box", approach=[1, 0, 0], logged=True, tumbles=True)
    assert len(spins_of(ball, ball.trials, "body")) == 3
    assert not spins_of(box, box.trials, "body")


@pytest.mark.slow
@pytest.mark.parametrize("approach", [APPROACHES[0], APPROACHES[3]])
def test_the_lift_of_a_logged_spin_is_named(approach: list[int], tmp_path: Path) -> None:
    verdict = diagnose(thrown(tmp_path, approach=approach, logged=True), jobs=1).verdict
    assert verdict["verdict"] == "named"
    found = {e["effect"]: next(iter(e["parameters"].values()))["value"] for e in verdict["effects"]}
    assert found == pytest.approx({"magnus": MAGNUS, "quadratic_drag": DRAG}, rel=0.03)


@pytest.mark.slow
def test_and_of_one_that_nobody_logged(tmp_path: Path) -> None:
    verdict = diagnose(thrown(tmp_path, approach=[1, 0, 0], logged=False), jobs=1).verdict
    assert verdict["verdict"] == "named"
    found = {
        e["where"]: e["parameters"]["coefficient_Ns_m"]["value"] for e in verdict["effects"] if e["effect"] == "lift"
    }
    expected = {"target": 12.0, "target.y": -25.0, "target.z": 30.0}
    assert found == pytest.approx({k: MAGNUS * w for k, w in expected.items()}, rel=0.05)
    assert [e["effect"] for e in verdict["effects"] if e["effect"] != "lift"] == ["quadratic_drag"]
