"""Of any scene that two backends accept, both give the same; what one does not hold it refuses, with the reason."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.effects.registry import all_effects
from spacerobot.simulation import simulate as front
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError

HELD, MOVING = 2e-5, 0.05
"""Share of the target's travel by which the two may differ: where nothing of the arm moves, what two integrators leave
over a handful of touches; where it does, what the reduced model leaves out by its design: the arm turns with its pose,
and its masses and the wrist's direction with it."""

SHOWN = ("target.x", "wrist.x", "hand.x", "target.y", "wrist.deflection")


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """Scenes of all kinds with up to two effects, most of them in the plane that both backends hold, some beyond it."""
    free = draw(st.booleans())
    joints = draw(st.sampled_from(["locked", "free", "servo"]))
    beyond = draw(st.sampled_from([False] * 5 + [True]))
    off = draw(st.sampled_from(["up", "spin", "gravity"])) if beyond else ""
    still = joints == "locked" and not free
    pulls = [0.0, 0.0, 0.2, -0.1]
    across = 0.0 if free or joints == "free" else draw(st.sampled_from(pulls))
    along = 0.0 if joints == "free" and not free else draw(st.sampled_from(pulls))
    scene = Scene(
        "chaser_pa10_wrist" if free else "pa10_wrist",
        approach=(1.0, 0.0, 0.0),
        joints=joints,
        servo=Servo(10.0 ** draw(st.floats(2.5, 4.5)), draw(st.floats(0.5, 50.0))) if joints == "servo" else None,
        gravity=(along, across, 0.2 if off == "gravity" else 0.0),
        wrist=Wrist(
            mass=draw(st.floats(0.3, 2.0)),
            stiffness=draw(st.floats(500.0, 6000.0)),
            damping=draw(st.floats(0.0, 10.0)),
            guide_friction=draw(st.sampled_from([0.0, 0.0, 0.2])),
        ),
        contact=ContactLaw(
            stiffness=draw(st.floats(2e4, 1e5)),
            damping=draw(st.floats(5.0, 80.0)),
            mu=draw(st.sampled_from([0.0, 0.1, 0.5])) if still or beyond else 0.0,
            bilateral=draw(st.sampled_from([False, False, False, True])),
        ),
        target=Target(
            mass=draw(st.floats(3.0, 20.0)),
            speed=draw(st.floats(0.03, 0.1)),
            contact_point=(0.15, draw(st.sampled_from([0.0, 0.02, -0.03])), 0.02 if off == "up" else 0.0),
            yaw_inertia=draw(st.floats(0.15, 0.5)),
            attitude=(0.0, 0.0, draw(st.sampled_from([0.0, 0.1]))),
            spin=(0.1 if off == "spin" else 0.0, 0.0, draw(st.sampled_from([0.0, 0.15, -0.1]))),
            drift=draw(st.sampled_from([0.0, 0.01, -0.02])),
            gap=draw(st.sampled_from([0.0, 0.003])),
        ),
        hand_speed=draw(st.sampled_from([0.0, 0.02])) if free else 0.0,
        duration=0.4,
    )
    for _ in range(draw(st.integers(0, 2))):
        mechanism = scene.mechanism("multibody")
        sites = [(e, w) for e in all_effects().values() for w in e.places(mechanism) if e.kind != "sensor"]
        if not beyond:
            sites = [(e, w) for e, w in sites if w != "base" and not w.startswith("joint.")]
        effect, where = draw(st.sampled_from(sites))
        values = {p.name: p.starts[0] for p in effect.parameters}
        if "time_s" in values:
            values["time_s"] = 0.05
        with contextlib.suppress(InputError):  # two of one kind, or one where the other took the place
            scene = scene.with_effects(EffectAt(effect.name, where, values))
    return scene


def simulated(scene: Scene, backend: str) -> Trajectory | InputError:
    """A run, or why the backend refuses the scene."""
    try:
        return simulate(replace(scene, backend=backend), tolerance=1e-10, rate=500.0, must_touch=False)
    except InputError as error:
        return error


def apart(few: Trajectory, many: Trajectory) -> dict[str, float]:
    """Largest difference of every channel that both show, over the travel of what travels furthest."""
    shown = [c for c in SHOWN if c in few.channels]
    travel = max(1e-3, *(float(np.ptp(many[c])) for c in shown))
    return {c: float(np.abs(few[c] - many[c]).max()) / travel for c in shown}


def agree(scene: Scene) -> bool | None:
    """Whether both backends give the same; None where one refuses."""
    few, many = simulated(scene, "reduced"), simulated(scene, "multibody")
    for run in (few, many):
        if isinstance(run, InputError):
            assert run.what, "with the reason"
            return None
    assert isinstance(few, Trajectory)
    assert isinstance(many, Trajectory)
    moves = scene.joints != "locked" or scene.base == "free"
    found = apart(few, many)
    limit = MOVING if moves else HELD
    return all(value <= limit for value in found.values())


QUIET: Any = {"deadline": None, "suppress_health_check": list(HealthCheck)}


@pytest.mark.slow
@settings(max_examples=12, derandomize=True, **QUIET)
@given(scene=scenes())
def test_both_backends_say_the_same_or_one_says_why_not(scene: Scene) -> None:
    assert agree(scene) is not False, scene.to_toml()


@pytest.mark.slow
@settings(max_examples=300, derandomize=True, **QUIET)
@given(scene=scenes())
def test_and_so_they_do_over_many_scenes(scene: Scene) -> None:
    assert agree(scene) is not False, scene.to_toml()


PLAIN = Scene(
    wrist=Wrist(stiffness=2000.0, damping=3.0),
    contact=ContactLaw(damping=30.0, mu=0.3),
    target=Target(speed=0.06, contact_point=(0.12, 0.03), yaw_inertia=0.3),
    duration=0.3,
)


@pytest.mark.parametrize("target", [{"spin": (0.0, 0.0, 0.15)}, {"attitude": (0.0, 0.0, 0.1)}, {}])
def test_what_slides_in_a_target_that_turns_is_refused_by_the_model_that_lets_it_slide_along_the_approach(
    target: dict[str, Any],
) -> None:
    """Found drawn at random: they differed by a hundredth of the travel, across. Where nothing turns they agree."""
    slosh = EffectAt("hidden_oscillator", "target", {"mass_kg": 0.5, "frequency_Hz": 2.0, "damping_ratio": 0.03})
    scene = replace(
        PLAIN, contact=ContactLaw(damping=30.0), target=Target(speed=0.06, yaw_inertia=0.3, **target), effects=(slosh,)
    )
    assert agree(scene) is (None if target else True)
    if target:
        with pytest.raises(InputError, match="slides in a target that turns"):
            scene.mechanism("reduced")


def test_a_wrong_backend_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reduced model whose wrist weighs a hundredth more, or that lets the target's yaw go."""
    assert agree(PLAIN) is True
    right = front.simulate_reduced

    def heavier(mechanism: Any, **options: Any) -> Any:
        return right(mechanism.with_mass("wrist", 1.01 * mechanism.coordinates["wrist"].mass), **options)

    monkeypatch.setattr(front, "simulate_reduced", heavier)
    assert agree(PLAIN) is False
