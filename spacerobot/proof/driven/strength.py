"""How strong a hidden torque is: the likelihood ratio of a test that knows its shape and the arm's motion.

A torque s along the motion, seen with white noise, gains the noncentrality lambda = s' (I + N N')^-1 s / sigma^2 over a
refit of masses and inertia within their stated deviations, the columns of N. It grows as the square of the size.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from spacerobot.proof.driven.arm import Log, joints, torque_of
from spacerobot.proof.driven.campaign import ROTOR_SIGMA, TORQUE_NOISE, Campaign, mass_sigma
from spacerobot.proof.driven.hidden import torque
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.strength import critical

THIN = 6
"""Every so many readings are taken along, and count so often."""


class Yardstick:
    """Measures effects along the motion of one campaign.

    Args:
        campaign: without them.
        logs: of the campaign; an effect does not move the arm from its path by as much as would matter.
    """

    def __init__(self, campaign: Campaign, logs: Mapping[str, Log]) -> None:
        self._seen = [_thinned(log) for log in logs.values()]
        self._columns = np.array([self._weighed(changes) for changes in _wrong(campaign, self._seen)])

    def limits_at_one(self, kind: Callable[[float], Missing]) -> float:
        """Strength, in detection limits, of an effect of size 1."""
        item, columns = kind(1.0), self._columns
        k = joints().index(item.where.removeprefix("joint."))
        shown = [np.zeros_like(log.torque) for log in self._seen]
        for own, log in zip(shown, self._seen, strict=True):
            own[:, k] = torque(item, log.position, log.velocity)
        s = self._weighed(shown)
        inner = np.eye(len(columns)) + columns @ columns.T
        score = columns @ s
        gain = float(s @ s - score @ np.linalg.solve(inner, score))
        return math.sqrt(max(gain, 0.0) / critical(len(item.values)))

    def _weighed(self, torques: list[np.ndarray]) -> np.ndarray:
        return math.sqrt(THIN) * (np.concatenate(torques) / TORQUE_NOISE).ravel()


def _thinned(log: Log) -> Log:
    return Log(log.time[::THIN], log.position[::THIN], log.velocity[::THIN], log.torque[::THIN])


def _wrong(campaign: Campaign, logs: list[Log]) -> Iterator[list[np.ndarray]]:
    """For each believed value, the change of all torques by one stated deviation, trial by trial."""
    masses, rotors = campaign.masses, campaign.rotors
    others: list[tuple[Mapping[str, float], Mapping[str, float]]] = []
    others += [({**masses, n: m * (1.0 + mass_sigma(n))}, rotors) for n, m in masses.items()]
    others += [(masses, {**rotors, n: i * (1.0 + ROTOR_SIGMA)}) for n, i in rotors.items()]
    plain = torque_of(masses, rotors, logs)
    for other in others:
        yield [changed - p for changed, p in zip(torque_of(*other, logs), plain, strict=True)]
