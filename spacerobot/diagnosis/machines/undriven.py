"""Joints that nothing drives: what their motion tells is ratios of inertia, weight and friction alone.

The noise of a motion asks for torque in proportion to inertia: lighter links would leave less of it, whatever moves,
and links of no mass nothing. What is asked for there is read in proportion to believed inertia:

    tau_read = tau_stated + M_jj / M'_jj (tau_asked - tau_stated)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

LEAST = 1e-3
"""Share of believed inertia that is left at least, where bodies that are not there take off more: a step of a fit."""


@dataclass(frozen=True, eq=False)
class Undriven:
    """Some joints, of which some are not driven. C joints.

    Attributes:
        joints: that are compared.
        stated: of those that nothing drives, the torque there.
        believed: inertia about each joint in the mean pose [kg m^2 or kg].
        by_link: link of doubted mass -> what one more such link adds to that about each joint, shape (C,).
        more: a place -> what each number of what is there adds to it, shape (C, N): of a body at a link, an encoder's
            zero; None of a pull, which adds nothing.
    """

    joints: tuple[str, ...]
    stated: Mapping[str, float]
    believed: np.ndarray
    by_link: Mapping[str, np.ndarray]
    more: Callable[[str], np.ndarray | None]
    _kept: dict[str, np.ndarray | None] = field(default_factory=dict)

    def read(
        self,
        joint: str,
        asked: np.ndarray,
        own: float,
        heavier: Mapping[str, float],
        bodies: Mapping[str, np.ndarray],
    ) -> np.ndarray:
        """What is asked for at a joint, as it is read.

        Args:
            joint: any of these.
            asked: of its drive, shape (T,).
            own: inertia about it beyond what is believed.
            heavier: by link of doubted mass, how many more of it there are.
            bodies: by place, numbers of what is there beside the links.
        """
        if joint not in self.stated:
            return asked
        c = self.joints.index(joint)
        own += sum(by * float(self.by_link[link][c]) for link, by in heavier.items())
        return self.stated[joint] + self._share(c, own, bodies) * (asked - self.stated[joint])

    def rises(self, shown: np.ndarray, where: str, left: np.ndarray, bodies: Mapping[str, np.ndarray]) -> np.ndarray:
        """By how much readings rise with numbers of what is at a place, shape (T, C, N).

        Args:
            shown: the same of what is asked for.
            where: the place.
            left: what is asked for there beyond what is stated, shape (T, C).
            bodies: by place, what is there beside the links.
        """
        out, more = np.array(shown), self._more(where)
        for c, joint in enumerate(self.joints):
            if joint in self.stated:
                share = self._share(c, 0.0, bodies)
                out[:, c] *= share
                if more is not None:
                    out[:, c] -= share**2 * np.outer(left[:, c], more[c] / self.believed[c])
        return out

    def shares(self, bodies: Mapping[str, np.ndarray]) -> np.ndarray:
        """Believed inertia over that with some bodies, 1 of a joint that is driven, shape (C,)."""
        return np.array([self._share(c, 0.0, bodies) if j in self.stated else 1.0 for c, j in enumerate(self.joints)])

    def _share(self, c: int, own: float, bodies: Mapping[str, np.ndarray]) -> float:
        for where, numbers in bodies.items():
            more = self._more(where)
            own += 0.0 if more is None else float(more[c] @ numbers)
        return float(1.0 / max(1.0 + own / self.believed[c], LEAST))

    def _more(self, where: str) -> np.ndarray | None:
        if where not in self._kept:
            self._kept[where] = self.more(where)
        return self._kept[where]
