"""What must hold whatever is simulated: momentum, the energy ledger, the order, and no event missed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.result import multibody_ledger, of_multibody
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.exact import solve

WRIST = Wrist(stiffness=530.0, damping=2.0)
TUMBLING = Target(
    mass=9.0,
    inertia=((0.3, 0.02, 0.0), (0.02, 0.4, -0.03), (0.0, -0.03, 0.25)),
    contact_point=(0.15, 0.02, -0.03),
    attitude=(0.2, -0.1, 0.3),
    spin=(0.03, -0.02, 0.05),
    speed=0.05,
    gap=0.01,
)
DRIFTING = Scene(
    "chaser_pa10_wrist", joints="free", wrist=WRIST, target=TUMBLING, contact=ContactLaw(damping=40.0), hand_speed=0.01
)


@pytest.mark.parametrize("joints", ["free", "locked", "servo"])
def test_momentum_of_chaser_and_target_is_kept_over_30_s_with_a_collision(joints: str) -> None:
    servo = Servo(30.0, 0.5) if joints == "servo" else None
    scene = replace(DRIFTING, joints=joints, servo=servo)
    run = integrate_scene(scene, 30.0, tolerance=1e-11)
    taken = run.sample(np.linspace(0.0, 30.0, 301))
    assert any(e.kind == "touch" for e in run.events)
    linear, angular = taken.momentum[:, :3], taken.momentum[:, 3:]
    unit = scene.target.mass * scene.target.speed
    size = float(np.linalg.norm(taken.place[0, 3]) + 1.0)
    assert np.abs(linear - linear[0]).max() < 1e-9 * unit
    assert np.abs(angular - angular[0]).max() < 1e-9 * unit * size
    moved = taken.velocity[-1] - taken.velocity[0]
    assert np.abs(moved).max() > 1e-3, "the collision did change the velocities"


def test_momentum_is_not_kept_where_the_base_is_bolted() -> None:
    run = integrate_scene(replace(DRIFTING, robot="pa10_wrist", base="fixed", hand_speed=0.0), 1.0)
    momentum = run.sample(np.array([0.0, 1.0])).momentum
    assert np.abs(momentum[1] - momentum[0]).max() > 1e-2


SLIDES = "hidden_oscillator"
"""In a target that turns the multibody backend alone holds it."""

ELEMENTS = (
    EffectAt("coulomb_friction", "wrist", {"force_N": 0.3}),
    EffectAt("contact_friction", "contact", {"mu": 0.2}),
    EffectAt("viscous_friction", "wrist", {"coefficient_Ns_m": 1.0}),
    EffectAt("cubic_stiffness", "wrist", {"k3_N_m3": 2e5}),
    EffectAt("end_stop", "wrist", {"travel_m": 0.004, "stiffness_N_m": 5e3}),
    EffectAt("viscous_drag", "target", {"coefficient_Ns_m": 0.3}),
    EffectAt("table_tilt", "target", {"angle_rad": 1e-3}),
    EffectAt(SLIDES, "target", {"mass_kg": 1.0, "frequency_Hz": 2.0, "damping_ratio": 0.05}),
    EffectAt("tether", "target", {"stiffness_N_m": 1.0, "slack_m": 0.001}),
    EffectAt("external_impulse", "target", {"impulse_Ns": -0.02, "time_s": 0.31}),
)
PLANAR = replace(
    TUMBLING,
    inertia=(0.3, 0.4, 0.25),
    contact_point=(0.15, 0.02, 0.0),
    attitude=(0.0, 0.0, 0.3),
    spin=(0.0, 0.0, 0.05),
)
"""The same as far as the reduced model holds it."""
HELD = Scene(wrist=WRIST, target=replace(TUMBLING, spin=(0.0, 0.0, 0.05)), contact=ContactLaw(damping=40.0))


@pytest.mark.parametrize("backend", ["multibody", "reduced"])
@pytest.mark.parametrize("count", [0, 1, 2, len(ELEMENTS)])
def test_energy_ledger_closes(backend: str, count: int) -> None:
    scene = HELD if backend == "multibody" else replace(HELD, target=PLANAR)
    acting = [e for e in ELEMENTS[:count] if backend == "multibody" or e.effect != SLIDES]
    trajectory = simulate(scene.with_effects(*acting), backend=backend, duration=1.0, tolerance=1e-11)
    ledger = trajectory.ledger
    assert ledger.closure < 1e-8
    taken = sum(d[-1] for d in ledger.dissipated.values())
    held = sum(s[-1] - s[0] for s in ledger.stored.values())
    assert ledger.kinetic[0] - ledger.kinetic[-1] == pytest.approx(taken + held, abs=1e-8 * ledger.initial)
    lossy = {"wrist.damper", "contact", *(("coulomb_friction at wrist",) if count else ())}
    assert all(ledger.dissipated[name][-1] > 1e-4 * ledger.initial for name in lossy)
    assert all((np.diff(ledger.dissipated[name]) > -1e-9 * ledger.initial).all() for name in lossy)


def test_the_ledger_notices_work_that_no_element_did() -> None:
    ledger = multibody_ledger(integrate_scene(HELD, 0.5))
    short = replace(ledger, work={k: v for k, v in ledger.work.items() if k != "wrist.damper"})
    assert ledger.closure < 1e-8 < short.closure


def test_free_joints_and_servos_close_their_ledger_too() -> None:
    scene = replace(DRIFTING, joints="servo", servo=Servo(2e3, 40.0), gravity=(0.0, 0.02, -0.05))
    scene = scene.with_effects(EffectAt("coulomb_friction", "joint.S2", {"force_Nm": 0.02}))
    ledger = simulate(scene, duration=0.8, tolerance=1e-11).ledger
    assert ledger.closure < 1e-8
    assert {"gravity", "joint.S2.servo_damper", "coulomb_friction at joint.S2"} <= set(ledger.work)


def test_the_order_is_the_one_of_the_method() -> None:
    """Steps of one length while wrist and target press on each other, against much shorter ones."""
    scene = replace(DRIFTING, target=replace(TUMBLING, gap=0.0), spacecraft=None)
    end, counts, errors = 8.0e-3, (2, 3, 4, 6), []
    reference = integrate_scene(scene, end, max_step=end / 64, fixed=True).steps.last
    for parts in counts:
        run = integrate_scene(scene, end, max_step=end / parts, first_step=end, fixed=True)
        assert run.steps.time.size == parts
        assert not run.events, "the law holds between events"
        nq = run.dynamics.nq
        errors.append(float(np.abs(run.steps.last[:nq] - reference[:nq]).max()))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 7.5 < order < 9.0, (order, errors)


RECONTACT = Scene(
    wrist=Wrist(stiffness=5100.0, damping=2.7), contact=ContactLaw(damping=60.0), target=Target(speed=0.07)
)


@pytest.mark.parametrize("exponent", [-3, -4, -6, -8, -10, -12])
def test_no_contact_is_missed_at_any_tolerance(exponent: int) -> None:
    tolerance = 10.0**exponent
    system = ThreeMasses(math.inf, 0.7, 9.0, 5100.0, 2.7, 68000.0, 60.0)
    motion = solve(system, 0.07, duration=0.4)
    trajectory = simulate(RECONTACT, duration=0.4, tolerance=tolerance, rate=100.0)
    touches = [e for e in trajectory.events if (e.element, e.kind) == ("contact", "touch")]
    assert len(touches) == len(motion.times_of("touch"))
    exact = -motion.state(motion.contact_time)[5] / 0.07
    assert abs(trajectory.restitution.target - exact) <= max(tolerance, 1e-11)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-9])
@pytest.mark.parametrize("exponent", [-7, -5, -3, -1])
def test_nor_with_any_first_step(exponent: int, tolerance: float) -> None:
    reference = simulate(RECONTACT, duration=0.4, tolerance=1e-12, rate=100.0)
    found = simulate(RECONTACT, duration=0.4, tolerance=tolerance, first_step=10.0**exponent, rate=100.0)
    assert len(found.events) == len(reference.events)
    assert abs(found.restitution.target - reference.restitution.target) <= tolerance


def test_a_short_graze_inside_a_long_step_is_found() -> None:
    """The slider swings into the path of a target that would be gone at the step's end."""
    scene = Scene(
        wrist=Wrist(stiffness=530.0), target=Target(mass=9.0, speed=0.002, gap=0.012), contact=ContactLaw(damping=5.0)
    )
    mechanism = scene.mechanism()
    from spacerobot.effects.primitives import Impulse

    kicked = mechanism.with_impulse(Impulse("wrist", -0.7 * 0.35, 0.0))
    counts = set()
    for tolerance in (1e-3, 1e-6, 1e-10):
        run = integrate_scene(scene, 0.2, mechanism=kicked, tolerance=tolerance, first_step=0.1)
        counts.add(tuple((e.element, e.kind) for e in run.events))
    assert len(counts) == 1
    assert counts.pop()[0] == ("contact", "touch")


def test_the_start_is_found_again_from_any_face_of_the_world() -> None:
    """Turning approach and base together changes nothing that a wrist could tell."""
    found = []
    for approach, pose in (((1.0, 0, 0), 0.0), ((math.cos(0.7), math.sin(0.7), 0), 0.7)):
        scene = replace(DRIFTING, approach=approach, pose=(pose, *DRIFTING.pose[1:]), spacecraft=None)
        turn = np.array([[math.cos(pose), -math.sin(pose), 0], [math.sin(pose), math.cos(pose), 0], [0, 0, 1]])
        scene = replace(
            scene,
            robot="pa10_wrist",
            base="fixed",
            joints="locked",
            hand_speed=0.0,
            target=replace(TUMBLING, spin=tuple(turn @ np.array(TUMBLING.spin))),
        )
        run = integrate_scene(scene, 0.6, tolerance=1e-11)
        found.append(of_multibody(scene, run, np.linspace(0, 0.6, 61)))
    assert np.abs(found[0]["contact.force"] - found[1]["contact.force"]).max() < 1e-7
    assert found[0].restitution.target == pytest.approx(found[1].restitution.target, abs=1e-9)
