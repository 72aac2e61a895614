"""Scenes to and from files, trajectories to and from files, and the command that makes them."""

from __future__ import annotations

import json
import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import spacerobot
from spacerobot.cli.main import main
from spacerobot.model.library import load
from spacerobot.model.spacecraft import SpacecraftSpec
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError, NotFoundError

FULL = Scene(
    robot="pa10_wrist",
    base="free",
    joints="servo",
    servo=Servo((1e4,) * 7, 10.0),
    pose=(0.1, 0.7, 0.0, 1.5, 0.0, -0.8, 0.2),
    approach=(0.6, 0.0, 0.8),
    gravity=(0.0, 0.0, -0.01),
    wrist=Wrist(0.8, 2000.0, 1.0, 2.0, 0.1),
    contact=ContactLaw(5e4, law="hunt_crossley", chi_over_k=0.2, mu=0.1, adhesion=0.5),
    target=Target(12.0, (0.3, 0.4, 0.5), None, (0.1, 0.02, 0.01), (0.1, 0.0, 0.2), (0.0, 0.1, 0.0), 0.05, 0.01),
    hand_speed=0.01,
    spacecraft=SpacecraftSpec(mass=300.0),
    duration=0.5,
    effects=(EffectAt("coulomb_friction", "joint.S2", {"force_Nm": 0.1}),),
    title='a "full" scene',
)


def test_a_scene_survives_its_file(tmp_path: Path) -> None:
    text = FULL.to_toml(tmp_path / "scene.toml")
    again = Scene.from_toml(tmp_path / "scene.toml")
    assert again.to_toml() == text
    for field in fields(Scene):
        if field.name not in ("robot", "servo", "spacecraft", "target"):
            assert getattr(again, field.name) == getattr(FULL, field.name), field.name
    assert (again.target.inertia_matrix() == FULL.target.inertia_matrix()).all()
    assert replace(again.target, inertia=None) == replace(FULL.target, inertia=None)
    assert again.hand.mass == pytest.approx(FULL.hand.mass, rel=1e-12)


def test_the_default_scene_is_the_rig() -> None:
    scene = scene_from_text("")
    assert scene == Scene()
    assert scene.base == "fixed"
    assert np.rad2deg(scene.pose).round(9).tolist() == [0, 45, 0, 90, 0, -45, 0]
    assert math.isinf(scene.hand.mass)


@pytest.mark.parametrize("approach", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (0.48, -0.6, 0.64)])
def test_the_wrist_points_against_the_approach(approach: tuple[float, ...]) -> None:
    import pinocchio as pin

    scene = Scene(approach=approach)
    robot = scene.prepared
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(np.array(scene.pose)))
    outward = data.oMf[robot.frame_id(robot.tip)].rotation[:, 2]
    assert outward == pytest.approx(-np.array(approach), abs=1e-12)
    assert scene.axes.T @ scene.axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(scene.axes) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["pa10", "panda", "ur5", "xarm7"])
def test_any_arm_gets_a_wrist(name: str) -> None:
    found = simulate(Scene(name, target=Target(speed=0.05), wrist=Wrist(stiffness=5000.0)), rate=200.0)
    held = simulate(Scene(target=Target(speed=0.05), wrist=Wrist(stiffness=5000.0)), rate=200.0)
    assert found.restitution.target == pytest.approx(held.restitution.target, abs=1e-9), "a held arm is a held arm"


def test_the_wrist_goes_to_any_frame_and_fingers_stay_where_they_are_put() -> None:
    free = {"joints": "free", "target": Target(speed=0.05), "wrist": Wrist(stiffness=5000.0)}
    masses = []
    for tip, finger in ((None, 0.0), ("panda_link8", 0.0), (None, 0.04)):
        scene = Scene(
            "panda", tip=tip, others={"panda_finger_joint1": finger}, pose=(0, -0.5, 0, -2, 0, 1.5, 0.8), **free
        )
        assert scene_from_text(scene.to_toml()) == scene
        masses.append(scene.hand.mass)
        assert simulate(scene, rate=100.0).restitution.touches > 0
    assert len(set(masses)) == 3


