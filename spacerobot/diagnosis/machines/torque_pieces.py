"""Joint logs in pieces, each with its motion and with its torques seen through test functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.machines.contract import FIRST_NOISE
from spacerobot.diagnosis.machines.joint_factors import Brought
from spacerobot.diagnosis.machines.joint_log import JointLog, Motion, Onset
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.machines.windows import PIECES
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id

FEWEST = 4
"""Half widths of a test function that a piece holds at least."""

FEWEST_READINGS = 4
"""That a piece holds at least."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A piece of a trial, the motion along it, and the test function that its balance is seen through."""

    trial: TrialData
    motion: Motion
    bump: Bump


@dataclass(frozen=True, eq=False)
class Recorded:
    """A trial before it is cut.

    Attributes:
        key, condition, overrides: as the study has them.
        log: smoothed.
        half: samples to either side of the test functions that its balance is seen through.
        beside: what doubted factors add to its log.
    """

    key: str
    condition: str
    overrides: Mapping[str, float]
    log: JointLog
    half: int
    beside: Mapping[str, Brought]


@dataclass(frozen=True, eq=False)
class Cutter:
    """What cuts the logs of an arm.

    Attributes:
        joints: names of the logged ones.
        compared: of those whose balance counts, C.
        level: typical torque of each, shape (C,) [N m or N].
        slow: rate below which each logged joint may as well stand still, shape (J,).
        sensor: what verdicts call the torque sensors.
    """

    joints: tuple[str, ...]
    compared: tuple[str, ...]
    level: np.ndarray
    slow: np.ndarray
    sensor: str

    def pieces(self, of: Recorded, noise: np.ndarray) -> tuple[list[Piece], list[Piece]]:
        """A trial's pieces, and all that were cut.

        Where a joint may stand still dry friction holds whatever is asked of it: such readings say nothing, and are
        left out where enough are left.

        Args:
            of: the trial.
            noise: rate below which noise alone may move each compared joint, shape (C,).
        """

        def cut(slow: np.ndarray, rest: np.ndarray | float = 0.0) -> list[Piece]:
            return self._cut(of, slow, rest)

        every = cut(noise) or cut(0.0 * noise)
        moving = cut(noise, self.slow[self._index])
        if 2 * len(moving) > len(every):
            return moving, every
        # its weight at rest is most of what is known: such readings count, so friction asks none of them
        still = [replace(p, motion=replace(p.motion, slow=0.0 * self.slow)) for p in every]
        return still, still

    @property
    def _index(self) -> Sequence[int]:
        return [self.joints.index(j) for j in self.compared]

    def _cut(self, of: Recorded, slow: np.ndarray, rest: np.ndarray | float) -> list[Piece]:
        """Without readings where it is slower than `slow` at some time within a test function, or than `rest` all the
        while."""
        log, half = of.log, of.half
        bump = Bump.of(half, log.step)
        stride = max(1, half // 2)
        channels = tuple(f"joint.{j}.torque" for j in self.compared)
        out = []
        for n, part in enumerate(np.array_split(np.arange(log.time.size), PIECES)):
            if part.size < FEWEST * half:
                continue
            seen = bump.smooth(log.torque[part][:, self._index])[::stride].T
            speed = np.abs(log.velocity[part][:, self._index])
            bad = (~log.good[part][:, None] | (speed < slow)).astype(float)
            over = np.ones(2 * half + 1)
            clean = np.array([np.convolve(b, over, "valid")[::stride] < 0.5 for b in bad.T])
            stays = (speed < rest).astype(float)
            clean &= np.array([np.convolve(s, over, "valid")[::stride] < over.size - 0.5 for s in stays.T])
            at = log.time[part][half:-half][::stride]
            weight = np.where(clean, 1.0, 0.0) / (FIRST_NOISE * self.level[:, None])
            if clean.sum() < FEWEST_READINGS:
                continue
            block = Block(self.sensor, channels, at, np.where(clean, seen, 0.0), weight)
            ends = float(at[0]), float(at[-1])
            trial = TrialData(piece_id(of.key, n), of.condition, dict(of.overrides), (block,), *ends)
            out.append(Piece(trial, self._along(of, part, stride), bump))
        return out

    def _along(self, of: Recorded, part: np.ndarray, stride: int) -> Motion:
        log = of.log
        motion = (log.position, log.velocity, log.acceleration, log.rigid)
        position, velocity, acceleration, rigid = (np.asfortranarray(x[part]) for x in motion)
        return Motion(
            log.step,
            position,
            velocity,
            acceleration,
            rigid,
            stride,
            _joint_by_joint(log.by_link[:, part]),
            torque=log.torque[part],
            slow=self.slow,
            run_up=np.concatenate([*[log.acceleration[:1]] * log.lens.half, log.acceleration[: int(part[0])]]),
            onset=Onset(log.acceleration[0], log.rigid[0], log.torque[0]),
            lens=log.lens,
            wider=log.wider,
            beside={k: own.part(part) for k, own in of.beside.items()},
            turn=None if log.turn is None else log.turn[part],
        )


def _joint_by_joint(x: np.ndarray) -> np.ndarray:
    """The same of shape (K, T, J), with each joint's readings side by side."""
    return np.ascontiguousarray(x.transpose(2, 0, 1)).transpose(1, 2, 0)


def standing(
    trials: Sequence[TrialData], positions: Mapping[str, np.ndarray], far: np.ndarray
) -> tuple[TrialData, ...]:
    """The pieces, those marked in which the machine stands where it stood all through the one before.

    Args:
        trials: pieces, in order.
        positions: of the joints along each, shape (T, J).
        far: within which each counts as standing, shape (J,) [rad or m].
    """
    last: dict[str, TrialData] = {}
    out = []
    for trial in trials:
        before = last.get(trial.recorded)
        if before is not None:
            both = np.concatenate([positions[before.id], positions[trial.id]])
            if np.all(np.ptp(both, axis=0) < far):
                trial = replace(trial, repeats=before.told_by)
        last[trial.recorded] = trial
        out.append(trial)
    return tuple(out)
