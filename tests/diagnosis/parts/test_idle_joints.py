"""Joints that nothing drives: gravity acts, torque zero is an answer, friction comes back; nobody asks for a drive."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.diagnosis.fitting.fit_store import Kept
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.moment import with_free_moment
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.dynamics.joint_weight import weight_of
from spacerobot.effects.registry import effect
from spacerobot.model.library import load
from spacerobot.recordings.study import Study, load_study

MASS, ARM, INERTIA = 0.2, 0.15, 2e-4
WHOLE = INERTIA + MASS * ARM**2
DAMPING, COULOMB, QUADRATIC = 1e-4, 6e-4, 2e-5

URDF = f"""<robot name="pendulum">
  <link name="stand"><inertial><mass value="5"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0 0 {ARM}"/><mass value="{MASS}"/>
    <inertia ixx="{INERTIA}" ixy="0" ixz="0" iyy="{INERTIA}" iyz="0" izz="1e-5"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="stand"/><child link="arm"/><axis xyz="1 0 0"/></joint>
</robot>
"""


def swings(coulomb: float, quadratic: float, release: float, time: np.ndarray, constant: float = 0.0) -> np.ndarray:
    """Angles from upright, by another integrator than the package's own."""

    def rate(_: float, y: np.ndarray) -> list[float]:
        q, v = y
        lost = DAMPING * v + coulomb * math.tanh(v / 1e-3) + quadratic * v * abs(v)
        return [v, (MASS * 9.81 * ARM * math.sin(q) - lost + constant) / WHOLE]

    found = solve_ivp(rate, (0.0, time[-1]), [release, 0.0], t_eval=time, rtol=1e-9, atol=1e-10, max_step=0.01)
    return np.asarray(found.y[0])


def pendulum(
    folder: Path, coulomb: float, quadratic: float, extra: str = "", zero: float = 0.0, constant: float = 0.0
) -> Study:
    (folder / "pendulum.urdf").write_text(URDF)
    time = np.arange(0.0, 12.0, 0.02)
    rng = np.random.default_rng(3)
    for n, release in enumerate((1.7, 2.4, 2.8)):
        angle = swings(coulomb, quadratic, release, time, constant) + zero + 2e-4 * rng.standard_normal(time.size)
        rows = "\n".join(f"{t:.4f},{q:.8f}" for t, q in zip(time, angle, strict=True))
        (folder / f"run{n}.csv").write_text(f"t,q\n{rows}\n")
    (folder / "study.toml").write_text(
        f"""format = 1
{extra}
[baseline]
robot = "pendulum.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, -9.81]
[baseline.joint]
hinge.damping = {1.5 * DAMPING}
hinge.torque = 0
[baseline.sigma]
joint.hinge.mass = 0.01
joint.hinge.damping = 0.5
[streams.log]
time = "t"
channels.q = {{ is = "joint.hinge.position", sigma = 2e-4 }}
[[trials]]
each = [0, 2]
id = "run{{n}}"
log = "run{{n}}.csv"
"""
    )
    return load_study(folder)


def test_weight_is_what_the_rigid_body_has() -> None:
    sine, cosine = weight_of(load(URDF), (0.0, 0.0, -9.81), "hinge")
    assert sine == pytest.approx(-MASS * 9.81 * ARM, rel=1e-9)  # counted from upright, where it falls away
    assert cosine == pytest.approx(0.0, abs=1e-12)


def test_a_pendulum_swings_as_another_integrator_says(tmp_path: Path) -> None:
    (model,) = models_for(pendulum(tmp_path, 0.0, 0.0))
    assert isinstance(model, Simulated)
    assert not model.drives
    made = hypothesis(model.believed, ())
    z = made.start({"joint.hinge.damping": DAMPING})
    state = Fitter(model, model.trials).fit(made, warm={"joint.hinge.damping": DAMPING}, max_iterations=8)
    assert state.values()["joint.hinge.damping"] == pytest.approx(DAMPING, rel=0.02)
    assert state.values()["joint.hinge.mass"] == pytest.approx(WHOLE, rel=1e-3)
    assert z.size == 2


def test_the_length_of_a_rollout_is_the_studys(tmp_path: Path) -> None:
    (model,) = models_for(pendulum(tmp_path, 0.0, 0.0, "horizon = 3.0"))
    assert len(model.trials) == 12
    assert all(t.end - t.start <= 3.01 for t in model.trials)


