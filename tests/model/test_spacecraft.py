from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from spacerobot.model.describe import total_mass
from spacerobot.model.library import load
from spacerobot.model.spacecraft import SpacecraftSpec, float_base
from spacerobot.model.target import TargetSpec, target_body
from spacerobot.model.wrist import attach_wrist
from spacerobot.support.errors import InputError, NotFoundError
from tests.model.laws import ARMS, joint_inertia, placement, random_pose


@pytest.mark.parametrize("name", ARMS)
def test_a_chaser_is_the_arm_on_a_free_body(name: str) -> None:
    """The arm's block of the joint-space inertia is that of the fixed arm; the corner is the composite body."""
    arm = load(name)
    chaser = float_base(arm, SpacecraftSpec(mass=300.0, com=(0.1, -0.05, 0.02)))
    assert chaser.floating
    assert chaser.chain == arm.chain
    assert chaser.tip == arm.tip
    assert chaser.model.armature[6:] == pytest.approx(arm.model.armature)
    assert total_mass(chaser) == pytest.approx(300.0 + total_mass(arm))
    pose = random_pose(arm, 1)
    inertia = joint_inertia(chaser.model, chaser.configuration(pose))
    assert np.allclose(inertia[6:, 6:], joint_inertia(arm.model, arm.configuration(pose)), rtol=0, atol=1e-10)
    assert inertia[:3, :3] == pytest.approx(total_mass(chaser) * np.eye(3), abs=1e-9)


def test_the_bundled_chaser_is_the_function_s() -> None:
    bundled, made = load("chaser_pa10_wrist"), float_base(load("pa10_wrist"))
    q = bundled.configuration(random_pose(bundled, 2), slider=0.01)
    assert np.allclose(joint_inertia(bundled.model, q), joint_inertia(made.model, q), rtol=0, atol=1e-12)


def test_spacecraft_by_measures_name_path_and_text(tmp_path: Path) -> None:
    arm = load("pa10")
    text = load("chaser").urdf
    path = tmp_path / "bus.urdf"
    path.write_text(text, encoding="utf-8")
    q = float_base(arm).configuration(random_pose(arm, 3))
    expected = joint_inertia(float_base(arm, SpacecraftSpec()).model, q)
    for craft in ("chaser", path, str(path), text):
        assert np.allclose(joint_inertia(float_base(arm, craft).model, q), expected, rtol=0, atol=1e-10)


def test_a_floating_urdf_serves_as_spacecraft_and_any_frame_of_it_carries_the_arm() -> None:
    chaser = float_base(load("pa10"), "target", mount="target_contact")
    base = placement(chaser, chaser.configuration(), "pa10_base").translation
    assert base == pytest.approx([0.15, 0, 0])
    assert total_mass(chaser) == pytest.approx(34.2 + 9)


def test_wrist_and_base_go_on_in_either_order() -> None:
    arm = load("panda")
    one, other = float_base(attach_wrist(arm)), attach_wrist(float_base(arm))
    assert (one.slider, one.tip) == (other.slider, other.tip)
    assert sorted(one.model.names) == sorted(other.model.names)
    pose = random_pose(arm, 4)
    masses = [np.linalg.eigvalsh(joint_inertia(r.model, r.configuration(pose))) for r in (one, other)]
    assert masses[0] == pytest.approx(masses[1], rel=1e-9)


@pytest.mark.parametrize("name", ["pa10", "ur5"])
def test_mujoco_reads_the_chaser_s_urdf_with_the_same_bodies(name: str) -> None:
    chaser = float_base(attach_wrist(load(name)))
    urdf = "".join(line for line in chaser.urdf.splitlines(keepends=True) if "mesh" not in line)
    model = mujoco.MjModel.from_xml_string(_without_shapes(urdf))
    assert (model.nv, model.nq) == (chaser.model.nv, chaser.model.nq)
    assert model.body_mass.sum() == pytest.approx(total_mass(chaser))


def _without_shapes(urdf: str) -> str:
    from lxml import etree

    root = etree.fromstring(urdf)
    for link in root.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    return etree.tostring(root, encoding="unicode")


def test_momentum_of_a_free_chaser_is_kept() -> None:
    chaser = load("chaser_pa10_wrist")
    model, data = chaser.model, chaser.model.createData()
    model = model.copy()
    model.gravity = pin.Motion.Zero()
    rng = np.random.default_rng(5)
    q, v = chaser.configuration(random_pose(chaser, 6)), 0.1 * rng.normal(size=model.nv)
    start = pin.computeCentroidalMomentum(model, data, q, v).vector.copy()
    a = pin.aba(model, data, q, v, np.r_[np.zeros(6), rng.normal(size=model.nv - 6)])
    rate = pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a).vector
    assert np.linalg.norm(start) > 1
    assert np.abs(rate).max() < 1e-10 * np.linalg.norm(start), "internal torques change no momentum"


def test_target() -> None:
    spec = TargetSpec(mass=12.0, inertia=(0.3, 0.4, 0.5), contact=(0.15, 0.02, 0.0))
    robot = target_body(spec)
    assert (robot.floating, robot.chain, robot.tip) == (True, (), "target_contact")
    assert joint_inertia(robot.model, robot.configuration()) == pytest.approx(np.diag([12] * 3 + [0.3, 0.4, 0.5]))
    assert placement(robot, robot.configuration(), "target_contact").translation == pytest.approx([0.15, 0.02, 0])
    assert total_mass(load("target")) == TargetSpec().mass


@pytest.mark.parametrize("kind", [SpacecraftSpec, TargetSpec])
@pytest.mark.parametrize(
    ("measures", "message"),
    [
        ({"mass": -1.0}, "mass"),
        ({"mass": 0.0}, "mass"),
        ({"mass": float("nan")}, "finite"),
        ({"mass": "1"}, "mass"),
        ({"size": (1.0, 1.0)}, "size"),
        ({"size": 1.0}, "size"),
        ({"size": ("a", "b", "c")}, "size"),
        ({"size": (1.0, 1.0, float("nan"))}, "size"),
        ({"inertia": "big"}, "inertia"),
        ({"inertia": ((1.0,), (1.0, 2.0))}, "inertia"),
        ({"size": (1.0, 0.0, 1.0)}, "size"),
        ({"inertia": (1.0, 1.0, 3.0)}, "triangle"),
        ({"inertia": (1.0, -1.0, 1.0)}, "positive definite"),
        ({"inertia": (1.0, 1.0)}, "inertia"),
        ({"inertia": ((1.0, 0.5, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))}, "symmetric"),
    ],
)
def test_bodies_that_cannot_exist(kind: type, measures: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        kind(**measures)


def test_wrong_uses() -> None:
    arm = load("pa10")
    with pytest.raises(InputError, match="floats already"):
        float_base(load("chaser_pa10_wrist"))
    with pytest.raises(NotFoundError, match="chaser"):
        float_base(arm, "chasr")
    with pytest.raises(NotFoundError, match="arm_mount"):
        float_base(arm, mount="arm_mnt")
    with pytest.raises(InputError, match="robot with joints"):
        float_base(arm, "panda")
    with pytest.raises(InputError, match="share a link name"):
        float_base(load(arm.urdf.replace("link1", "spacecraft")))
