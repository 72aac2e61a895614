"""Hours of floating: momentum, energy, unit attitudes and straight lines are kept, or the run is refused in words."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.simulation.multibody import integrate
from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.reduced.run import simulate as reduced
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import SimulationError

HOUR = 3600.0
SPEED = 0.07
DAMPED = {"wrist": Wrist(damping=20.0), "contact": ContactLaw(stiffness=68000.0, damping=60.0)}


def kept(found: Trajectory, share: float) -> None:
    """Momenta within a share of the largest, quaternions of length one, energy accounted for."""
    for momentum in (found.linear_momentum, found.angular_momentum):
        assert momentum is not None
        assert np.ptp(momentum, axis=0).max() < share * np.abs(momentum).max()
    for body in ("target", "base"):
        quaternion = np.array([found[f"{body}.quaternion.{a}"] for a in "xyzw"])
        np.testing.assert_allclose(np.sum(quaternion**2, axis=0), 1.0, atol=1e-12)
    assert found.ledger.closure < 1e-8


def off_a_line(found: Trajectory, first: float) -> float:
    """How far the target's centre leaves a straight line at constant speed, from `first` [s] on [m]."""
    after = found.time > first
    time = found.time[after]
    worst = 0.0
    for axis in "xyz":
        place = found[f"target.position.{axis}"][after]
        worst = max(worst, float(np.abs(place - np.polyval(np.polyfit(time, place, 1), time)).max()))
    return worst


def test_a_tumbling_body_drifts_towards_a_chaser_for_hours() -> None:
    """Three different moments of inertia: its axis of rotation wanders for ever, its momentum does not.

    But for the tolerance: the wrist, stiff and at rest, is stepped over, steps are as long as the rotation allows.
    """
    end = 2.0 * HOUR
    target = Target(mass=9.0, speed=SPEED, gap=2.0 * SPEED * end, spin=(0.05, 0.01, 0.02),
                    inertia=((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.25)))  # fmt: skip
    scene = Scene("chaser_pa10_wrist", approach=(1, 0, 0), joints="locked", target=target, backend="multibody")
    found = simulate(scene, duration=end, rate=0.05, tolerance=1e-10, must_touch=False)
    kept(found, 1e-9)
    start = found["target.position.x"][0]
    assert found["target.position.x"][-1] - start == pytest.approx(SPEED * found.time[-1], rel=1e-12)
    assert off_a_line(found, 0.0) < 1e-9
    rates = np.array([found[f"target.angular_velocity.{a}"] for a in "xyz"])
    assert np.ptp(rates, axis=1).min() > 1e-3, "it does tumble"


def test_hours_after_a_hit_in_the_reduced_model() -> None:
    scene = Scene("chaser_pa10_wrist", joints="locked", **DAMPED, target=Target(mass=9.0, speed=SPEED, gap=0.01),
                  backend="reduced")  # fmt: skip
    found = simulate(scene, duration=3.0 * HOUR, rate=1.0)
    momentum = (
        scene.target.mass * found["target.x.velocity"]
        + scene.wrist.mass * found["wrist.x.velocity"]
        + scene.hand.mass * found["hand.x.velocity"]
    )
    after = found.time > found.restitution.last_separation
    assert np.ptp(momentum) < 1e-9 * abs(momentum[0])
    speeds = found["target.x.velocity"][after]
    assert np.ptp(speeds) < 1e-12
    place = found["target.x"][after]
    assert place[-1] - place[0] == pytest.approx(speeds[0] * (found.time[after][-1] - found.time[after][0]), rel=1e-9)
    assert found.ledger.closure < 1e-8


@pytest.mark.slow
def test_an_hour_after_a_hit_of_a_free_chaser() -> None:
    scene = Scene("chaser_pa10_wrist", joints="locked", **DAMPED, target=Target(mass=9.0, speed=SPEED, gap=0.01),
                  backend="multibody")  # fmt: skip
    found = simulate(scene, duration=HOUR, rate=0.1)
    kept(found, 1e-10)
    assert off_a_line(found, found.restitution.last_separation) < 1e-8


@pytest.mark.parametrize("backend", ["multibody", "reduced"])
def test_a_spring_that_rings_for_days_is_refused_in_words(backend: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(integrate, "MAX_STEPS", 500)
    assert reduced.__kwdefaults__ is not None
    monkeypatch.setitem(reduced.__kwdefaults__, "step_limit", 20_000)
    scene = Scene("chaser_pa10_wrist", joints="locked", target=Target(mass=9.0, speed=SPEED, gap=0.01))
    with pytest.raises(SimulationError, match=r"too many steps at t = .* of 172800 s: .*give a shorter duration"):
        simulate(scene, duration=48.0 * HOUR, backend=backend)