def test_a_robot_made_in_python_will_do() -> None:
    scene = Scene(load("pa10_wrist"), target=Target(speed=0.05), wrist=Wrist(stiffness=5000.0, mass=1.3))
    index = scene.prepared.joint_id("wrist_slider")
    assert scene.prepared.model.inertias[index].mass == 1.3
    assert load("pa10_wrist").model.inertias[index].mass == 0.7, "the original stays what it was"
    assert 'robot = "pa10_wrist"' in scene.to_toml()


def test_names_of_channels_and_units() -> None:
    scene = replace(
        FULL,
        effects=(EffectAt("hidden_oscillator", "target", {"mass_kg": 1.0, "frequency_Hz": 2.0, "damping_ratio": 0.1}),),
    )
    found = simulate(scene, duration=0.3)
    wanted = {"target.x": "m", "target.yaw": "rad", "wrist.x": "m", "hand.x": "m", "contact.force": "N",
              "joint.S2.position": "rad", "joint.S2.velocity": "rad/s", "joint.S2.torque": "N m",
              "base.position.x": "m", "target.position.z": "m", "target.angular_velocity.y": "rad/s",
              "momentum.x": "kg m/s", "angular_momentum.z": "kg m^2/s", "target.slosh": "m",
              "target.yaw.velocity": "rad/s", "target.x.velocity": "m/s", "target.quaternion.w": "1"}  # fmt: skip
    assert wanted.items() <= found.units.items()
    assert set(found.units) == set(found.channels)
    assert all(v.shape == found.time.shape and np.isfinite(v).all() for v in found.channels.values())
    with pytest.raises(NotFoundError, match=r"did you mean 'target\.x'"):
        found["target.X1"]


@pytest.mark.parametrize("backend", ["multibody", "reduced"])
def test_rates_are_the_rates_of_what_they_belong_to(backend: str) -> None:
    scene = Scene(
        "chaser_pa10_wrist",
        joints="free",
        wrist=Wrist(stiffness=2000.0),
        contact=ContactLaw(2e4),
        target=Target(speed=0.05, contact_point=(0.1, 0.02), yaw_inertia=0.3),
    )
    found = simulate(scene, backend=backend, duration=0.1, rate=20000.0)
    for name in [
        n for n in found.channels if n.endswith(".velocity") and n.removesuffix(".velocity") in found.channels
    ]:
        value = found[name.removesuffix(".velocity")]
        slope = np.gradient(value, found.time, edge_order=2)
        scale = max(float(np.abs(found[name]).max()), 1e-6)
        assert np.abs(slope - found[name])[2:-2].max() < 2e-3 * scale, name


def test_target_and_wrist_meet_at_zero() -> None:
    found = simulate(Scene(target=Target(speed=0.1, gap=0.02, contact_point=(0.15, 0.0))), duration=0.3, rate=1e4)
    i = int(np.searchsorted(found.time, found.restitution.first_touch))
    assert found["target.x"][0] == pytest.approx(-0.02)
    assert abs(found["target.x"][i]) < 2e-5
    assert np.abs(found["wrist.x"][:i]).max() < 1e-12
    assert found["wrist.x"].max() > 0.0, "pushed in along the approach"
    assert (found["contact.force"] >= 0.0).all()


def test_a_trajectory_survives_its_file(tmp_path: Path) -> None:
    found = simulate(FULL, duration=0.4)
    again = Trajectory.load(found.save(tmp_path / "run.npz"))
    assert (again.time == found.time).all()
    for kind in ("channels", "measured"):
        ours, theirs = getattr(found, kind), getattr(again, kind)
        assert set(ours) == set(theirs)
        assert all((ours[k] == theirs[k]).all() for k in ours)
    assert again.ledger.closure == found.ledger.closure
    assert set(again.ledger.stored) == set(found.ledger.stored)
    assert again.events == found.events
    assert again.restitution.touches == found.restitution.touches
    assert again.units == found.units
    assert scene_from_text(again.scene).to_toml() == FULL.to_toml()


