"""Where what all parts of a machine feel may come from, and by how much each lowers their common chi-squared.

All parts' chi-squared is a quadratic form of numbers of what is at shared places: ten of a body at each link, three of
a pull on the base, the zero of each encoder. An effect is some of these: all three of a pull, those of a point mass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import minimize

from spacerobot.diagnosis.machines.contract import Machine, numbers_at
from spacerobot.diagnosis.selection.nested_laws import by_chance, chance_edge
from spacerobot.diagnosis.terms.candidates import stood_for
from spacerobot.effects.effect import Effect
from spacerobot.effects.settled import form_of, shape_of

REACH = 1.0
"""Furthest that a load may be from its link's origin [m]: beyond that it is another link's."""

ASIDE = 0.1
"""How far from the origin a search for its place also begins [m]."""

ROUNDING = 1e-6
"""Share of the largest direction below which one is rounding."""

FREE = {"point": 4, "whole": 1, "field": 3, "zero": 1}
"""By how an effect is felt, how many numbers of it are free: a point mass has its place, a pull its direction."""

Numbers = Callable[[str, np.ndarray | None], np.ndarray]
"""Link and place [m] -> the ten numbers of a body of 1 kg there; without a place, of one spread as the link is."""


@dataclass(frozen=True, eq=False)
class Source:
    """An effect at a place.

    Attributes:
        effect: felt together.
        where: its place.
        at: its numbers among those of all places.
        numbers: of a body.
        carried: mass that may be there already [kg], of a body, by link and place; less than all of it may be missing.
        across: of a pull, what it is level to, shape (3,): a base that leans does not change how strong gravity is.
    """

    effect: Effect
    where: str
    at: slice
    numbers: Numbers
    carried: Callable[[str, np.ndarray | None], float]
    across: np.ndarray | None = None

    @property
    def free(self) -> int:
        """How many of its numbers are free."""
        return FREE[self.effect.together] - (self.across is not None)

    def price(self, looks: int) -> float:
        """What chance makes of all its free numbers but one, among so many sources."""
        return chance_edge(self.free - 1, looks) if self.free > 1 else 0.0

    def best(self, normal: np.ndarray, right: np.ndarray) -> Found:
        """What of it lowers a quadratic form, normal matrix and right-hand side of all places' numbers, most."""
        return self.minima(normal, right)[0]

    def minima(self, normal: np.ndarray, right: np.ndarray) -> list[Found]:
        """The best, and of a point mass how it does best near other places, in order."""
        own, pull = normal[self.at, self.at], right[self.at]
        places = self._places(own, pull) if self.effect.together == "point" else [None]
        return [self._at(place, own, pull) for place in places]

    def _at(self, place: np.ndarray | None, own: np.ndarray, pull: np.ndarray) -> Found:
        directions = self.directions(place)
        much = amounts(own, pull, list(directions.T))
        if place is not None:
            much = np.clip(much, *self.range(place))
        numbers = directions @ much
        return self.found(much, numbers, float(2.0 * pull @ numbers - numbers @ own @ numbers), place)

    def found(self, much: np.ndarray, numbers: np.ndarray, gain: float, place: np.ndarray | None) -> Found:
        """So much of it along its directions, its numbers with that, which gain so much unless that cannot be."""
        return Found(self, gain if self.possible(much, place) else 0.0, numbers, self.form(numbers, place))

    def range(self, place: np.ndarray | None) -> tuple[float, float]:
        """The least and the most that there may be of it, at a place where it has one."""
        most = self.effect.strength
        return max(most.lower, -self.carried(self.where, place) * (1.0 - ROUNDING)), most.upper

    def possible(self, much: np.ndarray, place: np.ndarray | None) -> bool:
        """Whether there may be so much of it, along each of its directions.

        What nothing reads would take an amount that nothing has: its columns are rounding.
        """
        least, most = self.range(place)
        return bool(np.all((least <= much) & (much <= most)))

    def directions(self, place: np.ndarray | None) -> np.ndarray:
        """Along what its numbers may lie, shape (N, D): a body's along one, a pull's along any.

        Args:
            place: of a point mass, shape (3,).
        """
        if self.across is not None:
            return np.linalg.svd(self.across[None])[2][1:].T
        if self.effect.together in ("field", "zero"):
            return np.eye(self.at.stop - self.at.start)
        return self.numbers(self.where, place)[:, None]

    def form(self, numbers: np.ndarray, place: np.ndarray | None) -> str:
        """Its shape: the place of a point mass, the direction of a pull; empty of what has none."""
        size = float(np.linalg.norm(numbers))
        if place is not None:
            return form_of(place)
        return form_of(numbers / size) if self.effect.together == "field" and size > 0.0 else ""

    def _places(self, own: np.ndarray, pull: np.ndarray) -> list[np.ndarray]:
        """Of the best point masses at a link, shape (3,) each, best first; nought along what no reading tells."""
        bent = self._bent
        norms, mets = bent.T @ own @ bent, bent.T @ pull

        def loss(place: np.ndarray) -> float:
            powers = _powers(place)
            norm, met = float(powers @ norms @ powers), float(powers @ mets)
            much = met / norm if norm > 0.0 else 0.0
            if much < 0.0 or much > self.effect.strength.upper:
                much = float(np.clip(much, *self.range(place)))
            return much * (much * norm - 2.0 * met)

        starts = [np.zeros(3), *ASIDE * np.eye(3), *-ASIDE * np.eye(3)]
        ends = [minimize(loss, start, method="L-BFGS-B", bounds=[(-REACH, REACH)] * 3) for start in starts]
        return [_told(loss, np.asarray(end.x)) for end in sorted(ends, key=lambda end: float(end.fun))]

    @cached_property
    def _bent(self) -> np.ndarray:
        """What each of a place's powers makes of a point mass's numbers, shape (N, 10): they go as its square."""
        some = [*np.eye(3), *-np.eye(3), np.zeros(3), *(1.0 - np.eye(3))]
        numbers = np.stack([self.numbers(self.where, place) for place in some])
        return np.asarray(np.linalg.solve(np.stack([_powers(place) for place in some]), numbers).T)


