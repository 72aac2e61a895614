"""Base motion from momentum conservation: against forward dynamics, and against a plan that is not ours."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.dynamics.floating_base import BaseMotion, base_motion
from spacerobot.model.library import load
from spacerobot.support.errors import InputError

DATA = Path(os.environ.get("SPACEROBOT_DATA", Path(__file__).resolve().parents[3] / "shared" / "recordings"))
PLAN = DATA / "real" / "spot_free_floating_arm" / "100NodeSolution_FreeFloating_DIDO.mat"


def planar_arm(
    masses: list[float], inertias: list[float], mount: tuple[float, float], links: list[tuple[float, float]]
):
    """A planar floating platform with an arm; links are (joint to centre of mass, on to the next joint)."""
    model = pin.Model()

    def body(mass: float, inertia: float, at: float) -> pin.Inertia:
        return pin.Inertia(mass, np.array([at, 0.0, 0.0]), inertia * np.eye(3))

    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.appendBodyToJoint(joint, body(masses[0], inertias[0], 0.0), pin.SE3.Identity())
    distance, angle = mount
    # the first joint's angle counts from the base's y axis
    place = pin.SE3(
        pin.utils.rotate("z", math.pi / 2), np.array([distance * math.cos(angle), distance * math.sin(angle), 0.0])
    )
    for i, (a, b) in enumerate(links):
        joint = model.addJoint(joint, pin.JointModelRZ(), place, f"joint{i + 1}")
        model.appendBodyToJoint(joint, body(masses[i + 1], inertias[i + 1], a), pin.SE3.Identity())
        place = pin.SE3(np.eye(3), np.array([a + b, 0.0, 0.0]))
    return model


def heading(motion: BaseMotion) -> np.ndarray:
    q = motion.configuration
    return np.unwrap(2.0 * np.arctan2(q[:, 5], q[:, 6]))


@pytest.mark.real
@pytest.mark.skipif(not PLAN.exists(), reason="the recordings are not here (SPACEROBOT_DATA)")
def test_reproduces_the_base_motion_of_a_plan_that_is_not_ours() -> None:
    from scipy.interpolate import CubicSpline
    from scipy.io import loadmat

    plan = loadmat(PLAN, squeeze_me=True, struct_as_record=False)
    time, states = plan["primal"].time, plan["primal"].states
    model = planar_arm(
        [plan[f"m{i}"] for i in range(4)],
        [plan[f"I{i}"] for i in range(4)],
        (plan["b0"], plan["phi"]),
        [(plan[f"a{i}"], plan[f"b{i}"]) for i in range(1, 4)],
    )
    joints = CubicSpline(time, states[3:6].T)
    start = np.array([*states[:2, 0], 0.0, 0.0, 0.0, math.sin(states[2, 0] / 2), math.cos(states[2, 0] / 2)])
    motion = base_motion(model, lambda t: (joints(t), joints(t, 1)), time, base=start, tolerance=1e-8)
    off = np.hypot(*(motion.configuration[:, :2] - states[:2].T).T)
    turned = np.abs(heading(motion) - states[2])
    assert np.ptp(states[2]) > 0.8, "the platform turns by far more than the tolerance"
    assert time[-1] == pytest.approx(30.0)
    assert off.max() < 1e-3
    assert turned.max() < 0.02
    wrong = planar_arm(
        [plan[f"m{i}"] for i in range(4)],
        [1.1 * plan["I0"], *(plan[f"I{i}"] for i in range(1, 4))],
        (plan["b0"], plan["phi"]),
        [(plan[f"a{i}"], plan[f"b{i}"]) for i in range(1, 4)],
    )
    other = base_motion(wrong, lambda t: (joints(t), joints(t, 1)), time, base=start, tolerance=1e-8)
    assert np.abs(heading(other) - states[2]).max() > 0.02, "a tenth more inertia is seen"


def swing(t: float) -> tuple[np.ndarray, np.ndarray]:
    phase = np.arange(8) + t
    return 0.5 * np.sin(phase), 0.5 * np.cos(phase)


@pytest.mark.parametrize("momentum", [np.zeros(6), np.array([3.0, -2.0, 1.0, 0.5, 0.2, -0.4])])
def test_momentum_of_the_whole_is_what_it_was(momentum: np.ndarray) -> None:
    model = load("chaser_pa10_wrist").model
    times = np.linspace(0.0, 3.0, 13)
    motion = base_motion(model, swing, times, momentum=momentum)
    data = model.createData()
    centre = []
    for q, v in zip(motion.configuration, motion.velocity, strict=True):
        found = pin.computeCentroidalMomentum(model, data, q, v).vector
        assert np.abs(found - momentum).max() < 1e-9
        centre.append(np.array(data.com[0]))
    mass = sum(body.mass for body in model.inertias)
    straight = centre[0] + np.outer(times, momentum[:3]) / mass
    assert np.abs(np.array(centre) - straight).max() < 1e-8, "the centre of mass goes straight"


def test_a_joint_that_turns_on_and_on_is_a_revolute_one() -> None:
    """Two places in the configuration, one angle; past a whole turn too."""
    limited = planar_arm([10.0, 2.0, 1.0], [1.0, 0.1, 0.05], (0.3, 0.4), [(0.2, 0.2), (0.2, 0.2)])
    endless = pin.Model()
    for i in range(1, limited.njoints):
        kind = pin.JointModelFreeFlyer() if i == 1 else pin.JointModelRUBZ()
        endless.addJoint(int(limited.parents[i]), kind, limited.jointPlacements[i], limited.names[i])
        endless.appendBodyToJoint(i, limited.inertias[i], pin.SE3.Identity())
    assert endless.nq == limited.nq + 2
    times, momentum = np.linspace(0.0, 3.0, 7), np.array([0.3, -0.2, 0.0, 0.0, 0.0, 0.4])

    def motion(t: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([4.0 * t, math.sin(t)]), np.array([4.0, math.cos(t)])

    one, other = (base_motion(m, motion, times, momentum=momentum) for m in (limited, endless))
    assert np.abs(heading(one)).max() > 0.5
    assert np.abs(one.configuration[:, :7] - other.configuration[:, :7]).max() < 1e-9
    assert np.abs(one.velocity - other.velocity).max() < 1e-9


def test_velocity_is_the_rate_of_the_configuration() -> None:
    model = load("chaser_pa10_wrist").model
    step = 1e-4
    motion = base_motion(model, swing, np.array([0.0, 1.0 - step, 1.0, 1.0 + step]))
    found = pin.difference(model, motion.configuration[1], motion.configuration[3]) / (2 * step)
    assert np.abs(found - motion.velocity[2]).max() < 1e-7


def test_knots_change_nothing_where_the_motion_is_smooth() -> None:
    model = load("chaser_pa10_wrist").model
    times = np.linspace(0.0, 2.0, 9)
    plain = base_motion(model, swing, times)
    stopped = base_motion(model, swing, times, knots=[0.3, 0.5, 1.7])
    assert np.abs(plain.configuration - stopped.configuration).max() < 1e-8


@pytest.mark.parametrize(
    "knots",
    [
        [0.5, 0.5, 0.5],
        [0.5, 0.5 + 1e-15, 0.5 + 1e-12],
        [0.0, 2.0, -1.0, 3.0],
        [1.7, 0.3, 0.3, 1.0],
        [0.25, 0.5, 0.75],  # on the times themselves
        [2.0 - 1e-16, 1e-16],
    ],
)
def test_knots_twice_out_of_order_or_at_the_ends(knots: list[float]) -> None:
    model = load("chaser_pa10_wrist").model
    times = np.linspace(0.0, 2.0, 9)
    plain = base_motion(model, swing, times)
    stopped = base_motion(model, swing, times, knots=knots)
    assert np.abs(plain.configuration - stopped.configuration).max() < 1e-8


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"base": np.array([0.0, 0, 0, 0, 0, 0, 2])}, "unit quaternion"),
        ({"base": np.zeros(7)}, "unit quaternion"),
        ({"knots": [math.nan]}, "knot"),
        ({"times": np.array([0.0, 0.0])}, "ascend"),
        ({"base": np.zeros(6)}, "base needs 7"),
        ({"momentum": np.full(6, math.nan)}, "momentum 6"),
        ({"joint_motion": lambda t: (np.zeros(3), np.zeros(3))}, "wrong length"),
        ({"model": "pa10_wrist"}, "no free-flyer"),
    ],
)
def test_refuses(options: dict, said: str) -> None:
    given = {"model": "chaser_pa10_wrist", "joint_motion": swing, "times": np.array([0.0, 1.0]), **options}
    given["model"] = load(given["model"]).model
    with pytest.raises(InputError, match=said):
        base_motion(given.pop("model"), given.pop("joint_motion"), given.pop("times"), **given)