def test_what_is_no_trajectory_is_refused_and_nothing_half_written_stays(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    found = simulate(Scene(), duration=0.05, must_touch=False)
    found.save(path)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(path)
    np.savez(path, x=np.zeros(3))
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(path)
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(tmp_path / "none.npz")


def test_the_short_names_work() -> None:
    assert spacerobot.Scene is Scene
    assert spacerobot.simulate is simulate


def test_the_command_prints_predicted_beside_simulated(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["simulate", "pa10_wrist", "--wrist-stiffness", "5100", "--equivalent-damping", "9", "--speed", "7e-2"]
    assert main(arguments) == 0
    text = capsys.readouterr().out
    assert "reduced model" in text
    assert "restitution, at the contact point" in text
    assert main([*arguments, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["predicted"]["contact_time"] > 0
    exact, simulated = told["predicted_three_masses"], told["simulated"]
    assert exact["contact_time"] == pytest.approx(simulated["contact_time"], rel=1e-8)
    assert exact["restitution_target"] == pytest.approx(simulated["target"], rel=1e-8)
    assert exact["touches"] == simulated["touches"]
    assert told["hand"]["effective_mass_kg"] == "inf"


def test_the_command_reuses_refuses_and_replaces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    arguments = ["simulate", "pa10_wrist", "--wrist-stiffness", "5100", "--out", str(out), "--json"]
    assert main(arguments) == 0
    first = capsys.readouterr().out
    stamp = (out / "trajectory.npz").stat().st_mtime_ns
    assert main(arguments) == 0
    assert capsys.readouterr().out == first
    assert (out / "trajectory.npz").stat().st_mtime_ns == stamp
    assert main([*arguments, "--speed", "0.05"]) == 2
    assert main([*arguments, "--speed", "0.05", "--overwrite"]) == 0
    capsys.readouterr()
    assert Trajectory.load(out / "trajectory.npz").restitution.touches > 0
    header = (out / "trajectory.csv").read_text().splitlines()[0]
    assert header.startswith("time [s],target.x [m],target.yaw [rad],wrist.x [m]")
    assert main(["simulate", str(out / "scene.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads((out / "simulate.json").read_text())


def test_options_beside_a_file_replace_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Scene(wrist=Wrist(stiffness=5100.0, damping=3.0), target=Target(speed=0.05)).to_toml(tmp_path / "scene.toml")
    changed = ["--wrist-damping", "0", "--backend", "reduced", "--effect", "coulomb_friction@wrist:force_N=0.1"]
    assert main(["simulate", str(tmp_path / "scene.toml"), *changed, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["backend"] == "reduced"
    assert told["predicted"]["damping"] == 0.0
    assert told["effects"] == [{"effect": "coulomb_friction", "where": "wrist", "parameters": {"force_N": 0.1}}]
    assert set(told["energy"]["dissipated_J"]) >= {"coulomb_friction at wrist"}


def test_a_start_in_mid_motion_is_the_same_on_both_backends() -> None:
    """The slider deflected and moving, the target turned and turning: as a recording may begin."""
    scene = Scene(
        wrist=Wrist(stiffness=2000.0, damping=2.0, deflection=0.002, deflection_rate=-0.01),
        contact=ContactLaw(damping=40.0, mu=0.1),
        target=Target(speed=0.06, gap=0.003, contact_point=(0.15, 0.01), yaw_inertia=0.4, attitude=(0.0, 0.0, 0.2),
                      spin=(0.0, 0.0, 0.1)),
    )  # fmt: skip
    many, few = (simulate(scene, backend=b, duration=0.4, tolerance=1e-11) for b in ("multibody", "reduced"))
    assert many["wrist.x"][0] == pytest.approx(0.002)
    assert many["target.yaw"][0] == pytest.approx(0.2)
    assert many["contact.penetration"][0] == pytest.approx(-0.005)
    for name in few.channels:
        if name in many.channels and not name.startswith("momentum"):
            scale = max(float(np.abs(few[name]).max()), 1e-3)
            assert np.abs(few[name] - many[name]).max() < 1e-6 * scale, name
    assert many.restitution.touches == few.restitution.touches > 0
    assert scene_from_text(scene.to_toml()) == scene


def test_a_tip_that_sticks_out_into_the_target_is_refused() -> None:
    with pytest.raises(InputError, match="penetration"):
        Scene(wrist=Wrist(deflection=-0.004), target=Target(gap=0.003))
