"""A logged torque that is not what moved its joint."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from spacerobot.diagnosis.machines.joint_log import Motion
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.terms.data import TrialData

SILENT = 0.1
"""A torque that varies by less than this share of what its own weight and inertia ask for is not what moved the joint:
friction adds to it, nothing that a body can be takes nine tenths of it away."""


def why_silent(
    trials: Iterable[TrialData],
    asked: Callable[[TrialData], np.ndarray],
    seen: Callable[[TrialData, np.ndarray], np.ndarray],
    unit: str,
) -> str:
    """Why a joint's logged torque tells nothing of it; empty where it does, or may.

    Args:
        trials: pieces with its torque as their first channel.
        asked: what the motion of a piece asks for, shape (T,).
        seen: such a signal as a piece's readings show it.
        unit: of the torque.
    """
    told, needed = [], []
    for trial in trials:
        (block,) = trial.blocks
        counted = block.weight[0] > 0.0
        told.append(block.value[0][counted])
        needed.append(seen(trial, asked(trial))[counted])
    shown, moved = (float(np.std(np.concatenate(x))) for x in (told, needed))
    if shown >= SILENT * moved:
        return ""
    return f"its torque reads {shown:.2g} {unit} rms about its mean where the motion asks for {moved:.2g}"


def asked_along(motion: Mapping[str, Motion], k: int, weight: Rigid | None, trial: TrialData) -> np.ndarray:
    """What a motion asks of the k-th joint; its weight alone where its own inertia is not known, shape (T,)."""
    along = motion[trial.id]
    if weight is None:
        return along.rigid[:, k]
    still = np.zeros_like(along.velocity)
    return weight.torque(along.position, still, still)[:, k]