@pytest.mark.slow
def test_dry_friction_and_drag_promise_as_a_pair_what_neither_does_alone(tmp_path: Path) -> None:
    (model,) = models_for(pendulum(tmp_path, COULOMB, QUADRATIC, "horizon = 3.0"))
    bench = Bench(model)
    base = bench.baseline()
    bench.sharpen(base)
    base = bench.again(base)
    sites = [s for s in model.sites() if s.effect.name in ("coulomb_friction", "quadratic_damping", "preload")]
    first = {p.site.effect.name for p in bench.pairs(base, sites)[0]}
    assert first == {"coulomb_friction", "quadratic_damping"}
    (one, two) = bench.pairs(base, sites)[0]
    fit = bench.fitted_as(base, (one.site, two.site), {**one.start, **two.start})
    assert fit is not None
    found = fit.values()
    assert found["coulomb_friction@joint.hinge.force_N"] == pytest.approx(COULOMB, rel=0.1)
    assert found["quadratic_damping@joint.hinge.coefficient_Ns2_m2"] == pytest.approx(QUADRATIC, rel=0.1)


ZERO = 0.004
"""Of an encoder, set by eye [rad]."""


def test_the_zero_of_an_encoder_shows_in_the_weight(tmp_path: Path) -> None:
    (model,) = models_for(pendulum(tmp_path, 0.0, 0.0, zero=ZERO))
    assert set(model.moment) == {"joint.hinge.zero"}
    free = model.moment_free()
    assert free is not None
    fit = Fitter(free, free.trials).fit(hypothesis(free.believed, ()), max_iterations=8)
    assert fit.values()["joint.hinge.zero"] == pytest.approx(ZERO, rel=0.02)


def test_a_stated_zero_is_where_it_is_stated(tmp_path: Path) -> None:
    pendulum(tmp_path, 0.0, 0.0, zero=ZERO)
    text = (tmp_path / "study.toml").read_text().replace("hinge.torque = 0", f"hinge.torque = 0\nhinge.zero = {ZERO}")
    (tmp_path / "study.toml").write_text(text)
    (model,) = models_for(load_study(tmp_path))
    assert not model.moment
    made = hypothesis(model.believed, ())
    fit = Fitter(model, model.trials).fit(made, warm={"joint.hinge.damping": DAMPING}, max_iterations=8)
    assert fit.chi2 < 1.2 * fit.samples


@pytest.mark.parametrize(("zero", "constant"), [(ZERO, 0.0), pytest.param(0.0, 4e-4, marks=pytest.mark.slow)])
def test_friction_of_two_levels_is_one_beside_a_zero_but_not_beside_a_push(
    zero: float, constant: float, tmp_path: Path
) -> None:
    """Near the bottom a zero that is off pushes as a constant does, high up it does not."""
    (model,) = models_for(pendulum(tmp_path, COULOMB, 0.0, "horizon = 4.0", zero, constant))
    names = ("asymmetric_friction", "coulomb_friction")
    growth = grow(model, effects=[effect(n) for n in names], most=2)
    assert growth.after.label == (("asymmetric_friction", "joint.hinge"),)
    free = with_free_moment(growth, Kept(None, ""))
    assert (free is not None) == bool(zero)


def test_of_several_idle_joints_the_balance_is_against_no_torque(tmp_path: Path) -> None:
    study = pendulum(tmp_path, 0.0, 0.0)
    text = (tmp_path / "study.toml").read_text().replace('"pendulum.urdf"', '"two.urdf"')
    second = URDF.replace("</robot>", "") + URDF.split("</link>", 1)[1].replace('"arm"', '"lower"').replace(
        '"stand"', '"arm"'
    ).replace('"hinge"', '"elbow"')
    (tmp_path / "two.urdf").write_text(second)
    text = text.replace("hinge.torque = 0", "hinge.torque = 0\nelbow.torque = 0")
    text = text.replace(
        'channels.q = { is = "joint.hinge.position", sigma = 2e-4 }',
        'channels.q = [{ is = "joint.hinge.position" }, { is = "joint.elbow.position", scale = 0.1 }]',
    )
    (tmp_path / "study.toml").write_text(text)
    models = models_for(load_study(tmp_path))
    assert [m.name for m in models] == ["hinge", "elbow"]
    for model in models:
        assert isinstance(model, InverseDynamics)
        assert all((t.blocks[0].value == 0.0).all() for t in model.trials)
        assert not any(s.effect.kind == "sensor" for s in model.sites())  # there is no sensor to be wrong
    assert study.value("joint.hinge.torque") == 0.0
