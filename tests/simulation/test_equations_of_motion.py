"""The multibody model of a held arm against the exact solution of Eqs. 2 to 4, and its limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.result import of_multibody
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.exact import solve

SPEED = 0.07
HELD = Scene(
    wrist=Wrist(mass=0.7, stiffness=530.0, damping=1.4, equivalent_damping=6.0, guide_friction=0.0),
    contact=ContactLaw(stiffness=68000.0, damping=60.0),
    target=Target(mass=9.0, speed=SPEED),
)


def masses(scene: Scene, hand: float = math.inf) -> ThreeMasses:
    return ThreeMasses(
        hand,
        scene.wrist.mass,
        scene.target.mass,
        scene.wrist.stiffness,
        scene.wrist.damping + scene.wrist.equivalent_damping,
        scene.contact.stiffness,
        scene.contact.damping,
        scene.wrist.guide_friction,
    )


def gap(scene: Scene, system: ThreeMasses, until: float | None = None) -> float:
    """Largest difference of any of wrist, target and their velocities, over the largest value of each."""
    motion = solve(system, SPEED, duration=0.5)
    end = until or motion.first_release
    run = integrate_scene(scene, end, tolerance=1e-12)
    times = np.linspace(0.0, end * (1.0 - 1e-12), 200)
    taken, state = run.sample(times), motion.state(times)
    names = list(run.mechanism.coordinates)
    worst = 0.0
    for column, name in ((1, "wrist"), (2, "target")):
        for offset, values in ((0, taken.position), (3, taken.velocity)):
            exact = state[:, column + offset]
            worst = max(worst, float(np.abs(values[:, names.index(name)] - exact).max() / np.abs(exact).max()))
    force = motion.contact_force(times)
    return max(worst, float(np.abs(run.contact_force(taken) - force).max() / np.abs(force).max()))


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 0.6, -0.8)], ids=["x", "oblique"])
def test_held_arm_follows_the_equations_through_the_first_contact(direction: tuple[float, ...]) -> None:
    assert gap(replace(HELD, approach=direction), masses(HELD)) < 1e-8


def test_and_through_every_further_one() -> None:
    motion = solve(masses(HELD), SPEED, duration=0.6)
    run = integrate_scene(HELD, 0.6, tolerance=1e-12)
    touches = [e.time for e in run.events if (e.element, e.kind) == ("contact", "touch")]
    assert len(touches) == len(motion.times_of("touch")) - 1 >= 2, "the first one is the start"
    assert touches == pytest.approx(motion.times_of("touch")[1:], rel=1e-8)


def test_a_model_that_is_a_little_wrong_is_seen() -> None:
    wrong = replace(masses(HELD), wrist_damping=7.4 * (1.0 + 1e-6))
    assert gap(HELD, wrong, until=0.05) > 1e-8


@pytest.mark.parametrize("joints", ["free", "locked"])
def test_a_free_chaser_tends_to_the_equations_with_its_mass_in_proportion_to_the_speed(joints: str) -> None:
    """The effective mass is that of the start pose; what the robot moves in the contact goes with the speed."""
    wrist = Wrist(stiffness=1020.0, damping=2.0)
    errors = []
    for speed in (0.04, 0.02, 0.01):
        scene = Scene("chaser_pa10_wrist", joints=joints, wrist=wrist, target=Target(speed=speed))
        motion = solve(masses(scene, scene.hand.mass), speed, duration=0.3)
        run = integrate_scene(scene, motion.first_release, tolerance=1e-11)
        times = np.linspace(0.0, run.end * (1 - 1e-12), 60)
        taken = run.sample(times)
        hand = taken.velocity[:, list(run.mechanism.coordinates).index("hand")]
        exact = motion.state(times)[:, 3]
        errors.append(float(np.abs(hand - exact).max() / np.abs(exact).max()))
    ratios = [errors[i] / errors[i + 1] for i in range(2)]
    assert errors[-1] < 1e-3
    assert all(1.7 < r < 2.4 for r in ratios), (errors, ratios)


def test_a_bare_arm_mass_would_not_do() -> None:
    """With the slider's mass not carried along sideways the difference stays, however slow the hit."""
    scene = Scene("chaser_pa10_wrist", joints="free", target=Target(speed=0.01))
    right = scene.hand.mass
    wrong = replace(scene, wrist=Wrist(mass=1e-6)).hand.mass
    assert abs(wrong / right - 1.0) > 5e-3
    errors = []
    for mass in (right, wrong):
        motion = solve(masses(scene, mass), 0.01, duration=0.3)
        run = integrate_scene(scene, motion.first_release, tolerance=1e-11)
        at = np.array([run.end])
        hand = run.sample(at).velocity[0, list(run.mechanism.coordinates).index("hand")]
        errors.append(abs(float(hand / motion.state(run.end)[3]) - 1.0))
    assert errors[1] > 5.0 * errors[0]


def test_reduced_and_multibody_agree() -> None:
    for scene, limit in (
        (HELD, 1e-8),
        (Scene("chaser_pa10_wrist", joints="free", target=Target(speed=0.005), wrist=HELD.wrist), 1e-3),
        (Scene("chaser_pa10_wrist", target=Target(speed=0.02), wrist=HELD.wrist), 1e-3),
    ):
        many, few = (simulate(scene, backend=b, tolerance=1e-11).restitution for b in ("multibody", "reduced"))
        for name in ("target", "hand"):
            assert getattr(many, name) == pytest.approx(getattr(few, name), abs=limit), (scene.robot, scene.joints)
        assert many.touches == few.touches


def test_restitution_is_told_three_ways() -> None:
    scene = Scene("chaser_pa10_wrist", joints="free", wrist=HELD.wrist, target=Target(speed=0.02, gap=0.002))
    run = integrate_scene(scene, 0.6)
    trajectory = of_multibody(scene, run, np.linspace(0, 0.6, 601))
    told = trajectory.restitution
    assert told.first_touch == pytest.approx(0.1, rel=1e-9)
    after = run.sample(np.array([told.last_separation]))
    names = list(run.mechanism.coordinates)
    hand, target = (float(after.velocity[0, names.index(n)]) for n in ("hand", "target"))
    assert told.target == pytest.approx(-target / 0.02)
    assert told.hand == pytest.approx((hand - target) / 0.02)
    assert told.point == pytest.approx(-float(after.contact[0, 1]) / 0.02)
    assert len({round(x, 2) for x in (told.target, told.hand, told.point)}) == 3, "they differ where the hand moves"
    assert told.contact_time == pytest.approx(told.last_separation - 0.1)
    assert 0 < told.contact_time_summed < told.contact_time
