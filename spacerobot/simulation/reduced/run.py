"""Front door of the reduced backend: simulate a mechanism, then read states, events and energies."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.events import Event
from spacerobot.simulation.reduced.arrays import REST, Packed, System
from spacerobot.simulation.reduced.assemble import Layout, assemble_packed, head_on, recorded, rested, unturning
from spacerobot.simulation.reduced.forces import APART, PRESSED, RELEASED, STICK
from spacerobot.simulation.reduced.integrate import MAX_STEPS, NOT_FINITE, OK, TOO_MANY_EVENTS, Steps, integrate
from spacerobot.simulation.reduced.law_table import LAWS
from spacerobot.simulation.reduced.sampling import (
    sample,
    sample_accelerations,
    sample_contact,
    sample_states,
    work_done,
)
from spacerobot.simulation.unfinished import remedy, too_many
from spacerobot.support.errors import InputError, SimulationError

_CONTACT_NAMES = {APART: "apart", PRESSED: "touch", RELEASED: "release"}


@dataclass(frozen=True)
class Sample:
    """States and forces at given times. T times, n coordinates, F forces, R frictions, S laws with a memory."""

    time: np.ndarray  # (T,) s
    position: np.ndarray  # (T, n) m or rad
    velocity: np.ndarray  # (T, n)
    acceleration: np.ndarray  # (T, n)
    force: np.ndarray  # (T, F) along the ports
    friction: np.ndarray  # (T, R)
    memory: np.ndarray  # (T, S) the numbers that laws with a memory keep
    remembered: np.ndarray  # (T, S) their forces along the ports


@dataclass(frozen=True, eq=False)
class ReducedRun:
    """A finished integration of the reduced model."""

    mechanism: Mechanism
    system: System
    layout: Layout
    steps: Steps
    switched: tuple[np.ndarray, np.ndarray, np.ndarray]  # events: times, which mode, its new value
    start: float
    end: float
    packed: Packed
    drives: np.ndarray  # (1 + U, T): times, then the recorded inputs

    @functools.cached_property
    def events(self) -> tuple[Event, ...]:
        """Every change of mode, in order."""
        return tuple(_event(self.layout, float(t), int(i), int(m)) for t, i, m in zip(*self.switched, strict=True))

    def touches(self) -> np.ndarray:
        """Times at which the surfaces meet [s]."""
        time, which, mode = self.switched
        return time[(which == 0) & (mode == PRESSED)]

    def switches(self) -> np.ndarray:
        """Times at which a mode changes, ascending, shape (E,) [s]."""
        return self.switched[0]

    def sample(self, times: np.ndarray) -> Sample:
        """States at `times`, shape (T,), ascending; outside the run the ends are held."""
        y, rate, force, friction = sample(
            *self.packed,
            LAWS.laws,
            self.packed.work(),
            *self.steps,
            np.ascontiguousarray(times, dtype=float),
            self.drives,
        )
        n, r = len(self.layout.coordinates), len(self.layout.frictions)
        moving = slice(n, 2 * n)
        memory, remembered = y[:, 2 * n :], friction[:, r:]
        return Sample(times, y[:, :n], y[:, moving], rate[:, moving], force, friction[:, :r], memory, remembered)

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities at `times`, shape (T,), ascending; shape (T, n) each."""
        n = len(self.layout.coordinates)
        y = sample_states(*self.steps[:5], np.ascontiguousarray(times, dtype=float), 2 * n)
        return y[:, :n], y[:, n:]

    def positions(self, times: np.ndarray) -> np.ndarray:
        """Positions alone at `times`, shape (T,), ascending; shape (T, n)."""
        at = np.ascontiguousarray(times, dtype=float)
        return np.asarray(sample_states(*self.steps[:5], at, len(self.layout.coordinates)))

    def accelerations(self, times: np.ndarray) -> np.ndarray:
        """Accelerations alone at `times`, shape (T,), ascending; shape (T, n)."""
        at = np.ascontiguousarray(times, dtype=float)
        work = self.packed.work()
        return np.asarray(sample_accelerations(*self.packed, LAWS.laws, work, *self.steps, at, self.drives))

    def contact_at(self, times: np.ndarray) -> np.ndarray:
        """Contact force, positive in compression, at `times`, shape (T,), ascending [N]."""
        at = np.ascontiguousarray(times, dtype=float)
        return np.asarray(sample_contact(*self.packed, LAWS.laws, self.packed.work(), *self.steps, at))

    @property
    def pieces(self) -> int:
        """A step of the series, the longest there is, spans 3 to 5 rad of the fastest motion: 0.3 rad a piece."""
        return 16

    def contact_modes(self, times: np.ndarray) -> np.ndarray:
        """Mode of the contact at `times`, shape (T,); at an event's own time that after it."""
        index = np.searchsorted(self.steps.time, times, side="right") - 1
        return np.asarray(self.steps.modes[np.clip(index, 0, self.steps.time.size - 1), 0])

    def pressed(self) -> np.ndarray:
        """Whether the contact carries force in each step, shape (m,)."""
        return np.asarray(self.steps.modes[:, 0] == PRESSED)

    def deflection_at(self, times: np.ndarray) -> np.ndarray:
        """Of the wrist, positive pushed in, at `times`, shape (T,), ascending [m]."""
        return self.port("wrist", self.positions(times))

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        """A port's displacement, rate or acceleration from the coordinates', shape (T,); constant rows."""
        return np.asarray(states @ self.system.rows[self.layout.port(name)])

    def ports(self, names: Sequence[str], states: np.ndarray) -> np.ndarray:
        """Several ports' displacements, rates or accelerations from the coordinates', shape (P, T); constant rows."""
        return np.asarray(self.system.rows[[self.layout.port(name) for name in names]] @ states.T)

    def contact_force(self, taken: Sample) -> np.ndarray:
        """Contact force, positive in compression, shape (T,) [N]."""
        return -taken.force[:, int(self.system.special[3])]

    def work(self) -> dict[str, np.ndarray]:
        """Work [J] done up to the end of every step by each element, by name; shape (m + 1,) each.

        Of elements of one name (an effect that stands twice at its place) all together.
        """
        table = work_done(*self.packed, LAWS.laws, self.packed.work(), *self.steps, self.drives)
        names = [*self.layout.forces, *self.layout.frictions, *self.layout.states]
        out: dict[str, np.ndarray] = {}
        for i, name in enumerate(names):
            out[name] = out.get(name, 0.0) + table[:, i]
        n = len(self.layout.coordinates)
        for i, coordinate in enumerate(self.layout.coordinates):
            if self.system.constant[i] != 0.0:
                out[f"field on {coordinate}"] = table[:, len(names) + i]
        if self.layout.inputs:
            out["inputs"] = table[:, len(names) + n]
        return out

    def kinetic(self, states: np.ndarray) -> np.ndarray:
        """Kinetic energy [J] of velocities shape (T, n), shape (T,)."""
        return np.asarray(0.5 * (states**2 / self.system.inverse_mass).sum(axis=1))

    def boundaries(self) -> np.ndarray:
        """Times of all step ends, shape (m + 1,) [s]."""
        return np.append(self.steps.time, self.end)


