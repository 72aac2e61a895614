"""Bodies that ride on any part of the scene: momentum, energy, and Pinocchio's recursive algorithms beside ours."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force
from spacerobot.simulation.multibody.run import MultibodyRun, integrate_scene
from spacerobot.simulation.multibody.tree import links_of, put_together
from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.result import multibody_ledger
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError

CHASER = Scene(
    "chaser_pa10_wrist",
    joints="free",
    wrist=Wrist(stiffness=530.0, damping=2.0),
    contact=ContactLaw(damping=40.0),
    target=Target(mass=9.0, speed=0.1, gap=0.004, contact_point=(0.15, 0.02), spin=(0.02, 0.0, 0.04)),
    hand_speed=0.02,
)
MASSES = {"target": 2.0, "base": 30.0, "hand": 2.0, "wrist": 0.4}
STIFFNESS, DAMPING = 40.0, 0.8
END = 0.8


def riding(mechanism: Mechanism, carrier: str, *, name: str = "", angular: bool = False) -> Mechanism:
    """A body on a spring in a carrier, further to all that is there."""
    name = name or f"{carrier}.rider"
    under = f"{carrier}.yaw" if angular else carrier
    row = {name: 1.0, **({under: -1.0} if under in mechanism.coordinates else {})}
    return mechanism.with_appendage(
        Coordinate(name, 0.02 if angular else MASSES.get(carrier, 0.5), angular=angular, carrier=carrier),
        name,
        row,
        Force(f"{name}.spring", name, SPRING, (STIFFNESS * (0.01 if angular else 1.0),)),
        Force(f"{name}.damper", name, DAMPER, (DAMPING * (0.01 if angular else 1.0),)),
    )


def everything(scene: Scene) -> Mechanism:
    mechanism = scene.mechanism("multibody")
    for carrier in MASSES:
        mechanism = riding(mechanism, carrier)
    return riding(riding(mechanism, "hand.rider"), "target", name="wheel", angular=True)


def run_with(carrier: str, scene: Scene) -> MultibodyRun:
    mechanism = everything(scene) if carrier == "all" else riding(scene.mechanism("multibody"), carrier)
    return integrate_scene(scene, END, mechanism=mechanism, tolerance=1e-11)


@pytest.mark.parametrize("joints", ["free", "locked"])
@pytest.mark.parametrize("carrier", [*MASSES, "all"])
def test_momentum_and_energy_are_kept(carrier: str, joints: str) -> None:
    run = run_with(carrier, replace(CHASER, joints=joints))
    assert any(e.kind == "touch" for e in run.events)
    taken = run.sample(np.linspace(0.0, END, 81))
    size = float(np.abs(taken.place).max() + 1.0)
    unit = CHASER.target.mass * CHASER.target.speed
    assert np.abs(taken.momentum[:, :3] - taken.momentum[0, :3]).max() < 1e-9 * unit
    assert np.abs(taken.momentum[:, 3:] - taken.momentum[0, 3:]).max() < 1e-9 * unit * size
    ledger = multibody_ledger(run)
    assert np.abs(ledger.imbalance).max() < 1e-9 * 0.5 * unit * CHASER.target.speed
    for name, coordinate in run.mechanism.coordinates.items():
        if coordinate.carrier is not None and not coordinate.angular:
            swing = run.port_values(name, taken, 0)
            assert np.abs(swing).max() > 1e-6, f"{name} was shaken"


@pytest.mark.parametrize("carrier", [*MASSES, "all"])
def test_accelerations_are_those_of_the_articulated_body_algorithm(carrier: str) -> None:
    run = run_with(carrier, CHASER)
    model, dyn = run.assembly.model, run.dynamics
    data, found = model.createData(), np.empty(dyn.size)
    taken = run.sample(np.linspace(0.0, END, 23))
    for k, t in enumerate(taken.time):
        dyn.modes[:] = taken.modes[k]
        dyn.rate(t, np.concatenate([taken.configuration[k], taken.rates[k], np.zeros(dyn.forces)]), found)
        expected = pin.aba(model, data, taken.configuration[k], taken.rates[k], taken.generalized[k])
        ours = found[dyn.nq : dyn.nq + dyn.nv]
        np.testing.assert_allclose(ours, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def by_recursion(scene: Scene, carrier: str, end: float, step: float) -> tuple[float, float]:
    """Displacement of wrist and rider with a prismatic joint put into the robot here, by pin.aba and Runge-Kutta."""
    robot = scene.prepared
    model = robot.model.copy()
    q = scene.start
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    frame = {"hand": robot.tip, "wrist": str(robot.contact)}.get(carrier)
    parent, place = 1, pin.SE3.Identity()
    if frame is not None:
        at = model.frames[model.getFrameId(frame)]
        parent, place = at.parentJoint, pin.SE3(np.eye(3), at.placement.translation)
    axis = data.oMi[parent].rotation.T @ np.array(scene.approach)
    rider = model.addJoint(parent, pin.JointModelPrismaticUnaligned(axis), place, "the rider")
    model.appendBodyToJoint(rider, pin.Inertia(MASSES[carrier], np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    slider = model.joints[model.getJointId(str(robot.slider))]
    model.armature = np.append(robot.model.armature, 0.0)
    data = model.createData()
    q, v = np.append(q, 0.0), np.zeros(model.nv)
    q[slider.idx_q] = scene.wrist.deflection

    def rate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        tau = np.zeros(model.nv)
        tau[slider.idx_v] = -scene.wrist.stiffness * q[slider.idx_q] - scene.wrist.damping * v[slider.idx_v]
        tau[-1] = -STIFFNESS * q[-1] - DAMPING * v[-1]
        return np.array(pin.aba(model, data, q, v, tau))

    for _ in range(round(end / step)):
        a1 = rate(q, v)
        v2 = v + 0.5 * step * a1
        a2 = rate(pin.integrate(model, q, 0.5 * step * v), v2)
        v3 = v + 0.5 * step * a2
        a3 = rate(pin.integrate(model, q, 0.5 * step * v2), v3)
        v4 = v + step * a3
        a4 = rate(pin.integrate(model, q, step * v3), v4)
        q = pin.integrate(model, q, step * (v + 2 * v2 + 2 * v3 + v4) / 6.0)
        v = v + step * (a1 + 2 * a2 + 2 * a3 + a4) / 6.0
    return float(q[slider.idx_q]), float(q[-1])


@pytest.mark.parametrize("carrier", ["base", "hand", "wrist"])
def test_a_prismatic_joint_put_into_the_robot_moves_alike(carrier: str) -> None:
    """The spring is let go with nothing near, and shakes what rides."""
    scene = replace(
        CHASER,
        hand_speed=0.0,
        wrist=replace(CHASER.wrist, deflection=0.01),
        target=replace(CHASER.target, gap=1.0),
    )
    end = 0.4
    run = integrate_scene(scene, end, mechanism=riding(scene.mechanism("multibody"), carrier), tolerance=1e-11)
    taken = run.sample(np.array([end]))
    wrist, rider = by_recursion(scene, carrier, end, 1e-3)
    assert float(taken.slider[0, 0]) == pytest.approx(wrist, abs=1e-8)
    assert float(run.port_values(f"{carrier}.rider", taken, 0)[0]) == pytest.approx(rider, rel=1e-5)


@settings(max_examples=30, derandomize=True, deadline=None)
@given(st.lists(st.integers(0, 20), min_size=2, max_size=9), st.integers(0, 2**32 - 1))
def test_the_composite_inertia_carries_the_kinetic_energy_of_any_tree(parents: list[int], seed: int) -> None:
    """In whatever order the bodies were added; the energy body by body is another algorithm of Pinocchio's."""
    draw = np.random.default_rng(seed)
    pin.seed(seed % 2**31)
    model = pin.Model()
    for i, parent in enumerate(parents):
        kind = pin.JointModelFreeFlyer() if i == 0 else pin.JointModelPrismaticUnaligned(draw.normal(size=3))
        joint = model.addJoint(min(parent, i), kind, pin.SE3.Random(), f"j{i}")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    ordered, q = put_together(links_of(model, pin.neutral(model), np.zeros(model.nv)))
    assert sorted(ordered.names) == sorted(model.names)
    v = draw.normal(size=model.nv)
    inertia = pin.crba(ordered, ordered.createData(), q)
    energy = pin.computeKineticEnergy(ordered, ordered.createData(), q, v)
    assert 0.5 * v @ inertia @ v == pytest.approx(energy, rel=1e-9)


