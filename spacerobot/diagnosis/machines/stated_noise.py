"""What the stated noise of a joint's sensors makes of the torque balance that is compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.machines.test_functions import Bump

STILL = 4.0
"""A speed within so many standard deviations of its noise is none."""


@dataclass(frozen=True)
class Lens:
    """Through what a piece's readings are seen.

    Attributes:
        narrow: the test function that its motion is taken through, at the log's own rate.
        wide: the test function of its balance, at the thinned rate.
        thin: every so manieth sample is kept between the two.
    """

    narrow: Bump
    wide: Bump
    thin: int

    def gain(self, kernel: np.ndarray) -> float:
        """Variance of a reading over that of white noise, which passes one of the narrow kernels and then the wide."""
        spread = np.zeros(self.thin * (self.wide.weight.size - 1) + 1)
        spread[:: self.thin] = self.wide.weight
        return float(np.sum(np.convolve(spread, kernel) ** 2))


@dataclass(frozen=True, eq=False)
class StatedNoise:
    """What stated noise makes of a balance's reading.

    The torque's noise passes through both test functions; the motion's through their derivatives, as an acceleration
    that the inertia turns into a torque. Weight and Coriolis forces pass on far less.

    Attributes:
        torque: joint -> variance of its torque's share [N^2 m^2].
        shaken: variance of each joint's acceleration as seen, shape (J,).
    """

    torque: Mapping[str, float]
    shaken: np.ndarray

    def of(self, joint: str, inertia: np.ndarray) -> float:
        """Standard deviation for a joint with this row of the joint-space inertia, shape (J,) [N m]."""
        return float(np.sqrt(self.torque[joint] + inertia**2 @ self.shaken))


def stated_noise(noise: Mapping[str, float], joints: Sequence[str], lenses: Sequence[Lens]) -> StatedNoise | None:
    """Of joints whose balance is seen through these lenses, one a piece.

    Args:
        noise: standard deviations by channel.
        joints: names.
        lenses: of each piece.

    Returns:
        None where a torque's noise, or that of what accelerations are taken from, is not stated; or without a piece.
    """
    if not lenses:
        return None
    rates = all(f"joint.{j}.velocity" in noise for j in joints)
    of = "velocity" if rates else "position"
    if not all(f"joint.{j}.{kind}" in noise for j in joints for kind in ("torque", of)):
        return None
    smooth = float(np.mean([lens.gain(lens.narrow.weight) for lens in lenses]))
    bent = float(np.mean([lens.gain(lens.narrow.slope if rates else lens.narrow.curve) for lens in lenses]))
    torque = {j: noise[f"joint.{j}.torque"] ** 2 * smooth for j in joints}
    return StatedNoise(torque, np.array([noise[f"joint.{j}.{of}"] ** 2 * bent for j in joints]))


def still_below(noise: Mapping[str, float], joint: str, narrow: Bump) -> float:
    """Speed below which a joint may stand still, as seen through its narrow test function [rad/s or m/s].

    Zero where the noise is not stated.
    """
    rate, place = (noise.get(f"joint.{joint}.{kind}") for kind in ("velocity", "position"))
    if rate is not None:
        return STILL * rate * float(np.linalg.norm(narrow.weight))
    return STILL * (place or 0.0) * float(np.linalg.norm(narrow.slope))
