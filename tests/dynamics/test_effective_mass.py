from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

import spacerobot as sr
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.model.library import load
from spacerobot.support.errors import InputError, NotFoundError
from tests.dynamics.support import CART, DEFAULT, ROD, directions, poses, robot

pytestmark = pytest.mark.filterwarnings("ignore::spacerobot.dynamics.pose_limits.PoseLimitWarning")

X, Y, Z = np.eye(3)


def test_known_values_of_the_bare_arm() -> None:
    arm = robot("pa10")
    masses = [effective_mass(arm, DEFAULT, n, base="fixed").effective_mass_kg for n in (X, Y, Z)]
    assert np.round(masses, 2).tolist() == [7.53, 2.28, 1.48]


def test_five_lines_of_python() -> None:
    arm = sr.load("pa10_wrist")
    m = sr.effective_mass(arm, pose=DEFAULT, direction=[1, 0, 0], base="fixed", joints="free")
    assert m.frame == arm.tip
    assert 7.0 < m.effective_mass_kg < 8.5
    assert "wrist_mount" in repr(m)


def test_a_rod_on_a_hinge_is_its_inertia_over_the_radius_squared() -> None:
    rod = load(ROD, tip="tip")
    for angle in (0.0, 0.7, -2.0):
        tangent = np.array([-math.sin(angle), math.cos(angle), 0.0])
        m = effective_mass(rod, [angle], tangent)
        assert m.effective_mass_kg == pytest.approx(0.18 / 0.25, rel=1e-12)
        radial = effective_mass(rod, [angle], [math.cos(angle), math.sin(angle), 0.0])
        assert math.isinf(radial.effective_mass_kg)
        assert effective_mass(rod, [angle], Z).rotational_inertia_kg_m2 == pytest.approx(0.18, rel=1e-12)


def test_a_cart_on_a_ship_is_the_cart_or_both() -> None:
    ship = load(CART, tip="tip", floating=True)
    assert effective_mass(ship, [0.3], X, joints="free").effective_mass_kg == pytest.approx(2.0, rel=1e-12)
    assert effective_mass(ship, [0.3], X, joints="locked").effective_mass_kg == pytest.approx(9.0, rel=1e-12)
    fixed = effective_mass(ship, [0.3], X, base="fixed", joints="locked")
    assert math.isinf(fixed.effective_mass_kg)
    assert "nothing can move" in fixed.notes[0]


def test_along_a_free_slider_the_tip_is_the_slider_alone() -> None:
    for name in ("pa10_wrist", "chaser_pa10_wrist"):
        model = robot(name)
        assert model.slider is not None
        slider = model.model.inertias[model.joint_id(model.slider)].mass
        for joints in ("free", "locked"):
            m = effective_mass(model, DEFAULT, X, frame=model.contact, joints=joints)
            assert m.effective_mass_kg == pytest.approx(slider, rel=1e-9)
        held = effective_mass(model, DEFAULT, X, frame=model.contact, slider="locked")
        assert held.effective_mass_kg > 3.0


def test_at_the_hand_a_free_slider_enters_by_its_schur_complement() -> None:
    """M = 1/(n^T J_h H_c^-1 J_h^T n), H_c = H_aa - h_as h_as^T/H_ss, written out here with the plain formula."""
    from spacerobot.dynamics.inertia import joint_space_inertia
    from spacerobot.dynamics.jacobian import frame_jacobian

    model = robot("chaser_pa10_wrist")
    for pose, n in zip(poses(model, 3), directions(3), strict=True):
        q = model.configuration(pose)
        h, j = joint_space_inertia(model, q), frame_jacobian(model, q)
        s = model.velocity_index(model.slider or "")
        a = np.delete(np.arange(model.model.nv), s)
        reduced = h[np.ix_(a, a)] - np.outer(h[a, s], h[a, s]) / h[s, s]
        expected = 1.0 / (n @ j[:3, a] @ np.linalg.solve(reduced, j[:3, a].T @ n))
        assert effective_mass(model, pose, n).effective_mass_kg == pytest.approx(expected, rel=1e-10)
        bare = 1.0 / (n @ j[:3, a] @ np.linalg.solve(h[np.ix_(a, a)], j[:3, a].T @ n))
        assert effective_mass(model, pose, n, slider="locked").effective_mass_kg == pytest.approx(bare, rel=1e-10)
        assert bare >= expected * (1.0 - 1e-12)  # carrying the slider along its axis too is never lighter