class Prepared(NamedTuple):
    """A mechanism and its arrays."""

    mechanism: Mechanism
    system: System
    layout: Layout
    packed: Packed


def prepare(mechanism: Mechanism) -> Prepared:
    """A mechanism made ready to run, for callers that run it more than once."""
    return Prepared(mechanism, *assemble_packed(mechanism))


def simulate(
    of: Mechanism | Prepared,
    *,
    position: Mapping[str, float] | None = None,
    velocity: Mapping[str, float] | None = None,
    start: float = 0.0,
    end: float,
    tolerance: float = 1e-8,
    inputs: tuple[np.ndarray, Mapping[str, np.ndarray]] | None = None,
    max_step: float = 0.05,
    step_limit: int = MAX_STEPS,
    scale: float = 1.0,
) -> ReducedRun:
    """Integrate a mechanism from `start` to `end` [s].

    Args:
        of: what there is.
        position, velocity: initial values by coordinate [m, rad, m/s, rad/s]; see `Mechanism.at_start` for the others.
        tolerance: relative error per step; absolute errors are 1e-3 of it in metres, 1e-1 in m/s.
        inputs: times shape (T,) and recorded drives by channel, shape (T,) each, for the mechanism's inputs.
        max_step: longest step [s].
        step_limit: number of steps after which it is given up.
        scale: factor on the absolute errors, for motion much slower than centimetres a second.

    Raises:
        InputError: a time or tolerance that cannot be.
        SimulationError: the integration could not be finished.
    """
    if not (np.isfinite(start) and np.isfinite(end) and end > start):
        raise InputError("a simulation must end after it starts", given=(start, end))
    if not 1e-13 <= tolerance <= 1e-1:
        raise InputError("tolerance out of range", given=tolerance, valid="1e-13 to 0.1")
    mechanism, system, layout, packed = of if isinstance(of, Prepared) else prepare(of)
    y0 = np.array([*mechanism.at_start(position or {}).values(), *mechanism.at_start(velocity or {}).values()])
    n, work = y0.size // 2, packed.work()
    atol = scale * np.concatenate([np.full(n, 1e-3 * tolerance), np.full(n, 1e-1 * tolerance)])
    if mechanism.states:
        y0 = np.append(y0, rested(mechanism, lambda port: float(system.rows[layout.port(port)] @ y0[:n])))
        atol = np.append(atol, [tolerance * s.size for s in mechanism.states])
        work[packed.ints[REST]] = atol[n]
    if head_on(system, y0):
        packed = unturning(packed)
    drives = recorded(mechanism, inputs)
    first = min(1e-4, max_step, end - start)
    *taken, etime, eindex, emode, status = integrate(
        *packed, LAWS.laws, work, y0, start, end, tolerance, atol, first, max_step, drives, step_limit
    )
    steps = Steps.shaped(y0.size, *taken)
    if status != OK:
        reached = float(steps.time[-1]) if steps.time.size else start
        if status == NOT_FINITE:
            raise SimulationError(f"reduced model: the state stopped being finite at t = {reached:.6g} s")
        what = "events" if status == TOO_MANY_EVENTS else "steps"
        raise too_many("reduced", what, reached, end, remedy(mechanism, lambda port: _give(system, layout.port(port))))
    return ReducedRun(mechanism, system, layout, steps, (etime, eindex, emode), start, end, packed, drives)


def _give(system: System, port: int) -> float:
    """Acceleration of a port per force at it [1/kg or 1/(kg m^2)]."""
    return float(system.rows[port] ** 2 @ system.inverse_mass)


def _event(layout: Layout, time: float, index: int, mode: int) -> Event:
    if index == 0:
        return Event(time, "contact", _CONTACT_NAMES[mode])
    if index <= len(layout.forces):
        return Event(time, layout.forces[index - 1], "edge")
    index -= 1 + len(layout.forces)
    if index < len(layout.frictions):
        return Event(time, layout.frictions[index], "stick" if mode == STICK else "slip")
    return Event(time, layout.states[index - len(layout.frictions)], "turn")
