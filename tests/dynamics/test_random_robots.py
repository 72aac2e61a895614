"""Arms that nobody drew: turned, mirrored, in other units; the effective mass is the same body's."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.model.library import load

few = settings(max_examples=40, deadline=None, derandomize=True)
MIRROR = np.diag([1.0, -1.0, 1.0])


@dataclass(frozen=True)
class Part:
    """One joint and the link behind it."""

    revolute: bool
    place: np.ndarray
    turn: np.ndarray
    axis: np.ndarray
    mass: float
    centre: np.ndarray
    inertia: np.ndarray


def numbers(low: float, high: float, count: int) -> st.SearchStrategy[np.ndarray]:
    return st.lists(st.floats(low, high), min_size=count, max_size=count).map(np.array)


def unit(vector: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vector)
    return vector / length if length > 1e-3 else np.array([0.0, 0.0, 1.0])


@st.composite
def parts(draw: st.DrawFn, revolute: bool = False) -> Part:
    edges = draw(numbers(0.05, 0.5, 3))
    mass = draw(st.floats(0.1, 20.0))
    turned = pin.rpy.rpyToMatrix(*draw(numbers(-3.0, 3.0, 3)))
    moments = (
        mass
        / 12.0
        * np.diag([edges[1] ** 2 + edges[2] ** 2, edges[0] ** 2 + edges[2] ** 2, edges[0] ** 2 + edges[1] ** 2])
    )
    return Part(
        revolute or draw(st.booleans()),
        draw(numbers(-0.6, 0.6, 3)),
        draw(numbers(-1.4, 1.4, 3)),
        unit(draw(numbers(-1.0, 1.0, 3))),
        mass,
        draw(numbers(-0.2, 0.2, 3)),
        turned @ moments @ turned.T,
    )


def text(values: np.ndarray) -> str:
    return " ".join(repr(float(v)) for v in values)


def urdf(arm: list[Part], *, stand: np.ndarray | None = None) -> str:
    """The arm as a URDF, on a stand that may be turned by roll, pitch and yaw."""
    out = ['<robot name="random"><link name="world"/><link name="l0"/>']
    turned = text(np.zeros(3) if stand is None else stand)
    out.append(
        f'<joint name="stand" type="fixed"><parent link="world"/><child link="l0"/><origin rpy="{turned}"/></joint>'
    )
    for i, p in enumerate(arm):
        kind = "revolute" if p.revolute else "prismatic"
        moments = (
            " ".join(
                f'{k}="{p.inertia[a, b]!r}"'
                for k, (a, b) in {
                    "ixx": (0, 0),
                    "iyy": (1, 1),
                    "izz": (2, 2),
                    "ixy": (0, 1),
                    "ixz": (0, 2),
                    "iyz": (1, 2),
                }.items()
            )
            .replace("np.float64(", "")
            .replace(")", "")
        )
        out.append(
            f'<link name="l{i + 1}"><inertial><origin xyz="{text(p.centre)}"/><mass value="{p.mass!r}"/>'
            f"<inertia {moments}/></inertial></link>"
            f'<joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{text(p.place)}" rpy="{text(p.turn)}"/><axis xyz="{text(p.axis)}"/>'
            '<limit lower="-4" upper="4" effort="1" velocity="1"/></joint>'
        )
    out.append('<link name="tip"/><joint name="end" type="fixed">')
    out.append(f'<parent link="l{len(arm)}"/><child link="tip"/><origin xyz="0.3 0.1 0.2"/></joint></robot>')
    return "".join(out)


def mobility(description: str, pose: np.ndarray, direction: np.ndarray) -> tuple[float, float]:
    """1/kg along a direction, and the largest in any."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = effective_mass(load(description), pose, direction, frame="tip", base="fixed", joints="free")
    return found.mobility_per_kg, float(np.linalg.norm(found.mobility[:3, :3], 2))


arms = st.lists(parts(), min_size=1, max_size=5)
poses = numbers(-2.0, 2.0, 5)
directions = numbers(-1.0, 1.0, 3).map(unit)


