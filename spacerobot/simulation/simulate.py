"""Simulate a scene on either backend, and get a trajectory."""

from __future__ import annotations

import math
import warnings

import numpy as np

from spacerobot.simulation.extrapolated import ExtrapolationWarning, extrapolated
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.prediction import expected_contact_time
from spacerobot.simulation.reduced.run import simulate as simulate_reduced
from spacerobot.simulation.result import of_multibody, of_reduced
from spacerobot.simulation.room import StartWarning, met_at_start
from spacerobot.simulation.scene import BACKENDS, Scene
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError, NotFoundError

USUAL_SPEED = 0.01
"""Closing speed [m/s] below which the reduced model's absolute errors shrink with the motion."""

USUAL_RATE, USUAL_SAMPLES = 1000.0, 200_000
"""Samples a second [Hz] where nobody says how many; fewer in a run so long that there were more than so many in all."""

MAX_SAMPLES = 2_000_000


LONGEST = 1e6
"""Seconds (eleven days) of a simulation at most."""


def simulate(
    scene: Scene,
    *,
    backend: str | None = None,
    duration: float | None = None,
    tolerance: float = 1e-9,
    rate: float | None = None,
    first_step: float = 1e-4,
    max_step: float = math.inf,
    must_touch: bool = True,
) -> Trajectory:
    """Simulate a scene from its start.

    Args:
        scene: what there is.
        backend: "reduced" or "multibody"; the scene's own if None.
        duration: [s]; the scene's own if None, else long enough for the predicted contact.
        tolerance: of the integration; multibody: relative to the approach speed and the penetration it makes.
        rate: samples a second of the channels [Hz]; `usual_rate` if None.
        first_step, max_step: of the integration [s].
        must_touch: whether a target that never arrives is an error.

    Raises:
        InputError: a value that cannot be, or a target that never arrives.
        SimulationError: the integration could not be finished.
    """
    if met := met_at_start(scene):
        warnings.warn(met, StartWarning, stacklevel=2)
    backend = backend or scene.backend
    if backend not in BACKENDS:
        raise NotFoundError("backend", backend, BACKENDS)
    end = duration if duration is not None else scene.duration
    end = default_duration(scene) if end is None else end
    if not (math.isfinite(end) and end > 0.0):
        raise InputError("duration must be positive", given=end)
    if end > LONGEST:
        spring = "a stiffer wrist, stiffer servos" if scene.joints == "servo" else "a stiffer wrist"
        raise InputError(
            "the run would last too long",
            given=f"{end:g} s in all",
            valid=f"at most {LONGEST:g} s; {spring}, a lighter or a faster target, or a duration",
            where="duration",
        )
    rate = usual_rate(end) if rate is None else rate
    if not (math.isfinite(rate) and rate > 0.0):
        raise InputError("rate must be positive", given=rate, where="rate")
    if end * rate > MAX_SAMPLES:
        raise InputError(
            f"too many samples for {end:g} s",
            given=f"{rate:g} Hz",
            valid=f"at most {MAX_SAMPLES / end:.3g} Hz, or a shorter duration",
            where="rate",
        )
    times = np.arange(math.floor(end * rate * (1.0 + 1e-12)) + 1) / rate
    if backend == "multibody":
        run = integrate_scene(scene, end, tolerance=tolerance, first_step=first_step, max_step=max_step)
        trajectory = of_multibody(scene, run, times)
    else:
        position, velocity = reduced_start(scene)
        reduced = simulate_reduced(
            scene.mechanism("reduced"),
            position=position,
            velocity=velocity,
            end=end,
            tolerance=tolerance,
            max_step=min(0.05, max_step),
            scale=min(1.0, scene.touching_speed / USUAL_SPEED) or 1.0,
        )
        trajectory = of_reduced(scene, reduced, times)
    if must_touch and trajectory.restitution.touches == 0:
        raise InputError(
            "the target never arrives: wrist and target did not touch",
            given=f"gap {scene.target.gap:g} m, closing speed {scene.closing_speed:g} m/s, {end:g} s simulated"
            + (f", pulled with {scene.pull:g} m/s^2" if scene.pull else ""),
            valid="a longer duration, or a target that is not slowed, turned or driven away before",
        )
    for text in extrapolated(scene, trajectory):
        warnings.warn(text, ExtrapolationWarning, stacklevel=2)
    return trajectory


def reduced_start(scene: Scene) -> tuple[dict[str, float], dict[str, float]]:
    """Initial positions and velocities of the reduced model's coordinates [m, rad, m/s, rad/s]."""
    mechanism = scene.mechanism("reduced")
    contact, yaw = mechanism.contact, scene.target.attitude[2]
    assert contact is not None
    along, across = contact.turned(yaw)
    position = {
        "wrist": scene.wrist.deflection,
        "target": float(-scene.target.gap - along),
        "target.y": float(-across),
        "target.yaw": yaw,
    }
    velocity = {
        "wrist": scene.wrist.deflection_rate - scene.hand_speed,
        "target": scene.target.speed,
        "target.y": scene.target.drift,
        "target.yaw": float(np.array(scene.target.spin) @ scene.axes[:, 2]),
    }
    if "hand" in mechanism.coordinates:
        velocity["hand"] = -scene.hand_speed
    if scene.hand.arm is not None:
        velocity.update(scene.hand.arm.row(-scene.hand_speed * scene.hand.arm.rigid))
    at, moving = mechanism.at_start(position), mechanism.at_start(velocity)
    for name, (displacement, rate) in scene.motion.carried.items():
        for rider in mechanism.coordinates:
            if mechanism.rides_on(rider, name):
                at[rider] += displacement
                moving[rider] += rate
    return at, moving


def usual_rate(duration: float) -> float:
    """Samples a second [Hz] of a run of so many seconds where nobody says how many."""
    return min(USUAL_RATE, USUAL_SAMPLES / duration)


def default_duration(scene: Scene) -> float:
    """Arrival and four times the predicted contact [s].

    Raises:
        InputError: no contact time can be predicted; the scene must say how long.
    """
    contact = expected_contact_time(scene)
    if not math.isfinite(contact) or not math.isfinite(scene.arrival):
        raise InputError("no contact time can be predicted for this scene", valid="a duration", where="duration")
    return scene.arrival + 4.0 * contact
