"""The exact motion of Eqs. 2 to 4: matrix exponentials between events, events by root finding.

Between events the three masses are a linear system with constant forces, so that the state at any time is a
matrix exponential away; nothing is discretised. Events are found to the last digits: every extremum of every
event function is bracketed inside its step, so that a touch shorter than a step is not stepped over.

The unilateral contact never pulls: F = max(0, k_c d + c_c d') while d > 0. The bilateral reading ("adhesive")
keeps the contact spring attached, as the paper's Eq. 14 does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.matrix_exponential import expm
from spacerobot.theory.roots import bracketed_root

Array = NDArray[np.float64]
_BLOCK = 128
_MAX_SEGMENTS = 2000


@dataclass(frozen=True)
class Segment:
    """One stretch of time without an event.

    Attributes:
        start: its beginning, s.
        end: its end, s.
        touching: the contact spring acts.
        guide: 0 no sliding friction or stuck, +1 and -1 the direction in which the wrist slides.
        stuck: the wrist is held to the hand.
        state: (x_h, x_w, x_t, v_h, v_w, v_t, 1) at the beginning, shape (7,).
        matrix: A of z' = A z, shape (7, 7).
    """

    start: float
    end: float
    touching: bool
    guide: int
    stuck: bool
    state: Array
    matrix: Array


@dataclass(frozen=True)
class Event:
    """A change of mode: "touch", "release", "stick", "slip", "reverse" (of sliding) or "returned"."""

    time: float
    kind: str


@dataclass(frozen=True)
class Motion:
    """An exact solution.

    Attributes:
        system: the three masses.
        segments: in order of time, without gaps.
        events: in order of time; the first is the touch at t = 0.
    """

    system: ThreeMasses
    segments: tuple[Segment, ...]
    events: tuple[Event, ...]

    @property
    def end(self) -> float:
        """The last time of the solution, s."""
        return self.segments[-1].end

    def times_of(self, kind: str) -> list[float]:
        """The times of all events of one kind, s."""
        return [e.time for e in self.events if e.kind == kind]

    @property
    def first_release(self) -> float:
        """Duration of the first contact, s; infinite if it never ended."""
        return next((e.time for e in self.events if e.kind == "release"), math.inf)

    @property
    def contact_time(self) -> float:
        """First touch to last separation, s; infinite if they still touch at the end."""
        return math.inf if self.segments[-1].touching else max(self.times_of("release"), default=math.inf)

    @property
    def summed_contact_time(self) -> float:
        """The time in which the contact acted, s."""
        return sum(s.end - s.start for s in self.segments if s.touching)

    def _locate(self, time: float) -> Segment:
        for segment in self.segments:
            if time <= segment.end:
                return segment
        return self.segments[-1]

    def state(self, time: float | Array) -> Array:
        """(x_h, x_w, x_t, v_h, v_w, v_t) in m and m/s, shape (..., 6) for times of shape (...).

        Raises:
            ValueError: a time lies outside the solution.
        """
        times = np.asarray(time, dtype=float)
        if times.size and (times.min() < 0 or times.max() > self.end * (1 + 1e-12)):
            given = f"{times.min()!r} to {times.max()!r}"
            raise ValueError(f"times must lie in [0, {self.end!r}] s; given: {given}")
        rows = []
        for t in times.ravel():
            segment = self._locate(float(t))
            rows.append((expm(segment.matrix * (float(t) - segment.start)) @ segment.state)[:6])
        return np.array(rows).reshape(*times.shape, 6)

    def contact_force(self, time: float | Array) -> Array:
        """The contact force in N, positive in compression, shape of `time`."""
        times = np.asarray(time, dtype=float)
        acts = np.array([self._locate(float(t)).touching for t in times.ravel()]).reshape(times.shape)
        return np.where(acts, self.state(times) @ self.system.contact_force, 0.0)


def solve(
    system: ThreeMasses,
    target_velocity: float,
    *,
    hand_velocity: float = 0.0,
    duration: float | None = None,
    adhesive: bool = False,
    stop: str = "duration",
) -> Motion:
    """Follow Eqs. 2 to 4 from the first touch, the spring relaxed and the wrist moving with the hand.

    Args:
        system: the three masses.
        target_velocity: of the target before the touch, m/s.
        hand_velocity: of hand and wrist before the touch, m/s; below the target's.
        duration: how long at most, s; the default is four half periods of the reduced system (Eq. 10).
        adhesive: the bilateral reading, in which the contact spring also pulls and never lets go.
        stop: "duration", "release" (end of the first contact) or "returned" (wrist deflection back at zero,
            the end condition of Eq. 14).

    Returns:
        The motion.

    Raises:
        ValueError: the target does not approach, or `stop` is unknown.
    """
    if not target_velocity > hand_velocity:
        raise ValueError(
            "the target must approach: its velocity must exceed the hand's; "
            f"given: target {target_velocity!r}, hand {hand_velocity!r} m/s"
        )
    if stop not in {"duration", "release", "returned"}:
        raise ValueError(f"stop must be 'duration', 'release' or 'returned'; given: {stop!r}")
    if duration is None:
        lumped = system.wrist_mass + system.target_mass
        mobility = system.hand_mobility + 1.0 / lumped
        duration = 4.0 * math.pi / math.sqrt(system.wrist_stiffness * mobility)
    state = np.array([0, 0, 0, hand_velocity, hand_velocity, target_velocity, 1.0], dtype=float)
    return _Walker(system, adhesive, stop, duration).walk(state)


class _Walker:
    """Walks from event to event; keeps one grid of matrix powers per mode."""

    def __init__(self, system: ThreeMasses, adhesive: bool, stop: str, duration: float) -> None:
        self.system, self.adhesive, self.stop, self.duration = system, adhesive, stop, duration
        self._grids: dict[tuple[bool, int, bool], tuple[Array, float, Array]] = {}

    def walk(self, state: Array) -> Motion:
        friction = self.system.guide_friction > 0
        time, touching = 0.0, True
        guide, stuck = self._guide(state, touching) if friction else (0, False)
        events = [Event(0.0, "touch")]
        segments: list[Segment] = []
        while time < self.duration:
            if len(segments) >= _MAX_SEGMENTS:
                raise ArithmeticError(f"more than {_MAX_SEGMENTS} events before t = {time!r} s")
            matrix, elapsed, after, kind = self._advance(touching, guide, stuck, state, self.duration - time)
            segments.append(Segment(time, time + elapsed, touching, guide, stuck, state, matrix))
            time, state = time + elapsed, after
            if kind is None:
                break
            events.append(Event(time, kind))
            if kind == self.stop:
                break
            if kind in {"touch", "release"}:
                touching = kind == "touch"
            if friction:
                if kind == "halt":
                    state = state.copy()
                    state[4] = state[3]
                if kind == "slip":
                    guide, stuck = (1 if self._needed(state, touching) > 0 else -1), False
                elif kind == "halt" or stuck:
                    guide, stuck = self._guide(state, touching)
                if kind == "halt":
                    events[-1] = Event(time, "stick" if stuck else "reverse")
        return Motion(self.system, tuple(segments), tuple(events))

    def _needed(self, state: Array, touching: bool) -> float:
        """The friction that would hold the wrist, N."""
        return float(self.system.holding_friction(touching) @ state[:6])

    def _guide(self, state: Array, touching: bool) -> tuple[int, bool]:
        """Direction of sliding and whether it sticks, for a wrist at rest in its guide."""
        needed = self._needed(state, touching)
        if abs(needed) <= self.system.guide_friction * (1 - 1e-12):
            return 0, True
        return (1 if needed > 0 else -1), False

    def _event_rows(self, touching: bool, guide: int, stuck: bool) -> list[tuple[str, Array]]:
        """Functions that are positive inside the mode; each row acts on the state of 7."""
        s, rows = self.system, []
        contact = np.append(s.contact_force, 0.0)
        if touching and not self.adhesive:
            rows.append(("release", contact))
        if self.stop == "returned":
            rows.append(("returned", np.array([-1.0, 1, 0, 0, 0, 0, 0])))
        if guide:
            rows.append(("halt", guide * np.array([0, 0, 0, -1.0, 1, 0, 0])))
        if stuck:
            needed = np.append(s.holding_friction(touching), 0.0)
            limit = np.zeros(7)
            limit[6] = s.guide_friction
            rows += [("slip", limit - needed), ("slip", limit + needed)]
        return rows

    def _grid(self, touching: bool, guide: int, stuck: bool) -> tuple[Array, float, Array]:
        key = (touching, guide, stuck)
        if key not in self._grids:
            s = self.system
            a = np.zeros((7, 7))
            a[:6, :6] = s.state_matrix(touching, stuck)
            a[3, 6], a[4, 6] = (guide * s.guide_friction * w for w in (s.hand_mobility, -1.0 / s.wrist_mass))
            fastest = max(float(np.abs(np.linalg.eigvals(a)).max()), 1e-3 / self.duration)
            step = min(2 * math.pi / fastest / 32, self.duration / 16)
            phi = expm(a * step)
            powers = np.empty((_BLOCK + 1, 7, 7))
            powers[0] = np.eye(7)
            for i in range(_BLOCK):
                powers[i + 1] = powers[i] @ phi
            self._grids[key] = (a, step, powers)
        return self._grids[key]

    def _advance(
        self, touching: bool, guide: int, stuck: bool, state: Array, limit: float
    ) -> tuple[Array, float, Array, str | None]:
        """To the next event or to `limit`: matrix, elapsed time, state there, kind of event."""
        a, step, powers = self._grid(touching, guide, stuck)
        rows = self._event_rows(touching, guide, stuck)
        at, offset = state, 0.0
        while True:
            z = powers @ at
            found = [(t, kind) for kind, row in rows if (t := _first_exit(a, z, row, step)) is not None]
            if not touching and (t := self._touch(a, z, step)) is not None:
                found.append((t, "touch"))
            elapsed, kind = min(found, default=(_BLOCK * step, None))
            if offset + elapsed >= limit:
                return a, limit, expm(a * (limit - offset)) @ at, None
            if kind is not None:
                return a, offset + elapsed, expm(a * elapsed) @ at, kind
            at, offset = z[-1], offset + elapsed

    def _touch(self, a: Array, z: Array, step: float) -> float | None:
        """First time at which d and k_c d + c_c d' turn both positive."""
        gap = np.array([0.0, -1, 1, 0, 0, 0, 0])
        if self.system.contact_damping == 0:
            return min(_exits(a, z, -gap, step), default=None)
        force = np.append(self.system.contact_force, 0.0)
        times = [
            t
            for row, other in ((gap, force), (force, gap))
            for t in _exits(a, z, -row, step)
            if _at(a, z, other, step, t) > 0
        ]
        return min(times, default=None)