@few
@given(arm=arms, pose=poses, n=directions, stand=numbers(-3.0, 3.0, 3))
def test_turning_the_world_changes_nothing(arm: list[Part], pose: np.ndarray, n: np.ndarray, stand: np.ndarray) -> None:
    here, most = mobility(urdf(arm), pose[: len(arm)], n)
    there, _ = mobility(urdf(arm, stand=stand), pose[: len(arm)], unit(pin.rpy.rpyToMatrix(*stand) @ n))
    assert abs(here - there) < 1e-9 * most


def mirrored(p: Part) -> Part:
    """A joint's axis is an axial vector if it turns, a polar one if it slides."""
    axis = -MIRROR @ p.axis if p.revolute else MIRROR @ p.axis
    turn = p.turn * [-1.0, 1.0, -1.0]
    return Part(p.revolute, MIRROR @ p.place, turn, axis, p.mass, MIRROR @ p.centre, MIRROR @ p.inertia @ MIRROR)


@few
@given(arm=arms, pose=poses, n=directions)
def test_a_mirrored_arm_weighs_the_same_in_the_mirror(arm: list[Part], pose: np.ndarray, n: np.ndarray) -> None:
    here, most = mobility(urdf(arm), pose[: len(arm)], n)
    image = urdf([mirrored(p) for p in arm]).replace('xyz="0.3 0.1 0.2"', 'xyz="0.3 -0.1 0.2"')
    there, _ = mobility(image, pose[: len(arm)], MIRROR @ n)
    assert abs(here - there) < 1e-9 * most


@few
@given(arm=st.lists(parts(revolute=True), min_size=1, max_size=5), pose=poses, n=directions, size=st.floats(0.1, 10.0))
def test_lengths_in_another_unit_leave_kilograms(arm: list[Part], pose: np.ndarray, n: np.ndarray, size: float) -> None:
    grown = [
        Part(p.revolute, size * p.place, p.turn, p.axis, p.mass, size * p.centre, size**2 * p.inertia) for p in arm
    ]
    here, most = mobility(urdf(arm), pose[: len(arm)], n)
    tip = text(size * np.array([0.3, 0.1, 0.2]))
    there, _ = mobility(urdf(grown).replace('xyz="0.3 0.1 0.2"', f'xyz="{tip}"'), pose[: len(arm)], n)
    assert abs(here - there) < 1e-8 * most


@few
@given(arm=arms, pose=poses, n=directions)
def test_it_is_what_forward_dynamics_does(arm: list[Part], pose: np.ndarray, n: np.ndarray) -> None:
    """At rest and without gravity, a force of 1 N at the tip accelerates it along itself by the mobility."""
    here, most = mobility(urdf(arm), pose[: len(arm)], n)
    model = load(urdf(arm)).model
    data = model.createData()
    model.gravity.setZero()
    q = pose[: len(arm)]
    frame = model.getFrameId("tip")
    jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    jacobian = jacobian.reshape(6, model.nv)[:3]  # of one joint it comes as a mere vector
    zero = np.zeros(model.nv)
    acceleration = jacobian @ pin.aba(model, data, q, zero, jacobian.T @ n)
    assert abs(n @ acceleration - here) < 1e-9 * most


def test_a_wrong_mirror_is_seen() -> None:
    turn, axis = np.array([0.3, 0.2, 0.1]), unit(np.array([0.2, 0.5, 1.0]))
    one = Part(True, np.array([0.1, 0.3, 0.2]), turn, axis, 2.0, np.array([0.1, 0.1, 0.0]), np.diag([0.02, 0.03, 0.04]))
    arm, pose, n = [one, one, one], np.array([0.4, -0.7, 1.1]), unit(np.array([1.0, 0.4, -0.3]))
    here, most = mobility(urdf(arm), pose, n)
    there, _ = mobility(urdf([mirrored(p) for p in arm]), pose, MIRROR @ n)  # but for the tip, which was forgotten
    assert abs(here - there) > 1e-3 * most
