"""Locate for the general models: torque balances of joint logs, and anything that is simulated window by window."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.locate.beliefs import STEP, believed_values, deviations
from spacerobot.diagnosis.locate.locate import locate
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.locate.readings import LEAST
from spacerobot.diagnosis.locate.series import BalanceSeries, locate_series
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.platform import Platform
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.machines.windows import Drive
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id

DRIVE = "recorded drive"
"""Stream name of the inputs that are put among a trial's channels."""

LONGEST = 600
"""Samples that one stretch of a long recording has."""

PIECES = 12

TRACK = 2.0
"""Half width [s] of the test functions that a slow base's track is seen through."""

UNEVEN = 0.1
"""Share of the usual gap between two samples below which they are one moment."""

DRIVE_NOISE = 0.01
"""Noise of a recorded drive as a share of its rms; how much matters little where the noise is not known."""


def locate_model(model: Machine, trials: Sequence[TrialData] = ()) -> Located | None:
    """Test a general model's balances; the noise is taken as unknown. None where it has none of its own.

    Args:
        model: from `models.choose`.
        trials: the model's own, under the weights that a fit has given them; what believed values may be wrong by is
            weighed against these.

    Raises:
        NothingToBalance: every trial is too short for a balance.
    """
    if isinstance(model, InverseDynamics):
        return locate_series(joint_series(model, trials or model.trials))
    if isinstance(model, Platform):
        return locate_series(track_series(model))
    if isinstance(model, Simulated):
        pieces = tuple(p for t in model.recorded.values() for p in _pieces(_with_drive(model, t)))
        return locate(model, pieces, noise_known=False)
    return None


def joint_series(model: InverseDynamics, trials: Sequence[TrialData]) -> list[BalanceSeries]:
    """The torque balances of joint logs, a series for each joint and piece; `trials` as in `locate_model`."""
    none = np.zeros(0)
    out = []
    for trial in trials:
        own = believed_values(model, trial)
        base = model.predict(model.mechanism(own, trial), trial, none).blocks[0]
        moved = {}
        for name, size in deviations(model.believed, own, model.trials).items():
            step = STEP * (abs(own[name]) or size)
            other = model.mechanism({**own, name: own[name] + step}, trial)
            moved[name] = (model.predict(other, trial, none).blocks[0] - base) * (size / step)
        motion, block = model.measured(trial), trial.blocks[0]
        for k, joint in enumerate(model.compared):
            good = block.weight[k] > 0.0
            if good.sum() < LEAST:
                continue
            index = model.joints.index(joint)
            out.append(
                BalanceSeries(
                    f"joint.{joint}",
                    model.angular(joint),
                    trial.id,
                    (block.value[k] - base[k])[good],  # the drive's torque is a known force here, the rest is asked for
                    1.0 / block.weight[k][good],
                    motion.position[:, index],
                    motion.velocity[:, index],
                    _eye(model, trial, good),
                    {name: -change[k][good] for name, change in moved.items() if np.any(change[k])},
                )
            )
    return out


def track_series(model: Platform) -> list[BalanceSeries]:
    """The force and torque balances of a floating base: what its track needs beyond what momentum gives it.

    The common motion of track and prediction, and with it any error of the start, has no second derivative: none is
    left in the test functions' integrals.
    """
    out = []
    for trial in model.trials:
        mechanism = model.mechanism(believed_values(model, trial), trial)
        start = np.array([n.guess for n in model.nuisances(trial)])
        shown = model.predict(mechanism, trial, start).blocks
        for block, predicted in zip(trial.blocks, shown, strict=True):
            name = mechanism.readouts[block.channels[0]].of
            coordinate = mechanism.coordinates[name]
            step = float(np.median(np.diff(block.time)))
            grid = np.arange(block.time[0], block.time[-1], step)
            track, gap = (np.interp(grid, block.time, x) for x in (block.value[0], predicted[0] - block.value[0]))
            bump = Bump.of(max(3, round(TRACK / step)), step)
            residual = coordinate.mass * bump.acceleration(gap)[:: bump.half // 2]
            sigma = np.full(residual.size, float(np.std(residual)) or 1.0)
            speed = np.gradient(track, grid)
            see = _spaced(bump)
            out.append(BalanceSeries(name, coordinate.angular, trial.id, residual, sigma, track, speed, see))
    return out


def _spaced(bump: Bump) -> Callable[[np.ndarray], np.ndarray]:
    """Through test functions a quarter of their width apart."""
    return lambda patterns: bump.smooth(patterns)[:: bump.half // 2]


def _eye(model: InverseDynamics, trial: TrialData, good: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    return lambda patterns: model.seen(trial, patterns)[good]


def _pieces(trial: TrialData) -> list[TrialData]:
    """A long trial as PIECES stretches, evenly over it, each short enough for narrow test functions."""
    step = max(float(np.median(np.diff(b.time))) for b in trial.blocks if b.stream != DRIVE)
    length = LONGEST * step
    if trial.end - trial.start < 2.0 * length:
        return [trial]
    count = min(PIECES, int((trial.end - trial.start) / length))
    out = []
    for n, begin in enumerate(np.linspace(trial.start, trial.end - length, count)):
        inside = [(b, slice(*np.searchsorted(b.time, [begin, begin + length]))) for b in trial.blocks]
        blocks = tuple(
            replace(b, time=b.time[part], value=b.value[:, part], weight=b.weight[:, part]) for b, part in inside
        )
        piece = replace(trial, id=piece_id(trial.id, n), blocks=blocks, start=float(begin), end=float(begin + length))
        out.append(piece)
    return out


def _with_drive(model: Simulated, trial: TrialData) -> TrialData:
    """The trial with its recorded inputs among its channels."""
    drive = model.drives.get(trial.id)
    if drive is None or not drive.value:
        return trial
    time = _evenly(drive)
    value = np.array([np.interp(time, drive.time, one) for one in drive.value.values()])
    rms = np.sqrt(np.mean(value**2, axis=1, keepdims=True))
    weight = np.ones_like(value) / np.maximum(DRIVE_NOISE * rms, 1e-300)
    return replace(trial, blocks=(*trial.blocks, Block(DRIVE, tuple(drive.value), time, value, weight)))


def _evenly(drive: Drive) -> np.ndarray:
    """Its times with no two of them almost alike: what is held until the next command is written at both ends of a
    jump, and the smooth curve through such a pair is anywhere but between them.
    """
    first, last = drive.time[0], drive.time[-1]
    if np.diff(drive.time).min(initial=np.inf) > UNEVEN * drive.step:
        return drive.time
    return np.asarray(np.linspace(first, last, 2 * math.ceil((last - first) / drive.step) + 1))
