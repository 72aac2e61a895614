"""Which pose makes a soft capture: the arm's self-motion searched at one place of the hand.

A target of mass m that meets the hand of effective mass M through a spring k at speed v feels the reduced mass
m~ = M m/(M + m) (Uyama et al. 2012, Eq. 10, wrist mass within m) and presses with at most v sqrt(k m~) where nothing
damps. Both grow with M, so the softest pose is the lightest one. Against a target that is much lighter than the hand
the pose hardly matters, and the numbers say so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.batch import checked_poses, effective_mass_batch
from spacerobot.dynamics.hand_pose import hand_aim
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.support.showing import Brief, html_table


@dataclass(frozen=True, eq=False, repr=False)
class SoftCapture(Brief):
    """Poses with the hand at one place, from the softest to the hardest.

    Attributes:
        poses: shape (N, len(chain)) [rad or m].
        effective_mass_kg: shape (N,), along `direction`, ascending.
        reduced_mass_kg: shape (N,), m~ with the target.
        peak_force_N: shape (N,), v sqrt(k m~).
        given: which of them is the pose that was asked about.
        direction: shape (3,), unit vector.
    """

    poses: np.ndarray
    effective_mass_kg: np.ndarray
    reduced_mass_kg: np.ndarray
    peak_force_N: np.ndarray
    given: int
    direction: np.ndarray

    def _repr_html_(self) -> str:
        picked = (("softest", 0), ("the pose asked about", self.given), ("hardest", len(self.poses) - 1))
        rows = [(word, *(float(v[k]) for v in (self.effective_mass_kg, self.peak_force_N))) for word, k in picked]
        title = f"{len(self.poses)} poses with the hand at one place"
        return html_table(title, rows, ("", "effective mass, kg", "peak force, N"))

    @property
    def gain(self) -> float:
        """Peak force of the softest pose over that of the given one."""
        return float(self.peak_force_N[0] / self.peak_force_N[self.given])


def soft_capture(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike = (1.0, 0.0, 0.0),
    *,
    tip_mass: float,
    speed: float = 0.1,
    wrist_stiffness: float = 530.0,
    frame: str | None = None,
    base: str | None = None,
    joints: str = "free",
    tries: int = 300,
    seed: int = 0,
) -> SoftCapture:
    """Search an arm's self-motion for the pose that presses least.

    Args:
        robot: the robot; a floating base stands at the world's origin.
        pose: shape (len(chain),): its hand's place and pointing are kept [rad or m].
        direction: shape (3,), unit vector along the target's approach, world axes.
        tip_mass: m_w + m_t, target with the wrist's slider [kg].
        speed: of approach [m/s].
        wrist_stiffness: k_w [N/m].
        frame: the hand; the wrist mount if None.
        base: "fixed" or "free"; free where the robot floats if None.
        joints: "free" or "locked".
        tries: random starts of the search.
        seed: of these.

    Raises:
        InputError: a value that is not positive.
    """
    given = {"tip mass": tip_mass, "speed": speed, "wrist's stiffness": wrist_stiffness, "tries": tries}
    for what, value in given.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"the {what} must be positive", given=value)
    reference = checked_poses(robot, pose)[0]
    aim = hand_aim(robot, reference, direction, frame=frame)
    random = np.random.default_rng(seed)
    low = np.where(np.isfinite(aim.low), aim.low, -np.pi)
    high = np.where(np.isfinite(aim.high), aim.high, np.pi)
    starts = random.uniform(low, high, (tries, len(low)))
    near = reference + random.normal(0.0, 0.5, (tries, len(low)))  # its own branch, well searched
    found = [reference]
    for start in np.concatenate([starts, np.clip(near, low, high)]):
        solved = aim.solve(aim.place, start)
        if solved is not None:
            found.append(solved)
    poses = np.array(found)
    batch = effective_mass_batch(robot, poses, aim.in_world, frame=frame, base=base, joints=joints)
    masses = batch.effective_mass_kg[:, 0]
    with np.errstate(divide="ignore"):
        reduced = 1.0 / (1.0 / masses + 1.0 / tip_mass)
    order = np.argsort(masses, kind="stable")
    return SoftCapture(
        poses=poses[order],
        effective_mass_kg=masses[order],
        reduced_mass_kg=reduced[order],
        peak_force_N=speed * np.sqrt(wrist_stiffness * reduced[order]),
        given=int(np.flatnonzero(order == 0)[0]),
        direction=aim.in_world,
    )
