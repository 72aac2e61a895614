"""Joint logs as torque balances read them: position, rates and torque through one narrow test function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_factors import Brought
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.effects.catalogue.coulomb_friction import dry
from spacerobot.effects.primitives import Friction
from spacerobot.effects.sizes import Sizes

TURN = "base.yaw"
"""Channel of a floating base that its arm's joints feel."""

SLOW = 2.0
"""Span [s] over which what a base turns by itself is averaged: only outer moments change it."""

SOME = 50
"""Samples of a trial that tell how much torque a joint's motion asks for."""

_LOGGED = ("position", "torque")


@dataclass(frozen=True, eq=False)
class Onset:
    """Where the smoothed record of a trial begins: of each joint, shape (J,)."""

    acceleration: np.ndarray
    rigid: np.ndarray  # torque that the rigid body asks for
    torque: np.ndarray  # as logged

    def times(self, factor: float) -> Onset:
        """Of a motion so many times as fast, of which no torque is known."""
        more = factor**2 * self.acceleration
        return replace(self, acceleration=more, torque=np.full_like(self.torque, np.nan))


@dataclass(frozen=True, eq=False)
class Motion:
    """A stretch of measured motion. T samples, J joints."""

    step: float  # s
    position: np.ndarray  # (T, J)
    velocity: np.ndarray  # (T, J)
    acceleration: np.ndarray  # (T, J)
    rigid: np.ndarray  # (T, J) torque that the rigid body asks for
    stride: int
    by_link: np.ndarray  # (K, T, J) of it, what each link of doubted mass asks for
    torque: np.ndarray | None  # (T, J) as logged; None of a motion that nobody made
    run_up: np.ndarray  # (R, J) acceleration of the trial before it, from where its record begins
    onset: Onset  # of the trial
    slow: np.ndarray  # (J,) rate below which it may stand still
    lens: Bump  # what motion and torque were seen through before
    wider: float = 1.0  # by how much what they truly were seen through is wider, in variance
    beside: Mapping[str, Brought] = field(default_factory=dict)  # by doubted factor
    turn: np.ndarray | None = None  # (T,) rate of a tracked base that floats

    def told(self, beyond: Callable[[str], float]) -> Motion:
        """As it truly was, with each doubted factor so much larger than believed."""
        if not self.beside:
            return self
        by = {key: beyond(key) for key in self.beside}

        def truly(of: str) -> np.ndarray:
            return np.asarray(getattr(self, of) + sum(b * getattr(self.beside[key], of) for key, b in by.items()))

        return replace(
            self,
            position=truly("position"),
            velocity=truly("velocity"),
            acceleration=truly("acceleration"),
            rigid=truly("rigid"),
            torque=None if self.torque is None else truly("torque"),
        )


