"""The whole arm in MuJoCo: its effective mass and its meeting with a target, against the project's own."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.proof.engine.arm import ArmRig, Servo, arm_mass, hand_mass, tip_row
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.physics import apply
from spacerobot.proof.engine.rig import Rig, Values
from spacerobot.proof.engine.run import run
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.scene import Scene

pytest.importorskip("mujoco")

START, SPEED = {"target": -0.005}, {"target": 0.1}


def test_effective_masses_agree() -> None:
    ahead = (1.0, 0.0, 0.0)  # as the engine's target comes
    chaser = Scene(robot="chaser_pa10_wrist", base="free", joints="locked", approach=ahead).hand.mass
    free = Scene(robot="pa10_wrist", base="fixed", joints="free", approach=ahead).hand.mass
    assert arm_mass(floating=True) == pytest.approx(chaser, rel=1e-9)
    assert arm_mass(floating=False) == pytest.approx(free, rel=1e-9)
    assert hand_mass(ArmRig(Values(), floating=True, servo=Servo(1.0))) < 0.1 * chaser


def test_a_welded_arm_is_the_rig() -> None:
    arm = run(ArmRig(Values()), START, SPEED, 0.4)
    bed = run(Rig(Values()), START, SPEED, 0.4)
    assert arm.velocity["target"][-1] == pytest.approx(bed.velocity["target"][-1], abs=2e-5 * 0.1)
    assert abs(arm.hand).max() == 0.0


def test_a_free_chaser_recoils_as_its_effective_mass_says() -> None:
    log = run(ArmRig(Values(), floating=True), START, SPEED, 0.4)
    mechanism = rig(
        {
            "hand.mass": arm_mass(floating=True),
            "wrist.stiffness": 1020.0,
            "wrist.damping": 8.0,
            "contact.damping": 60.0,
        }
    )
    ours = simulate(mechanism, position=START, velocity=SPEED, end=0.4, tolerance=1e-9)
    end = dict(zip(ours.layout.coordinates, ours.sample(np.array([0.4])).velocity[0], strict=True))
    assert log.velocity["target"][-1] == pytest.approx(end["target"], abs=2e-3 * 0.1)
    where = dict(zip(ours.layout.coordinates, ours.sample(np.array([0.4])).position[0], strict=True))
    assert log.hand[-1] == pytest.approx(where["hand"], rel=0.02)


def test_servos_give_way_as_one_spring() -> None:
    """A slow push at the hand meets the servo springs' common stiffness and damping."""
    compliance = Missing("arm_compliance", "arm", {"mass_kg": 7.8, "stiffness_N_m": 1e5, "damping_Ns_m": 300.0})
    arm = apply(ArmRig(Values(wrist_stiffness=300.0, wrist_damping=20.0)), (compliance,))
    assert isinstance(arm, ArmRig)
    row, _ = tip_row()
    assert arm.servo is not None
    give = row / arm.servo.stiffness
    assert 1.0 / float(row @ give) == pytest.approx(1e5)
    assert 1e10 * float(give**2 @ np.array(arm.servo.damping)) == pytest.approx(300.0)
    log = run(arm, START, SPEED, 0.6)
    pushed = 300.0 * log.position["wrist"] + 20.0 * log.velocity["wrist"]
    calm = (log.time > 0.2) & (log.time < 0.5) & (pushed > 1.0)
    assert log.hand[calm].mean() == pytest.approx(pushed[calm].mean() / 1e5, rel=0.02)
