"""How strong a hidden torque is: the likelihood ratio of a test that knows its shape and the arm's motion.

A torque s along the motion, seen with white noise, gains the noncentrality lambda = s' (I + N N')^-1 s / sigma^2 over a
refit of masses and inertia within their stated deviations, the columns of N. It grows as the square of the size.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from spacerobot.proof.driven.arm import Log, joints, torque_of
from spacerobot.proof.driven.campaign import ROTOR_SIGMA, TORQUE_NOISE, Campaign, mass_sigma
from spacerobot.proof.driven.hidden import torque
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.strength import critical

THIN = 6
"""Every so many readings are taken along, and count so often."""


def limits_at_one(campaign: Campaign, logs: dict[str, Log], kind: Callable[[float], Missing]) -> float:
    """Strength, in detection limits, of the effect of size 1.

    Args:
        campaign: without it.
        logs: of the campaign; the effect does not move the arm from its path by as much as would matter.
        kind: the effect, by size.
    """
    item = kind(1.0)
    k = joints().index(item.where.removeprefix("joint."))
    seen = [_thinned(log) for log in logs.values()]
    shown = np.zeros((sum(log.time.size for log in seen), len(joints())))
    shown[:, k] = np.concatenate([torque(item, log.position, log.velocity) for log in seen])
    s = (shown / TORQUE_NOISE).ravel()
    columns = np.array(
        [np.concatenate([c / TORQUE_NOISE for c in changes]).ravel() for changes in _wrong(campaign, seen)]
    )
    columns *= math.sqrt(THIN)
    s *= math.sqrt(THIN)
    inner = np.eye(len(columns)) + columns @ columns.T
    score = columns @ s
    gain = float(s @ s - score @ np.linalg.solve(inner, score))
    return math.sqrt(max(gain, 0.0) / critical(len(item.values)))


def _thinned(log: Log) -> Log:
    return Log(log.time[::THIN], log.position[::THIN], log.velocity[::THIN], log.torque[::THIN])


def _wrong(campaign: Campaign, logs: list[Log]) -> list[list[np.ndarray]]:
    """For each believed value, the change of all torques by one stated deviation, trial by trial."""
    plain = [torque_of(campaign.masses, campaign.rotors, log) for log in logs]
    out = []
    for name, mass in campaign.masses.items():
        other = {**campaign.masses, name: mass * (1.0 + mass_sigma(name))}
        out.append([torque_of(other, campaign.rotors, log) - p for log, p in zip(logs, plain, strict=True)])
    for name, inertia in campaign.rotors.items():
        turned = {**campaign.rotors, name: inertia * (1.0 + ROTOR_SIGMA)}
        out.append([torque_of(campaign.masses, turned, log) - p for log, p in zip(logs, plain, strict=True)])
    return out
