"""Joints that nothing drives: what their motion tells is ratios of inertia, weight and friction alone.

The noise of a motion asks for torque in proportion to inertia: lighter links would leave less of it, whatever moves,
and links of no mass nothing. What is asked for there is read in proportion to believed inertia, instant by instant:

    tau_read = tau_stated + M_jj(q) / M'_jj(q) (tau_asked - tau_stated)

How readings rise with a number then holds nothing of the joint's own acceleration, which is their noise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from spacerobot.diagnosis.machines.joined_pieces import Joined
from spacerobot.diagnosis.machines.joint_log import Motion
from spacerobot.diagnosis.machines.rigid import Rigid

LEAST = 1e-3
"""Share of believed inertia that is left at least, where bodies that are not there take off more: a step of a fit."""

Along = str | Joined
"""A piece by its id, or pieces in a row."""

Added = Callable[[np.ndarray, str], np.ndarray]
"""Positions of the logged joints, shape (T, J), and a place -> what each number of what is there adds to the inertia
about each joint that feels it, shape (T, C, N)."""


@dataclass(frozen=True, eq=False)
class Undriven:
    """Some joints, of which some are not driven, along pieces of motion. C joints.

    Attributes:
        joints: that are compared.
        at: which of the logged joints they are, shape (C,).
        stated: of those that nothing drives, the torque there.
        motion: the pieces, by id.
        arm: as it is believed.
        beyond: inertia about each joint beyond the arm's, shape (C,) [kg m^2 or kg].
        heavier: link of doubted mass -> the arm with one more such link.
        added: by what is at places.
    """

    joints: tuple[str, ...]
    at: np.ndarray
    stated: Mapping[str, float]
    motion: Mapping[str, Motion]
    arm: Rigid
    beyond: np.ndarray
    heavier: Mapping[str, Rigid]
    added: Added
    _kept: dict[tuple[str, Along], np.ndarray] = field(default_factory=dict)

    def read(
        self,
        joint: str,
        along: Along,
        asked: np.ndarray,
        own: float,
        heavier: Mapping[str, float],
        bodies: Mapping[str, np.ndarray],
    ) -> np.ndarray:
        """What is asked for at a joint, as it is read, shape (T,).

        Args:
            joint: one of these that nothing drives.
            along: which motion.
            asked: of its drive, shape (T,).
            own: inertia about it beyond what is believed.
            heavier: by link of doubted mass, how many more of it there are.
            bodies: by place, numbers of what is there beside the links.
        """
        c, stated = self.joints.index(joint), self.stated[joint]
        if not (own or bodies or any(heavier.values())):
            return asked
        more = own + sum((by * self._more(link, along)[:, c] for link, by in heavier.items() if by), np.zeros(1))
        return np.asarray(stated + self._share(c, along, more, bodies) * (asked - stated))

    def rises(
        self, along: Along, asked: np.ndarray, where: str, left: np.ndarray, bodies: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """By how much what is read rises with numbers of what is at a place, shape (T, C, N).

        Args:
            along: which motion.
            asked: the same of what is asked for.
            where: the place.
            left: what is asked for there beyond what is stated, shape (T, C).
            bodies: by place, what is there beside the links.
        """
        out, added = np.array(asked), self._added(where, along)
        for c, joint in enumerate(self.joints):
            if joint in self.stated:
                share = self._share(c, along, np.zeros(1), bodies)[:, None]
                out[:, c] *= share
                out[:, c] -= share**2 * left[:, c, None] * added[:, c] / self._believed(along)[:, c, None]
        return out

    def shares(self, along: Along, bodies: Mapping[str, np.ndarray]) -> np.ndarray:
        """Believed inertia over that with some bodies, 1 of a joint that is driven, shape (T, C)."""
        out = np.ones(self._believed(along).shape)
        for c, joint in enumerate(self.joints):
            if joint in self.stated:
                out[:, c] = self._share(c, along, np.zeros(1), bodies)
        return out

    def _share(self, c: int, along: Along, more: np.ndarray, bodies: Mapping[str, np.ndarray]) -> np.ndarray:
        for where, numbers in bodies.items():
            more = more + self._added(where, along)[:, c] @ numbers
        return np.asarray(1.0 / np.maximum(1.0 + more / self._believed(along)[:, c], LEAST))

    def _believed(self, along: Along) -> np.ndarray:
        return self._along("", along, lambda q: self._about(self.arm, q) + self.beyond)

    def _more(self, link: str, along: Along) -> np.ndarray:
        other = self.heavier[link]
        return self._along(link, along, lambda q: self._about(other, q) - self._about(self.arm, q))

    def _about(self, arm: Rigid, position: np.ndarray) -> np.ndarray:
        return np.asarray(arm.inertias(position)[:, self.at, self.at])

    def _added(self, where: str, along: Along) -> np.ndarray:
        return self._along(where, along, lambda q: self.added(q, where))

    def _along(self, name: str, along: Along, made: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        if (name, along) not in self._kept:
            motion = self.motion[along] if isinstance(along, str) else along.motion
            self._kept[name, along] = made(motion.position)
        return self._kept[name, along]