def _powers(place: np.ndarray) -> np.ndarray:
    """1, what a place is, and the products of its numbers, shape (10,)."""
    x, y, z = place.tolist()
    return np.array([1.0, x, y, z, x * x, y * y, z * z, y * z, x * z, x * y])


def _told(loss: Callable[[np.ndarray], float], place: np.ndarray) -> np.ndarray:
    """A place, nought along each axis of which readings tell no more than chance would: none, in a plane, of depth."""
    for k in range(place.size):
        less = np.where(np.arange(place.size) == k, 0.0, place)
        if by_chance(loss(less) - loss(place), 1):
            place = less
    return place


@dataclass(frozen=True, eq=False)
class Found:
    """What of a source does best.

    Attributes:
        source: which.
        gain: by how much chi-squared falls.
        numbers: of it, shape (N,).
        form: its shape; empty where it has none.
    """

    source: Source
    gain: float
    numbers: np.ndarray
    form: str

    def among(self, size: int) -> np.ndarray:
        """Its numbers among those of all places, shape (size,)."""
        out = np.zeros(size)
        out[self.source.at] = self.numbers
        return out


def placed(effects: Sequence[Effect], places: Sequence[str], machines: Sequence[Machine]) -> list[Source]:
    """Effects wherever machines that feel them may have them, but for those that a fitted value stands for."""
    ends = np.cumsum([numbers_at(place) for place in places]).tolist()
    at = {place: slice(end - numbers_at(place), end) for place, end in zip(places, ends, strict=True)}
    plain, fitted = [m.plain() for m in machines], {name for m in machines for name in m.believed.fitted}
    out = []
    for effect in effects:
        open_to = {where for mechanism in plain for where in effect.places(mechanism)}
        some = [p for p in places if p in open_to and not stood_for(effect, p, fitted)]
        out += [Source(effect, p, at[p], machines[0].numbers, machines[0].carried) for p in some]
        down = np.array(plain[0].gravity if plain[0].gravity is not None else np.zeros(3))
        if effect.together == "field" and down.any():  # of those that do alike the last is taken
            out += [replace(source, across=down) for source in out if source.effect is effect]
    return out


