"""What is read of bodies on links, a pull beside gravity and zeros of encoders; also where nothing drives a joint."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.machines.shared_columns import SharedColumns
from spacerobot.diagnosis.machines.undriven import Undriven


@dataclass(frozen=True, eq=False)
class FeltBodies:
    """Along pieces of motion, of C joints that are compared.

    Attributes:
        columns: what is asked for, by number of what is at a place.
        undriven: how it is read where nothing drives a joint.
        asked: piece -> what is asked for as is believed, shape (T, C).
    """

    columns: SharedColumns
    undriven: Undriven
    asked: Callable[[str], np.ndarray]
    _left: dict[str, np.ndarray] = field(default_factory=dict)

    def near(self, numbers: Mapping[str, np.ndarray]) -> FeltBodies:
        """The same where these are at some of the places."""
        return replace(self, columns=self.columns.near(numbers))

    def rises(self, piece: str, where: str) -> np.ndarray:
        """By how much what is read rises with each number of what is at a place, shape (T, C, N)."""
        rises = self.columns.piece(piece, where)
        if not self.undriven.stated:
            return rises
        left = self._beyond(piece) + self.columns.brought(piece)
        return self.undriven.rises(piece, rises, where, left, self.columns.there)

    def bent(self, piece: str) -> np.ndarray:
        """What is read of all that is there beside what is in proportion to it, shape (T, C)."""
        there, whole = self.columns.there, self.columns.brought(piece)
        if self.undriven.stated:
            shares = self.undriven.shares(piece, there)
            whole = shares * whole + (shares - 1.0) * self._beyond(piece)
        return np.asarray(whole - sum(self.rises(piece, where) @ x for where, x in there.items()))

    def _beyond(self, piece: str) -> np.ndarray:
        """What is asked for beyond what is stated of joints that nothing drives, as is believed, shape (T, C)."""
        if piece not in self._left:
            stated = [self.undriven.stated.get(j, 0.0) for j in self.undriven.joints]
            self._left[piece] = self.asked(piece) - np.array(stated)
        return self._left[piece]
