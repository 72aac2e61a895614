"""Whole machines: MuJoCo's chaser beside the project's, and what is hidden in it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacerobot.proof.campaign import perform, write_study
from spacerobot.proof.conceal import MAKERS
from spacerobot.proof.engine.arm import CHAIN, POSE, ArmRig, Servo
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.physics import apply
from spacerobot.proof.engine.rig import Values
from spacerobot.proof.engine.run import Log, run
from spacerobot.proof.engine.sensors import truth_of
from spacerobot.proof.scenes import hideable, scene
from spacerobot.proof.whole.orders import FAMILY, FULL
from spacerobot.recordings.study import load_study
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.parts.servo import Servo as Held
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.sensors import read_channels

pytest.importorskip("mujoco")

GAP, SPEED, END = 0.004, 0.06, 0.45
VALUES = Values(wrist_mass=0.75, wrist_damping=7.0, contact_damping=60.0, target_mass=16.0)
BENT = tuple(f"joint.{j}.position" for j in ("S2", "E1", "W1"))
CHANNELS = ("target.x", "wrist.x", "base.position.x", "base.position.z", "base.pitch", *BENT)


def _theirs(servo: Servo | None, values: Values = VALUES, *missing: Missing) -> Log:
    rig = apply(ArmRig(values, floating=True, servo=servo or Servo(0.0)), missing)
    return run(rig, {"target": -GAP}, {"target": SPEED}, END)


def _apart(log: Log, servo: Held | None, effects: tuple[EffectAt, ...] = ()) -> float:
    """Largest difference of the two, in shares of what a channel goes through; base and joints by the largest."""
    ours = integrate_scene(
        Scene(
            robot="chaser_pa10_wrist",
            base="free",
            joints="free" if servo is None else "servo",
            servo=servo,
            pose=POSE,
            approach=(1.0, 0.0, 0.0),
            wrist=Wrist(mass=VALUES.wrist_mass, stiffness=VALUES.wrist_stiffness, damping=VALUES.wrist_damping),
            contact=ContactLaw(stiffness=VALUES.contact_stiffness, damping=VALUES.contact_damping),
            target=Target(mass=VALUES.target_mass, speed=SPEED, gap=GAP),
            effects=effects,
        ),
        END,
        tolerance=1e-9,
    )
    time = np.linspace(0.0, END, 200)
    shown, truth = read_channels(ours, ours.mechanism, CHANNELS, time), truth_of(log)
    gone = {c: (np.interp(time, *truth[c]) - truth[c][1][0], shown[c] - shown[c][0]) for c in CHANNELS}
    largest = {c.split(".")[0]: max(np.ptp(m) for k, (m, _) in gone.items() if k[:3] == c[:3]) for c in CHANNELS}
    return max(float(np.abs(a - b).max()) / largest[c.split(".")[0]] for c, (a, b) in gone.items())


@pytest.mark.parametrize("held", [False, True])
def test_two_engines_show_the_same_chaser(held: bool) -> None:
    damping = (5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0)
    theirs, ours = (Servo(4000.0, damping), Held((4000.0,) * 7, damping)) if held else (None, None)
    assert _apart(_theirs(theirs), ours) < 5e-5  # of which most is between the steps that MuJoCo shows
    assert _apart(_theirs(theirs, replace(VALUES, wrist_mass=0.76)), ours) > 2e-4


def test_friction_in_a_joint_is_the_same_torque_in_both() -> None:
    """MuJoCo lets what sticks creep a little."""
    servo, held = Servo(4000.0, (8.0,) * 7), Held((4000.0,) * 7, (8.0,) * 7)
    log = _theirs(servo, VALUES, Missing("coulomb_friction", "joint.S2", {"force_Nm": 0.3}))
    effect = EffectAt("coulomb_friction", "joint.S2", {"force_N": 0.3})
    apart = _apart(log, held, (effect,))
    assert apart < 0.1 * _apart(log, held)
    assert apart < 2e-3


def test_what_is_hidden_moves_what_it_is_in_and_reads_back(tmp_path: Path) -> None:
    campaign = scene(FAMILY, np.random.default_rng(4))
    campaign = replace(campaign, trials=campaign.trials[:1])
    hidden = campaign.with_missing(Missing("coulomb_friction", "joint.E1", {"force_Nm": 0.02}))
    plain, other = perform(campaign), perform(hidden)
    (trial,) = plain
    still, rubbed = (x[trial]["encoders"].value["joint.E1.position"] for x in (plain, other))
    assert np.ptp(rubbed) < np.ptp(still)
    write_study(tmp_path, hidden, other)
    study = load_study(tmp_path)
    assert study.baseline.base == "free"
    assert {"joint.E1.position", "base.pitch", "base.position.z", "contact.force"} <= set(study.channels())


def test_there_is_something_to_hide_of_every_kind() -> None:
    campaign = scene(FAMILY, np.random.default_rng(4))
    places = {where for _, where in hideable(campaign)}
    assert "wrist" in places
    assert places - {"wrist"} <= {f"joint.{name}" for name in CHAIN}
    assert set(FULL) <= set(MAKERS)