def without(normal: np.ndarray, right: np.ndarray, directions: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """A quadratic form, normal matrix and right-hand side, some directions of its numbers, shape (N,) each, free."""
    if not directions:
        return normal, right
    along = np.stack(directions, axis=1)
    turned = normal @ along
    back = np.linalg.pinv(along.T @ turned, rcond=ROUNDING**2, hermitian=True)
    return normal - turned @ back @ turned.T, right - turned @ (back @ (along.T @ right))


def gained(normal: np.ndarray, right: np.ndarray, direction: np.ndarray) -> float:
    """By how much a quadratic form falls along a direction."""
    norm, met = float(direction @ normal @ direction), float(direction @ right)
    return met**2 / norm if norm > 0.0 else 0.0


def amounts(normal: np.ndarray, right: np.ndarray, directions: Sequence[np.ndarray]) -> np.ndarray:
    """How much of each direction does best beside the others, shape (directions,)."""
    along = np.stack(directions, axis=1)
    return np.asarray(np.linalg.lstsq(along.T @ normal @ along, along.T @ right, rcond=ROUNDING**2)[0])


def at_once(normal: np.ndarray, right: np.ndarray, found: Sequence[Found]) -> list[Found]:
    """The same sources, their places and amounts what does best for all of them at once."""
    points = [k for k, one in enumerate(found) if one.source.effect.together == "point"]

    def directions(places: np.ndarray) -> list[np.ndarray]:
        """Of each source among the numbers of all places, shape (N, D)."""
        at, out = dict(zip(points, places.reshape(-1, 3), strict=True)), []
        for k, one in enumerate(found):
            own = one.source.directions(at.get(k))
            out.append(np.zeros((right.size, own.shape[1])))
            out[-1][one.source.at] = own
        return out

    def loss(places: np.ndarray) -> float:
        along = np.concatenate(directions(places), axis=1)
        return -float(right @ along @ amounts(normal, right, list(along.T)))

    start = np.array([shape_of(found[k].form) for k in points]).ravel()
    end = minimize(loss, start, method="L-BFGS-B", bounds=[(-REACH, REACH)] * start.size).x if points else start
    out, parts = [], directions(end)
    best = amounts(normal, right, list(np.concatenate(parts, axis=1).T))
    for k, (one, part) in enumerate(zip(found, parts, strict=True)):
        own, best = best[: part.shape[1]], best[part.shape[1] :]
        numbers = (part @ own)[one.source.at]
        rest = without(normal, right, [d for n, other in enumerate(parts) if n != k for d in other.T])
        place = end.reshape(-1, 3)[points.index(k)] if k in points else None
        out.append(one.source.found(own, numbers, float(rest[1][one.source.at] @ numbers), place))
    return out


def best_of(normal: np.ndarray, right: np.ndarray, sources: Sequence[Source]) -> tuple[Found, list[Found]]:
    """The source that does best, each free number beyond the first at the price of what chance would make of it.

    Of places that do alike by one effect the last: what is carried is carried in the hand.

    Returns:
        It, and of each other kind (a body, a pull, a zero) the best one that does as well: none can tell these apart.
    """
    edge, leading = chance_edge(1), []
    for effect in dict.fromkeys(s.effect.name for s in sources):
        tried = [s.best(normal, right) for s in sources if s.effect.name == effect]
        most = max(one.gain for one in tried)
        leading.append(next(one for one in reversed(tried) if one.gain >= most - edge))
    best = max(leading, key=lambda one: one.gain - one.source.price(len(sources)))
    alike: dict[str, Found] = {}
    for one in sorted(leading, key=lambda one: one.source.free):
        kind = one.source.effect.kind
        if kind != best.source.effect.kind and one.gain >= best.gain - edge:
            alike.setdefault(kind, one)
    return best, list(alike.values())
