"""What the joints of an arm feel together: bodies on links, a pull beside gravity, zeros of encoders."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations

import numpy as np

from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.contract import numbers_at
from spacerobot.diagnosis.machines.joined_pieces import Joined
from spacerobot.diagnosis.machines.joint_log import Motion, unbent
from spacerobot.diagnosis.machines.rigid import STEP, Rigid

BASE = "base"
"""Where a pull on all that has mass acts."""

ASIDE = 0.01
"""How far a zero is moved to either side for how torque bends with it [rad or m]: error 1e-4 of its square's term."""

LIGHT = 0.25
"""Share of a link's mass by which it is made heavier and lighter for how torque bends with a load on it, afloat."""

TOLD = 9
"""Digits by which two directions of numbers are the same."""


class SharedColumns:
    """Torques that some joints feel, along pieces of motion, in proportion to numbers of what is at a place.

    Attributes:
        links: "link.NAME", base to tip: the last one of each logged joint that they carry; ten numbers of a body each.
        joints: "joint.NAME" of each logged joint; one number each, its encoder's zero. The base has three, a pull.
        there: numbers at some of the places, near which these are.
    """

    def __init__(
        self,
        columns: BodyColumns,
        links: Sequence[str],
        joints: Sequence[str],
        rows: Sequence[int],
        of: Mapping[str, Motion],
    ) -> None:
        """Of places, felt by some of the logged joints, along the pieces' motions by their ids."""
        self._columns, self.links, self._rows, self._motion = columns, tuple(links), list(rows), of
        self.joints = tuple(joints)
        self.there: Mapping[str, np.ndarray] = {}
        self._believed = self
        self._plain: dict[str, np.ndarray] = {}
        self._brought: dict[str, np.ndarray] = {}
        self._along: dict[tuple[str, str], np.ndarray] = {}
        self._terms: dict[tuple[str | Joined, tuple[tuple[str, bytes], ...]], dict[tuple[str, ...], np.ndarray]] = {}

    def along(self, motion: Mapping[str, Motion]) -> SharedColumns:
        """The same along other motions."""
        return SharedColumns(self._columns, self.links, self.joints, self._rows, motion)

    def near(self, numbers: Mapping[str, np.ndarray]) -> SharedColumns:
        """The same where these are at some of the places: what more of each asks for there."""
        other = self.along(self._motion)
        other.there, other._believed = dict(numbers), self
        other._columns = self._columns.of(self._with(numbers))
        return other

    def brought(self, name: str) -> np.ndarray:
        """What all of these ask for there along a piece, shape (T, C)."""
        if not self.there:
            return np.zeros((self._motion[name].position.shape[0], len(self._rows)))
        if name not in self._brought:
            self._brought[name] = self._believed._exactly(name, self._columns.arm, self.there)
        return self._brought[name]

    def numbers(self, where: str, place: np.ndarray | None) -> np.ndarray:
        """Those of a body of 1 kg at a place of a link [m], or spread as the link is, shape (10,)."""
        return self._columns.numbers(where.removeprefix("link."), place)

    def carried(self, where: str, place: np.ndarray | None) -> float:
        """Mass that a link may have at a place, or all of it [kg]; infinite of what is none."""
        return self._columns.carried(where.removeprefix("link."), place) if where.startswith("link.") else np.inf

    def piece(self, name: str, where: str) -> np.ndarray:
        """What each number of what is at a place asks for along a piece, shape (T, C, N)."""
        places, along = self._alike(where)
        kind = places[0]
        if (name, kind) not in self._along:
            m = self._motion[name]
            place = m.position - self._zeros(self.there)
            found = unbent(along, m.lens, m.wider, (place, m.velocity, m.acceleration, m.turn))
            self._along[name, kind] = found.reshape(found.shape[0], len(self._rows), len(places), -1)
        return self._along[name, kind][:, :, places.index(where)]

    def inertia(self, position: np.ndarray, where: str) -> np.ndarray:
        """What each number of what is at a place adds to the inertia about each joint that feels it, in poses (T, J):
        shape (T, C, N); a pull adds nothing."""
        if where in self.links:
            link = where.removeprefix("link.")
            return np.stack([self._columns.inertia(link, row, position) for row in self._rows], axis=1)
        if where in self.joints:
            aside = STEP * (np.array(self.joints) == where)
            less, more = (self._columns.arm.inertias(position + side) for side in (aside, -aside))
            return np.asarray((more - less)[:, self._rows, self._rows, None] / (2.0 * STEP))
        return np.zeros((position.shape[0], len(self._rows), numbers_at(where)))

    def _alike(self, where: str) -> tuple[tuple[str, ...], Callable[..., np.ndarray]]:
        """Places of one kind, whose columns are made at once, and what makes them."""
        if where in self.links:
            links = [link.removeprefix("link.") for link in self.links]
            return self.links, partial(self._columns.along, links, self._rows)
        if where in self.joints:
            return self.joints, partial(self._flat, self._columns.arm.by_zero)
        return (BASE,), partial(self._flat, self._columns.arm.by_gravity)

    def _flat(self, of: Callable[..., np.ndarray], *motion: np.ndarray | None) -> np.ndarray:
        found = of(*motion)[:, self._rows]
        return found.reshape(found.shape[0], -1)

    def asked(self, along: str | Joined, numbers: Mapping[str, np.ndarray]) -> np.ndarray:
        """What all of these together ask for beside the rigid body as it is believed, shape (T, C).

        In pairs: a pull pulls at a body too. With where it stands what an arm asks for bends, to second order in zeros;
        and with what it carries, where its base gives way.

        Args:
            along: a piece by its id, or pieces in a row.
            numbers: of what is at each place, shape (N,).
        """
        amounts: dict[str, float] = {}
        directions: dict[str, np.ndarray] = {}
        for where in sorted(numbers):
            amounts[where], directions[where] = _split(numbers[where])
        key = along, tuple((where, d.tobytes()) for where, d in directions.items())
        if key not in self._terms:
            names = [along] if isinstance(along, str) else list(along.sizes)
            pieces = [self._terms_along(name, directions) for name in names]
            self._terms[key] = {which: np.concatenate([terms[which] for terms in pieces]) for which in pieces[0]}
        found = self._terms[key].items()
        return np.asarray(sum(math.prod(amounts[where] for where in which) * term for which, term in found))

    def _terms_along(self, name: str, directions: Mapping[str, np.ndarray]) -> dict[tuple[str, ...], np.ndarray]:
        """What places and pairs of places ask for along a piece per unit of each, shape (T, C) each."""
        steps = {where: self._step(where) for where in directions}

        def at(of: Mapping[str, float]) -> np.ndarray:
            numbers = {where: x * steps[where] * directions[where] for where, x in of.items()}
            return self._exactly(name, self._with(numbers), numbers)

        ahead = {where: at({where: 1.0}) for where in directions}
        behind = {where: at({where: -1.0}) if self._bends(where) else -ahead[where] for where in directions}
        out: dict[tuple[str, ...], np.ndarray] = {}
        for where, step in steps.items():
            out[where,] = (ahead[where] - behind[where]) / (2.0 * step)
            if self._bends(where):  # else it is in proportion
                out[where, where] = (ahead[where] + behind[where]) / (2.0 * step**2)
        for one, other in combinations(sorted(directions, key=lambda where: where in self.joints), 2):
            size, step = steps[one], steps[other]
            both = at({one: 1.0, other: 1.0}) - ahead[one] - ahead[other]
            if other not in self.joints:
                out[one, other] = both / (size * step)
                continue
            back = at({one: 1.0, other: -1.0}) - ahead[one] - behind[other]
            out[one, other] = (both - back) / (2.0 * size * step)
            out[one, other, other] = (both + back) / (2.0 * size * step**2)
        return out

    def _bends(self, where: str) -> bool:
        """Whether torque is not in proportion to what is there: to a zero, and to a body to which a base yields."""
        return where in self.joints or (where in self.links and self._columns.arm.afloat)

    def _step(self, where: str) -> float:
        """How much of it is added and taken off."""
        if where in self.joints:
            return ASIDE
        own = self.carried(where, None) if self._bends(where) else 0.0
        return LIGHT * own if own > 0.0 else 1.0

    def _exactly(self, name: str, other: Rigid, numbers: Mapping[str, np.ndarray]) -> np.ndarray:
        """What the arm with all of these asks for along a piece beside what it does without, shape (T, C)."""
        m = self._motion[name]
        rest = (m.velocity, m.acceleration, m.turn)

        def asked(arm: Rigid, place: np.ndarray) -> np.ndarray:
            return unbent(arm.torque, m.lens, m.wider, (place, *rest))[:, self._rows]

        if name not in self._plain:  # cut as the piece is, whose ends the lens does not see beyond
            self._plain[name] = asked(self._columns.arm, m.position)
        return np.asarray(asked(other, m.position - self._zeros(numbers)) - self._plain[name])

    def _zeros(self, numbers: Mapping[str, np.ndarray]) -> np.ndarray:
        """Of all joints, shape (J,)."""
        return np.array([float(numbers[j][0]) if j in numbers else 0.0 for j in self.joints])

    def _with(self, numbers: Mapping[str, np.ndarray]) -> Rigid:
        """The arm with these bodies, and under this pull."""
        bodies: dict[int, np.ndarray] = {}
        for where in numbers.keys() & set(self.links):
            joint = self._columns.joint_of(where.removeprefix("link."))
            bodies[joint] = bodies.get(joint, 0.0) + numbers[where]
        return self._columns.arm.with_bodies(bodies, numbers.get(BASE, np.zeros(3)))


def _split(numbers: np.ndarray) -> tuple[float, np.ndarray]:
    """How much there is of some numbers, and along which direction, shape (N,)."""
    most = int(np.argmax(np.abs(numbers)))
    size = float(np.linalg.norm(numbers)) * (1.0 if numbers[most] >= 0.0 else -1.0)
    return size, np.round(numbers / size, TOLD) if size else np.zeros_like(numbers)