def test_joints_free_is_never_heavier_than_locked() -> None:
    for name in ("pa10_wrist", "chaser_pa10_wrist"):
        model = robot(name)
        for pose in poses(model, 10):
            for n in directions(4):
                m = effective_mass(model, pose, n)
                locked = effective_mass(model, pose, n, joints="locked")
                assert m.mobility_per_kg >= locked.mobility_per_kg
                parts = m.share()
                assert parts["free"] == pytest.approx(m.mobility_per_kg, rel=1e-10)
                assert parts["slider"] + parts["base"] == pytest.approx(locked.mobility_per_kg, rel=1e-9, abs=1e-15)
                assert min(parts.values()) >= 0.0


def test_the_inverse_of_the_linear_mobility_is_not_the_block_of_lambda() -> None:
    m = effective_mass(robot("pa10"), DEFAULT, X)
    assert m.lambda_linear is not None
    assert m.lambda_spatial is not None
    np.testing.assert_allclose(m.lambda_linear @ m.mobility[:3, :3], np.eye(3), atol=1e-10)
    np.testing.assert_allclose(m.lambda_spatial @ m.mobility, np.eye(6), atol=1e-8)
    assert m.lambda_spatial[0, 0] > 1.3 * m.lambda_linear[0, 0]  # 11.7 against 8.7 kg
    assert m.lambda_linear[0, 0] > 1.1 * m.effective_mass_kg  # nor is a diagonal entry the effective mass


