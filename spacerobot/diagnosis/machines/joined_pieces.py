"""Pieces of measured motion in a row, so that what acts at an instant alone is worked out for all of them at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.machines.joint_log import Motion
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.effects.mechanism import Mechanism

INSTANT = ("gain", "offset")
"""What sensors do that hangs on no other moment."""


def instant(mechanism: Mechanism) -> bool:
    """Whether nothing in a mechanism of measured motion hangs on any other moment than its own."""
    hidden = any(c.carrier is not None for c in mechanism.coordinates.values())
    return not (hidden or mechanism.states) and all(m.kind in INSTANT for m in mechanism.maps)


@dataclass(frozen=True, eq=False)
class Joined:
    """Pieces that are seen through the same test functions. T samples in all, N of them shown.

    Attributes:
        motion: of all, one after the other.
        bump: the test function that their balances are seen through.
        sizes: samples of each piece, by its id, in order.
    """

    motion: Motion
    bump: Bump
    sizes: Mapping[str, int]

    @cached_property
    def starts(self) -> np.ndarray:
        """Where each piece begins, and the end."""
        return np.cumsum([0, *self.sizes.values()])

    @cached_property
    def shown(self) -> dict[str, slice]:
        """Each piece's readings among those of all."""
        ends = np.cumsum([0, *(self._readings(n).size for n in self.sizes.values())])
        return {name: slice(*ends[k : k + 2]) for k, name in enumerate(self.sizes)}

    def _readings(self, size: int) -> np.ndarray:
        return np.arange(0, size - 2 * self.bump.half, self.motion.stride)

    @cached_property
    def _at(self) -> np.ndarray:
        pairs = zip(self.starts, self.sizes.values(), strict=False)
        return np.concatenate([first + self._readings(n) for first, n in pairs])

    @cached_property
    def _ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Where samples come from once each piece goes on at its ends; and which means of these are the pieces' own."""
        half = self.motion.lens.half
        pairs = list(zip(self.starts, self.sizes.values(), strict=False))
        source = [first + np.clip(np.arange(-half, n + half), 0, n - 1) for first, n in pairs]
        own = [first + 2 * half * k + np.arange(n) for k, (first, n) in enumerate(pairs)]
        return np.concatenate(source), np.concatenate(own)

    def blurred(self, x: np.ndarray) -> np.ndarray:
        """As the lens blurs each piece, which goes on at its ends as it is there, shape (T,) both."""
        source, own = self._ends
        return np.asarray(self.motion.lens.smooth(x[source])[own])

    def seen(self, x: np.ndarray) -> np.ndarray:
        """A signal along the motion, shape (T,), as the pieces' readings show it, shape (N,)."""
        return np.asarray(self.bump.smooth(x)[self._at])


KEPT = 64
"""Mechanisms whose readings are kept: all columns of a Jacobian are some twenty, and each piece asks for them again."""


class Rows:
    """Pieces in rows, and what was lately made of all of a row at once."""

    def __init__(self, pieces: Mapping[str, tuple[Motion, Bump]]) -> None:
        self._pieces = pieces
        self._made: dict[tuple[int, int], tuple[Mechanism, np.ndarray | None]] = {}

    @cached_property
    def _of(self) -> dict[str, Joined]:
        return {name: row for row in join(self._pieces) for name in row.sizes}

    def shown(
        self, piece: str, mechanism: Mechanism, make: Callable[[Mechanism, Joined], np.ndarray]
    ) -> np.ndarray | None:
        """A piece's readings, shape (C, N); None where not every instant is its own.

        Args:
            piece: which.
            mechanism: what acts.
            make: the readings of all pieces of a row.
        """
        row = self._of.get(piece)
        if row is None:
            return None
        found = self._made.get((id(mechanism), id(row)))
        if found is None or found[0] is not mechanism:
            if len(self._made) >= KEPT:
                self._made.clear()
            made = make(mechanism, row) if instant(mechanism) else None
            found = self._made[id(mechanism), id(row)] = mechanism, made
        return None if found[1] is None else found[1][:, row.shown[piece]]


def join(pieces: Mapping[str, tuple[Motion, Bump]]) -> list[Joined]:
    """Pieces by what they are seen through; none that hangs on factors of its own."""
    groups: dict[object, list[str]] = {}
    for name, (m, bump) in pieces.items():
        if not m.beside:
            alike = (m.step, m.stride, m.wider, m.lens.half, bump.half, m.slow.tobytes(), m.torque is None)
            groups.setdefault(alike, []).append(name)
    return [_joined([(n, *pieces[n]) for n in names]) for names in groups.values()]


def _joined(pieces: Sequence[tuple[str, Motion, Bump]]) -> Joined:
    motions = [m for _, m, _ in pieces]
    first = motions[0]

    def row(of: str, axis: int = 0) -> np.ndarray:
        return np.asfortranarray(np.concatenate([getattr(m, of) for m in motions], axis=axis))

    whole = replace(
        first,
        position=row("position"),
        velocity=row("velocity"),
        acceleration=row("acceleration"),
        rigid=row("rigid"),
        by_link=row("by_link", axis=1),
        torque=None if first.torque is None else row("torque"),
        turn=None if first.turn is None else row("turn"),
        run_up=first.run_up[:0],
    )
    return Joined(whole, pieces[0][2], {name: m.position.shape[0] for name, m, _ in pieces})
