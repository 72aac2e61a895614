"""What moves at the start: base, joints and carried bodies, against momenta, Jacobians and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.simulation.parts import EffectAt, Motion, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError

CHASER = Scene(robot="chaser_pa10_wrist", joints="free", target=Target(mass=9.0, speed=0.1, gap=0.01), duration=0.4)
RATES = st.floats(-0.2, 0.2)


def slosh(mass: float = 2.0, hertz: float = 1.5, damping: float = 0.0) -> EffectAt:
    return EffectAt("hidden_oscillator", "target", {"mass_kg": mass, "frequency_Hz": hertz, "damping_ratio": damping})


@settings(max_examples=6, derandomize=True, deadline=None)
@given(st.tuples(RATES, RATES, RATES), st.tuples(*[RATES] * 7))
def test_momentum_at_the_start_is_that_of_the_stated_rates(spin: tuple[float, ...], rates: tuple[float, ...]) -> None:
    """By Pinocchio on the scene's own robot, and kept through the touch."""
    chain = CHASER.prepared.chain
    drift = tuple(spin[::-1])
    motion = Motion(base_velocity=drift, base_spin=spin, joint_rates=dict(zip(chain, rates, strict=True)))
    scene = replace(CHASER, motion=motion, hand_speed=0.03)
    robot = scene.prepared
    v = np.zeros(robot.model.nv)
    v[:3], v[3:6] = np.array(drift) - 0.03 * np.array(scene.approach), spin
    for name, rate in motion.joint_rates.items():
        v[robot.velocity_index(name)] = rate
    data = robot.model.createData()
    momentum = pin.computeCentroidalMomentum(robot.model, data, scene.start, v)
    run = simulate(scene, backend="multibody", must_touch=False, rate=100.0)
    ours = run["momentum.x"]
    whole = momentum.linear[0] + 9.0 * 0.1 * scene.approach[0]
    assert ours[0] == pytest.approx(whole, rel=1e-9, abs=1e-12)
    assert ours[-1] == pytest.approx(whole, rel=1e-7, abs=1e-8)


def test_the_tip_nears_the_target_as_its_jacobian_says() -> None:
    motion = Motion((0.01, 0.002, 0.0), base_spin=(0.0, 0.02, -0.01), joint_rates={"S2": 0.05, "E1": -0.03})
    scene = replace(CHASER, motion=motion)
    step = 1e-6
    robot, q = scene.prepared, scene.start
    v = np.zeros(robot.model.nv)
    v[:6] = *motion.base_velocity, *motion.base_spin
    for name, rate in motion.joint_rates.items():
        v[robot.velocity_index(name)] = rate
    frame, data = robot.frame_id(str(robot.contact)), robot.model.createData()
    ends = []
    for side in (-step, step):
        pin.framesForwardKinematics(robot.model, data, pin.integrate(robot.model, q, side * v))
        ends.append(np.array(data.oMf[frame].translation))
    np.testing.assert_allclose(scene.tip_velocity, (ends[1] - ends[0]) / (2 * step), atol=1e-9)
    assert scene.closing_speed == pytest.approx(0.1 - scene.tip_velocity @ np.array(scene.approach))


@settings(max_examples=8, derandomize=True, deadline=None)
@given(st.floats(-0.02, 0.02), st.floats(-0.1, 0.1), st.sampled_from(["reduced", "multibody"]))
def test_a_body_that_sloshes_before_the_touch_swings_by_its_closed_form(
    displacement: float, rate: float, backend: str
) -> None:
    """Two bodies on a spring swing at omega sqrt(1 + m / (M - m)); their centre goes on."""
    mass, share, hertz = 9.0, 2.0, 1.5
    scene = Scene(
        target=Target(mass=mass, speed=0.05, gap=0.5),
        motion=Motion(carried={"target.slosh": (displacement, rate)}),
        duration=1.0,
        effects=(slosh(share, hertz),),
    )
    run = simulate(scene, backend=backend, must_touch=False, rate=200.0, tolerance=1e-11)
    omega = 2 * np.pi * hertz * np.sqrt(1 + share / (mass - share))
    t, part = run.time, share / mass
    apart = displacement * np.cos(omega * t) + rate / omega * np.sin(omega * t)
    # the shell: the common centre less the rider's share of what is between them
    centre = part * displacement + (0.05 + part * rate) * t
    moved = run["target.x"] - run["target.x"][0]
    np.testing.assert_allclose(moved, centre - part * apart, atol=2e-8)


def test_both_backends_agree_on_a_body_that_sloshes() -> None:
    scene = Scene(
        wrist=Wrist(stiffness=530.0, damping=2.0),
        target=Target(mass=9.0, speed=0.1, gap=0.004),
        motion=Motion(carried={"target.slosh": (0.01, -0.05)}),
        duration=0.7,
        effects=(slosh(damping=0.05),),
    )
    a, b = (simulate(scene, backend=name, tolerance=1e-10).restitution.target for name in ("reduced", "multibody"))
    still = simulate(replace(scene, motion=Motion()), backend="reduced").restitution.target
    assert a == pytest.approx(b, abs=1e-7)
    assert abs(a - still) > 1e-3


def test_a_scene_file_keeps_it() -> None:
    carried = {"target.slosh": (0.01, 0.0)}
    motion = Motion((0.0, 0.02, 0.0), base_spin=(0.0, 0.1, 0.0), joint_rates={"S1": 0.2}, carried=carried)
    scene = replace(CHASER, motion=motion, effects=(slosh(),))
    assert scene_from_text(scene.to_toml()).motion == motion
    assert "motion" not in CHASER.to_toml()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"robot": "pa10_wrist", "motion": Motion(base_spin=(0, 0, 0.1))}, "only a free base spins"),
        ({"robot": "pa10_wrist", "motion": Motion(base_velocity=(0, 0.1, 0))}, "only a free base moves"),
        ({"joints": "locked", "motion": Motion(joint_rates={"S1": 0.1})}, "locked joints do not move"),
        ({"motion": Motion(joint_rates={"S9": 0.1})}, "unknown joint"),
        ({"motion": Motion(carried={"target.slosh": (0.1, 0.0)})}, "unknown carried body"),
        ({"backend": "reduced", "motion": Motion(joint_rates={"S1": 0.1})}, "at rest in the pose"),
    ],
)
def test_what_cannot_move_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(CHASER, **{"base": None, **changed})  # type: ignore[arg-type]


def test_servos_take_hold_of_joints_that_move() -> None:
    scene = Scene(
        joints="servo",
        servo=Servo(stiffness=1e4, damping=200.0),
        target=Target(mass=9.0, speed=0.1, gap=0.05),
        motion=Motion(joint_rates={"S2": 0.1}),
        duration=0.4,
    )
    run = simulate(scene, backend="multibody", must_touch=False, rate=1000.0)
    speed = run["joint.S2.velocity"]
    assert speed[0] == pytest.approx(0.1)
    assert abs(speed[run.time > 0.2]).max() < 0.03