@dataclass(frozen=True, eq=False)
class JointLog:
    """Smoothed joint logs of one trial. T samples, J joints."""

    time: np.ndarray  # (T,)
    step: float
    position: np.ndarray  # (T, J)
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    good: np.ndarray  # (T,) bool
    turn: np.ndarray | None  # (T,) of a tracked base that floats
    rigid: np.ndarray  # (T, J), empty before it is asked for
    by_link: np.ndarray  # (K, T, J), empty before it is asked for
    lens: Bump  # what all were seen through
    wider: float = 1.0  # by how much what they truly were seen through is wider, in variance

    def turned(self, arm: Rigid, by: int = 1) -> np.ndarray | None:
        """Rate of a tracked base at every `by`-th sample, shape (T,) [rad/s]; None where it is not tracked.

        As its joints drive it, with the slow rest that the tracker shows.
        """
        if self.turn is None:
            return None
        driven, shown = arm.turning(self.position[::by], self.velocity[::by]), self.turn[::by]
        even = np.ones(min(max(1, round(SLOW / (self.step * by))), shown.size))
        return driven + np.convolve(shown - driven, even, "same") / np.convolve(np.ones(shown.size), even, "same")

    def thinned(self, by: int, arm: Rigid, heavier: Sequence[Rigid]) -> JointLog:
        """Every `by`-th sample, with the rigid body's torque and what of it each doubled link adds."""
        some = slice(None, None, by)
        q, v, a = self.position[some], self.velocity[some], self.acceleration[some]
        turn = self.turned(arm, by)
        lens = Bump.of(self.lens.half // by, self.step * by)
        wider = self.lens.variance / lens.variance

        def asked(of: Rigid) -> np.ndarray:
            return unbent(of.torque, lens, wider, (q, v, a, turn))

        rigid = asked(arm)
        good = np.array([self.good[i : i + by].all() for i in range(0, self.time.size, by)])
        by_link = np.array([asked(other) - rigid for other in heavier]).reshape(len(heavier), *rigid.shape)
        torque, step = self.torque[some], self.step * by
        return JointLog(self.time[some], step, q, v, a, torque, good, turn, rigid, by_link, lens, wider)


def unbent(
    asked: Callable[..., np.ndarray], lens: Bump, wider: float, motion: Sequence[np.ndarray | None]
) -> np.ndarray:
    """Torque along a smoothed motion, shape (T, M), as if the true motion's had been smoothed.

    Weight and inertia bend with place and rate: smoothed once more, the motion shows what smoothing it once did (an arm
    that whirls at 10 rad/s, logged at 100 Hz: a hundredth of its weight).

    Args:
        asked: what a motion asks for, shape (T, M).
        lens: a coarse test function.
        wider: how much wider that was, in variance, which the motion was seen through.
        motion: as `asked` takes it: position, velocity and acceleration, shape (T, J) each, and more.
    """
    once = asked(*motion)
    return np.asarray(once + bent(asked, once, lens, wider, motion))


def bent(
    asked: Callable[..., np.ndarray],
    once: np.ndarray,
    lens: Bump,
    wider: float,
    motion: Sequence[np.ndarray | None],
) -> np.ndarray:
    """What `unbent` adds to what the smoothed motion itself asks for, shape (T, M) both; nothing where it is short."""
    if once.shape[0] <= 2 * lens.half:
        return np.zeros_like(once)
    again = asked(*(None if x is None else lens.smooth(x) for x in motion))
    return np.asarray(wider * np.pad(lens.smooth(once) - again, ((lens.half, lens.half), (0, 0)), mode="edge"))


def kinematics(grid: Grid, joints: Sequence[str], half: int) -> JointLog:
    """Position, velocity, acceleration and torque through one narrow test function.

    Where the velocity was logged too it is used: a logger's late rows cost a position derived twice far more.
    """
    sharp = Bump.of(half, grid.step)
    position, torque = (np.stack([grid.value[f"joint.{j}.{w}"] for j in joints], axis=1) for w in _LOGGED)
    if all(f"joint.{j}.velocity" in grid.value for j in joints):
        rates = np.stack([grid.value[f"joint.{j}.velocity"] for j in joints], axis=1)
        velocity, acceleration = sharp.smooth(rates), sharp.rate(rates)
    else:
        velocity, acceleration = sharp.rate(position), sharp.acceleration(position)
    good = np.convolve(~grid.good, np.ones(2 * half + 1), "valid") < 0.5
    time, empty = grid.time[half:-half], np.zeros((0, len(joints)))
    smooth = (sharp.smooth(position), velocity, acceleration, sharp.smooth(torque))
    turn = sharp.rate(grid.value[TURN]) if TURN in grid.value else None
    return JointLog(time, grid.step, *smooth, good, turn, empty, empty[None], sharp)


def torque_sizes(logs: Iterable[JointLog], index: int, arm: Rigid | None = None) -> Sizes:
    """Of one joint; of one without a log of its torque by what the rigid body asks for."""
    every = list(logs)
    torque = np.concatenate([g.torque[:, index] for g in every])
    if arm is not None:
        step = [max(1, g.time.size // SOME) for g in every]
        some = [(g.position[::n], g.velocity[::n], g.acceleration[::n]) for g, n in zip(every, step, strict=True)]
        torque = np.concatenate([arm.torque(*motion)[:, index] for motion in some])
    return sizes_of(
        torque,
        np.concatenate([g.position[:, index] for g in every]),
        np.concatenate([g.velocity[:, index] for g in every]),
        float(np.sqrt(np.mean(torque**2))),
    )


def shifted(grid: Grid, zeros: Mapping[str, float]) -> Grid:
    """The grid with its joints' positions counted from the model's zero [rad or m]."""
    moved = {f"joint.{j}.position": z for j, z in zeros.items() if z}
    if not moved:
        return grid
    return replace(grid, value={c: x - moved.get(c, 0.0) for c, x in grid.value.items()})


def stated_friction(values: Mapping[str, float], name: str) -> tuple[Friction, ...]:
    """The dry friction of a joint, "joint.NAME", that the baseline states."""
    force = values.get(f"{name}.friction", 0.0)
    return (dry(f"{name}.friction", name, force),) if force else ()