@pytest.mark.parametrize("joints", ["free", "locked"])
def test_singular_poses_state_an_infinity(joints: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for offset in (0.0, 1e-12, 1e-9):
            m = effective_mass(robot("pa10"), np.full(7, offset), Z, joints=joints)
            assert m.effective_mass_kg == math.inf
            assert m.mobility_per_kg == 0.0
            assert m.notes
            assert m.lambda_spatial is None
            assert math.isinf(m.ellipsoid.principal_masses[-1]) if m.ellipsoid else False


def test_near_a_singular_pose_the_mass_grows_without_bound() -> None:
    """The mobility along a stretched arm vanishes with the square of the bend."""
    bends = np.array([1e-2, 1e-3])
    mobility = [effective_mass(robot("pa10"), [0, b, 0, -2 * b, 0, b, 0], Z).mobility_per_kg for b in bends]
    assert mobility[0] / mobility[1] == pytest.approx(100.0, rel=1e-2)


def test_fixed_locks_the_free_flyer() -> None:
    chaser = robot("chaser_pa10_wrist")
    fixed = effective_mass(chaser, DEFAULT, X, base="fixed")
    ground = effective_mass(robot("pa10_wrist"), DEFAULT, X)
    assert fixed.effective_mass_kg == pytest.approx(ground.effective_mass_kg, rel=1e-9)
    assert not fixed.base_velocity_per_impulse.any()


def test_base_reaction_is_what_forward_dynamics_gives() -> None:
    import pinocchio as pin

    chaser = robot("chaser_pa10_wrist")
    q = chaser.configuration(DEFAULT)
    model = chaser.model.copy()
    model.gravity = pin.Motion.Zero()
    n = directions(1)[0]
    jacobian = pin.computeFrameJacobian(
        model, model.createData(), q, chaser.frame_id(chaser.tip), pin.LOCAL_WORLD_ALIGNED
    )
    rest = np.zeros(model.nv)
    acceleration = pin.aba(model, model.createData(), q, rest, jacobian[:3].T @ n)
    m = effective_mass(chaser, DEFAULT, n)
    np.testing.assert_allclose(m.base_velocity_per_impulse, acceleration[:6], rtol=1e-9, atol=1e-14)


def test_generalized_jacobian_is_the_tip_velocity_at_zero_momentum() -> None:
    import pinocchio as pin

    from spacerobot.dynamics.jacobian import generalized_jacobian

    chaser = robot("chaser_pa10_wrist")
    q = chaser.configuration(poses(chaser, 1)[0])
    rates = np.random.default_rng(3).normal(size=7)
    data = chaser.model.createData()
    momentum = pin.computeCentroidalMap(chaser.model, data, q)
    arm = [chaser.velocity_index(name) for name in chaser.chain]
    v = np.zeros(chaser.model.nv)
    v[arm] = rates
    v[:6] = -np.linalg.solve(momentum[:, :6], momentum[:, arm] @ rates)
    frame = chaser.frame_id(chaser.tip)
    whole = pin.computeFrameJacobian(chaser.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED) @ v
    # The centroidal map knows no rotor inertia, nor does the coupling H_bm: both conserve the bodies' momentum.
    np.testing.assert_allclose(generalized_jacobian(chaser, q) @ rates, whole, rtol=1e-9, atol=1e-12)


def test_a_pose_outside_the_limits_is_answered_with_a_warning() -> None:
    with pytest.warns(PoseLimitWarning, match="S1 at 200 deg is outside its limits -177 to 177 deg"):
        m = effective_mass(robot("pa10"), np.deg2rad([200, 45, 0, 90, 0, -45, 0]), X)
    assert len(m.warnings) == 1
    assert math.isfinite(m.effective_mass_kg)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"direction": [1, 1, 0]}, "not a unit vector"),
        ({"direction": [1, 0, 2e-6]}, None),
        ({"direction": [1.00001, 0, 0]}, "length 1.00001"),
        ({"direction": [1, 0]}, "wrong length"),
        ({"direction": [math.nan, 0, 0]}, "not finite"),
        ({"direction": [0, 0, 0]}, "not a unit vector"),
        ({"direction": "x"}, "not numeric"),
        ({"direction": np.eye(3)}, "one direction"),
        ({"pose": [0, 1]}, "7 values"),
        ({"pose": [math.nan] * 7}, "not finite"),
        ({"pose": ["a"] * 7}, "not a list of numbers"),
        ({"frame": "flanje"}, "did you mean 'flange'"),
        ({"others": {"W9": 1.0}}, "unknown joint"),
        ({"base": "free"}, "float_base"),
        ({"base": "flying"}, "fixed or free"),
        ({"joints": "loose"}, "free or locked or servo"),
        ({"slider": "gone"}, "unknown slider regime"),
        ({"joints": "servo"}, "need a stiffness"),
        ({"joints": "servo", "stiffness": 1e5}, "depends on frequency"),
        ({"joints": "servo", "stiffness": [1, 2], "omega": 1.0}, "wrong length"),
        ({"joints": "servo", "stiffness": -1.0, "omega": 1.0}, "not negative"),
        ({"joints": "servo", "stiffness": 1e5, "omega": 0.0}, "positive"),
        ({"joints": "servo", "stiffness": 1e5, "omega": math.nan}, "positive"),
        ({"joints": "servo", "stiffness": 1e5, "wrist_stiffness": -1.0, "target_mass": 9.0}, "wrist stiffness"),
        ({"joints": "servo", "stiffness": 1e5, "wrist_stiffness": 1.0, "target_mass": 0.0}, "target mass"),
        ({"stiffness": 1e5}, "need servo joints"),
        ({"configuration": np.zeros(3)}, "not both"),
        ({"pose": None, "configuration": np.zeros(3)}, "wrong length"),
        ({"pose": None, "configuration": np.full(7, np.inf)}, "not finite"),
    ],
)
def test_bad_input_is_one_clear_error(options: dict, message: str | None) -> None:
    arguments = {"pose": DEFAULT, "direction": X, **options}
    if message is None:
        assert effective_mass(robot("pa10"), **arguments).effective_mass_kg > 0.0
        return
    with pytest.raises(InputError, match=message):
        effective_mass(robot("pa10"), **arguments)


def test_a_base_attitude_must_be_a_unit_quaternion() -> None:
    chaser = robot("chaser_pa10_wrist")
    q = chaser.configuration(DEFAULT)
    q[3:7] *= 1.1
    with pytest.raises(InputError, match="unit quaternion"):
        effective_mass(chaser, None, X, configuration=q)


def test_unknown_names_are_not_found() -> None:
    with pytest.raises(NotFoundError):
        effective_mass(robot("pa10"), DEFAULT, X, frame="nowhere")