def _at(a: Array, z: Array, row: Array, step: float, time: float) -> float:
    """The function `row` at `time`, from the grid point before it."""
    i = min(int(time / step), len(z) - 1)
    return float(row @ (expm(a * (time - i * step)) @ z[i]))


def _first_exit(a: Array, z: Array, row: Array, step: float) -> float | None:
    """First time at which a function that is positive inside its mode turns negative, or None."""
    if row @ z[0] <= 0 and row @ (a @ z[0]) <= 0 and row @ z[1] < 0:
        return 0.0
    return min(_exits(a, z, row, step), default=None)


def _exits(a: Array, z: Array, row: Array, step: float) -> list[float]:
    """All times at which the function `row` of the state falls through zero within a block.

    Between two grid points the function has at most one extremum (32 points to the fastest period); where one
    could hide a pair of crossings, its place is found from the derivative and the function is evaluated
    there.
    """
    g, slope = z @ row, z @ (row @ a)
    before, after = g[:-1], g[1:]
    plain = (before > 0) & (after <= 0)
    dip = (before > 0) & (after > 0) & (slope[:-1] < 0) & (slope[1:] > 0)
    hump = (before <= 0) & (after <= 0) & (slope[:-1] > 0) & (slope[1:] < 0)
    times = []
    for i in np.flatnonzero(plain | dip | hump):
        origin = z[i]

        def value(t: float, r: Array = row, origin: Array = origin) -> float:
            return float(r @ (expm(a * t) @ origin))

        def rate(t: float, r: Array = row @ a, origin: Array = origin) -> float:
            return float(r @ (expm(a * t) @ origin))

        low, high = 0.0, step
        if not plain[i]:
            extremum = bracketed_root(rate, 0.0, step)
            if dip[i]:
                high = extremum
            else:
                low = extremum
            if value(low) <= 0 or value(high) >= 0:
                continue
        times.append(int(i) * step + bracketed_root(value, low, high))
    return times
