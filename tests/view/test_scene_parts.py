"""Solids, looks of robots, springs, camera and scales of scenes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.model.library import bundled, load
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d import solids
from spacerobot.view.scene3d.extent import bounds, gains_for, rotation, round_scale, view_of
from spacerobot.view.scene3d.facing import comes_through, half_turned, placed
from spacerobot.view.scene3d.film import Body, Film, Look, Piece, Readout, View
from spacerobot.view.scene3d.masses import mass_along, mass_ellipsoid
from spacerobot.view.scene3d.meshfiles import read_mesh
from spacerobot.view.scene3d.poses import pose
from spacerobot.view.scene3d.robot_body import frame_poses, robot_bodies
from spacerobot.view.scene3d.robot_film import resting_pose, robot_film
from spacerobot.view.scene3d.wrist_spring import wrist_spring


def volume(solid: solids.Solid) -> float:
    """Signed volume by the divergence theorem: right only for a closed surface seen from outside."""
    a, b, c = (solid.points[solid.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize(
    ("solid", "expected", "within"),
    [
        (solids.box((0.3, 0.2, 0.1)), 0.3 * 0.2 * 0.1, 0.01),
        (solids.cylinder(0.1, 0.3, 80), np.pi * 0.01 * 0.3, 0.01),
        (solids.sphere(0.1, 60, 90), 4.0 / 3.0 * np.pi * 1e-3, 0.01),
        (solids.capsule(0.05, 0.2, 40, 60), np.pi * 0.0025 * 0.2 + 4.0 / 3.0 * np.pi * 0.05**3, 0.01),
        (solids.coil(0.02, 0.001, 6, 1.0, 60, 24), np.pi * 1e-6 * 6 * 2.0 * np.pi * 0.02, 0.15),
    ],
)
def test_solids_are_closed_and_seen_from_outside(solid: solids.Solid, expected: float, within: float) -> None:
    assert volume(solid) == pytest.approx(expected, rel=within)
    np.testing.assert_allclose(np.linalg.norm(solid.normals, axis=1), 1.0, atol=1e-9)
    corners = solid.points[solid.faces]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    along = np.einsum("ij,ij->i", facing, solid.normals[solid.faces].mean(axis=1))
    assert np.all(along > -1e-12)
    assert volume(solids.Solid(solid.points, solid.normals, solid.faces[:, ::-1])) < 0.0


@settings(max_examples=30, derandomize=True)
@given(st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6), st.booleans())
def test_moving_keeps_volume_and_outside_even_mirrored(numbers: list[float], mirrored: bool) -> None:
    place = np.eye(4)
    place[:3, :3] = rotation(np.array([*numbers[:3], 3.5])) @ np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])
    place[:3, 3] = numbers[3:]
    solid = solids.box((0.3, 0.2, 0.1))
    assert volume(solid.moved(place)) == pytest.approx(volume(solid), rel=1e-6)


def test_mesh_files_are_thinned_without_tearing(tmp_path) -> None:  # type: ignore[no-untyped-def]
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    loose = trimesh.Trimesh(ball.triangles.reshape(-1, 3), np.arange(3 * len(ball.faces)).reshape(-1, 3), process=False)
    path = tmp_path / "ball.stl"
    loose.export(path)
    ((solid, _),) = read_mesh(path, 800)
    assert 200 < len(solid.faces) < 1000
    assert volume(solid) == pytest.approx(4.0 / 3.0 * np.pi * 1e-3, rel=0.03)


@pytest.mark.parametrize("content", [b"", b"solid x\nfacet normal nan", b"\0" * 200, b"<COLLADA/>", b"v 1 2\nf 1 2 9"])
@pytest.mark.parametrize("kind", ["stl", "obj", "dae", "glb"])
def test_damaged_meshes_are_no_more_than_missing(tmp_path, content: bytes, kind: str) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / f"damaged.{kind}"
    path.write_bytes(content)
    assert read_mesh(path, 100) == ()


def test_a_mesh_file_cannot_pull_in_others(tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "secret.mtl").write_text("newmtl a\nmap_Kd /etc/hostname\n")
    path = tmp_path / "a.obj"
    path.write_text("mtllib secret.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    ((solid, look),) = read_mesh(path, 100)
    assert len(solid.faces) == 1
    assert look is None
    dae = tmp_path / "a.dae"
    dae.write_text('<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/hostname">]><COLLADA><asset>&e;</asset></COLLADA>')
    assert read_mesh(dae, 100) == ()


@pytest.mark.parametrize("name", bundled())
def test_every_bundled_robot_has_something_to_see(name: str) -> None:
    film = robot_film(load(name))
    assert film.reach > 0.05
    assert sum(len(p.solid.faces) for b in film.bodies for p in b.pieces if p.solid is not None) > 50
    moving = [b for b in film.bodies if np.ptp(b.poses, axis=0).max() > 1e-3]
    assert bool(moving) == bool(load(name).chain or load(name).slider)


def test_a_robot_without_visuals_gets_bones(tmp_path) -> None:  # type: ignore[no-untyped-def]
    inertia = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    robot = load(
        f'<robot name="bare"><link name="a"/><link name="b">{inertia}</link><link name="c">{inertia}</link>'
        '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
        '<limit lower="0.3" upper="1" effort="1" velocity="1"/></joint>'
        '<joint name="k" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    film = robot_film(robot)
    assert {b.name for b in film.bodies} == {"robot/base", "robot/j", "robot/k"}
    low, high = bounds(film.bodies)
    assert high[0] - low[0] > 0.4
    assert resting_pose(robot)[0] > 0.3


def test_joints_stay_within_their_limits_on_tour() -> None:
    robot = load("pa10")
    film = robot_film(robot)
    assert film.marks[0].label == robot.chain[0]
    assert len(film.marks) == len(robot.chain)
    from spacerobot.dynamics.hand_pose import chain_limits
    from spacerobot.view.scene3d.robot_film import _tour

    _, configurations, _ = _tour(robot, resting_pose(robot))
    for i, (low, high) in enumerate(zip(*chain_limits(robot), strict=True)):
        assert low <= configurations[:, i].min() <= configurations[:, i].max() <= high
        assert np.ptp(configurations[:, i]) > 0.1


def test_the_coil_fills_what_the_wrist_leaves_it() -> None:
    robot = load("pa10_wrist")
    pose_ = resting_pose(robot)
    pushed = np.array([0.0, 0.01, 0.03])
    (spring,) = wrist_spring(robot, np.array([robot.configuration(pose_, slider=x) for x in pushed]))
    assert spring.stretch is not None
    np.testing.assert_allclose(spring.stretch[0] - spring.stretch, pushed, atol=1e-12)
    tip = frame_poses(robot, robot.configuration(pose_)[None, :], str(robot.contact))[0, :3]
    axis = rotation(spring.poses[0, 3:])[:, 2]
    end = spring.poses[0, :3] + spring.stretch[0] * axis
    np.testing.assert_allclose(np.cross(tip - end, axis), 0.0, atol=1e-9)
    assert 0.01 < (tip - end) @ axis < 0.05
    assert wrist_spring(load("pa10"), np.zeros((1, 7))) == ()


def test_masses_are_those_of_the_dynamics() -> None:
    from spacerobot.dynamics.effective_mass import effective_mass

    robot = load("pa10_wrist")
    pose_ = resting_pose(robot)
    found = mass_ellipsoid(robot, np.array([robot.configuration(pose_)] * 3), 1.0)
    assert found is not None
    for axis in np.eye(3):
        expected = effective_mass(robot, pose_, axis).effective_mass_kg
        np.testing.assert_allclose(mass_along(found.mobility, axis), expected, rtol=1e-9)


def test_a_held_arm_turned_by_half_keeps_its_wrist() -> None:
    from spacerobot.model.wrist import aim

    approach = np.array([1.0, 0.0, 0.0])
    robot = load("pa10_wrist")
    pose_ = resting_pose(robot)
    robot = aim(robot, pose_, approach)
    assert comes_through(robot, pose_, approach)
    assert not comes_through(robot, pose_, -approach)
    other, place = half_turned(robot, pose_, approach)
    q = robot.configuration(pose_, slider=0.01)[None, :]
    for frame in (str(robot.contact), robot.tip):
        before = frame_poses(robot, q, frame)[0]
        after = frame_poses(other, q, frame)[0]
        np.testing.assert_allclose(place[:3, :3] @ after[:3] + place[:3, 3], before[:3], atol=1e-9)
        axis = place[:3, :3] @ rotation(after[3:])[:, 2]
        np.testing.assert_allclose(axis, rotation(before[3:])[:, 2], atol=1e-9)
        np.testing.assert_allclose(axis, -approach, atol=1e-9)
    base = placed(robot_bodies(other, q), place)[0]
    assert base.poses[0, 0] > frame_poses(robot, q, robot.tip)[0, 0] > 0.0


@settings(max_examples=100, derandomize=True)
@given(st.floats(1e-6, 1e6), st.floats(0.01, 1.0))
def test_scales_are_round_and_near_what_was_asked(largest: float, length: float) -> None:
    scale = round_scale(largest, length)
    units = 0.1 / scale
    mantissa = units / 10.0 ** np.floor(np.log10(units * 1.0000001))
    assert min(abs(mantissa - m) for m in (1.0, 2.0, 5.0, 10.0)) < 1e-6
    assert length / 2.6 <= largest * scale <= length * 1.001


def _ghost(offset: float) -> Body:
    still = np.tile(pose(np.zeros(3), np.eye(3)), (2, 1))
    there = still.copy()
    there[:, 0] += offset
    return Body("g", (Piece(solids.box((0.1, 0.1, 0.1)), Look()),), there, "ghost", np.zeros(2), still)


def test_small_differences_are_enlarged_and_large_ones_are_not() -> None:
    assert gains_for([_ghost(0.0)]) == (1.0,)
    assert gains_for([_ghost(0.2)]) == (1.0,)
    gain, true = gains_for([_ghost(0.0005)])
    assert true == 1.0
    assert 0.02 < gain * 0.0005 < 0.07


def test_a_film_refuses_what_does_not_fit() -> None:
    body = Body("a", (), np.tile(pose(np.zeros(3), np.eye(3)), (2, 1)))
    view = View("Whole", np.zeros(3), 1.0, (1.0, 0.0, 0.0))
    good = {"title": "", "subtitle": "", "description": "", "focus": np.zeros(3), "reach": 1.0, "views": (view,)}
    Film(time=np.array([0.0, 1.0]), bodies=(body,), **good)  # type: ignore[arg-type]
    for changes in (
        {"time": np.array([0.0, 0.0])},
        {"time": np.zeros(0)},
        {"time": np.array([0.0, 1.0, 2.0])},
        {"bodies": (body, body)},
        {"views": ()},
        {"readouts": (Readout("x", "N", np.zeros(3)),)},
    ):
        with pytest.raises(InputError):
            Film(**{"time": np.array([0.0, 1.0]), "bodies": (body,), **good, **changes})  # type: ignore[arg-type]


def test_the_camera_sees_everything() -> None:
    body = _ghost(3.0)
    focus, reach, floor = view_of([body])
    np.testing.assert_allclose(focus, [3.0, 0.0, 0.0], atol=1e-9)
    assert reach == pytest.approx(np.sqrt(3.0) * 0.05, rel=1e-6)
    assert floor == pytest.approx(-0.05)