def test_and_a_body_behind_another_branch_would_lose_its_coupling() -> None:
    """Why the order matters, and that the checks above can fail."""
    model = pin.Model()
    for parent, name in ((0, "base"), (0, "target"), (1, "rider")):
        joint = model.addJoint(parent, pin.JointModelPX(), pin.SE3.Identity(), name)
        model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    v = np.ones(3)
    energy = pin.computeKineticEnergy(model, model.createData(), np.zeros(3), v)
    assert energy == pytest.approx(0.5 * (1.0 + 1.0 + 4.0))
    inertia = pin.crba(model, model.createData(), np.zeros(3))
    assert 0.5 * v @ inertia @ v == pytest.approx(energy - 1.0)


def test_a_carrier_that_is_not_there_is_refused() -> None:
    for carrier in ("elbow", "joint.S1", None):
        mechanism = CHASER.mechanism("multibody").with_appendage(
            Coordinate("rider", 1.0, carrier=carrier), "rider", {"rider": 1.0}
        )
        with pytest.raises(InputError, match="target, wrist, hand, base"):
            integrate_scene(CHASER, 0.1, mechanism=mechanism)


def test_what_turns_in_the_target_is_counted_from_the_targets_yaw() -> None:
    mechanism = riding(CHASER.mechanism("multibody"), "target", name="wheel", angular=True)
    assert mechanism.carrier_of("wheel") == "target.yaw"
    run = integrate_scene(CHASER, 0.1, mechanism=mechanism)
    taken, names = run.sample(np.array([0.0])), list(run.mechanism.coordinates)
    speed = taken.velocity[0, names.index("wheel")]
    assert speed == pytest.approx(CHASER.target.spin[2], abs=1e-12)
    assert not math.isclose(speed, CHASER.target.speed)
