"""The integration loop: adaptive steps of order 8, events, kicks, and the record of every step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.simulation.events import Event
from spacerobot.simulation.multibody.dop853 import ALL_STAGES, ORDER, POWERS, STAGES, C
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.multibody.events import Modes, Probe
from spacerobot.simulation.multibody.kernel import load, solve
from spacerobot.simulation.multibody.stepper import error_norm, interpolant, stage
from spacerobot.simulation.reduced.forces import APART, PRESSED, RELEASED, STICK
from spacerobot.simulation.reduced.integrate import NEAR
from spacerobot.simulation.unfinished import remedy, too_many
from spacerobot.support.errors import SimulationError

MAX_STEPS, MAX_EVENTS = 150_000, 5_000
"""The record of so many steps takes most of 1 GB."""
_CONTACT = {APART: "apart", PRESSED: "touch", RELEASED: "release"}
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 6.0


@dataclass(frozen=True, eq=False)
class Steps:
    """Every accepted step. m steps, N ambient states, G modes.

    Attributes:
        time, length: shape (m,) [s].
        state: shape (m, N), at the start of the step.
        dense: shape (m, POWERS, N), of the interpolant.
        modes: shape (m, G).
        heading: shape (m, R), direction in which discs of friction slid at the start of the step.
        last: shape (N,), at the end.
    """

    time: np.ndarray
    length: np.ndarray
    state: np.ndarray
    dense: np.ndarray
    modes: np.ndarray
    heading: np.ndarray
    last: np.ndarray


@dataclass(frozen=True)
class Kick:
    """A known impulse that happened: when, by whom, and the energy it brought [J]."""

    time: float
    name: str
    work: float


class Integrator:
    """Carries a Dynamics from start to end.

    Args:
        dynamics: equations of motion.
        scale: shape (N,), error per step that is tolerated in each ambient state.
        first_step, max_step: [s].
        fixed: take every step at `max_step`, whatever its error; for measuring the order.
    """

    def __init__(
        self, dynamics: Dynamics, scale: np.ndarray, first_step: float, max_step: float, *, fixed: bool = False
    ) -> None:
        self.dynamics, self.scale = dynamics, scale
        self._first, self._longest, self._fixed = first_step, max_step, fixed
        self._k = np.zeros((ALL_STAGES, dynamics.size))
        self._new, self._temp = np.empty(dynamics.size), np.empty(dynamics.size)
        self._guard = np.empty(dynamics.modes.size)
        self._slope = np.empty(dynamics.size)
        self._modes, self._probe = Modes(dynamics), Probe(dynamics)
        self.events: list[Event] = []
        self.kicks: list[Kick] = []

    def run(self, y: np.ndarray, start: float, end: float) -> Steps:
        """Integrate from `start` to `end` [s]; `y` is the state at the start.

        Raises:
            SimulationError: no end in sight: too many steps or events, or a state that is not finite.
        """
        dyn, t, y = self.dynamics, start, y.copy()
        record: list[tuple[float, float, np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []
        pending = sorted((i for i in dyn.mechanism.impulses if i.time >= start), key=lambda i: i.time)
        self._modes.start(t, y)
        dyn.rate(t, y, self._k[0])
        h = min(self._first, self._longest)
        while t < end:
            stop = min(end, pending[0].time) if pending else end
            if pending and pending[0].time - t <= 1e-15 * max(1.0, abs(t)):
                self._kick(t, y, pending.pop(0))
                continue
            full = min(h, self._longest)
            final = full >= (stop - t) * (1.0 - 1e-12)
            full = stop - t if final else full
            self._advance(t, y, full)
            norm = 0.0 if self._fixed else error_norm(self._k, full, self.scale)
            if not math.isfinite(norm) or norm > 1.0:
                factor = max(_SHRINK, _SAFETY * norm ** (-1.0 / ORDER)) if math.isfinite(norm) else 0.1
                h = full * factor
                if h < 1e-15 * max(1.0, abs(t)):
                    advice = remedy(dyn.mechanism, dyn.give)
                    raise SimulationError(f"multibody model: the step vanished at t = {t:.6g} s: {advice}")
                continue
            grow = _GROW if norm < 1e-12 else min(_GROW, _SAFETY * norm ** (-1.0 / ORDER))
            dense = self._dense(t, y, full)
            hit, theta = self._probe.first(t, y, full, dense)
            part = full
            if hit >= 0:
                part = self._polish(hit, t, y, full, theta * full)
                dense = self._dense(t, y, part)
            record.append((t, part, y.copy(), dense, dyn.modes.copy(), dyn.heading.copy()))
            y[:] = self._new
            load(y, dyn.layout.joints, dyn.q, dyn.v)
            y[: dyn.nq] = dyn.q  # back onto the manifold
            t = stop if final and hit < 0 else t + part
            if hit >= 0:
                self._modes.switch(hit, t, y)
                self.events.append(self._event(t, hit))
            else:
                h = max(h, full * grow) if final else full * grow
            dyn.rate(t, y, self._k[0])
            dyn.turn()
            if len(record) > MAX_STEPS or len(self.events) > MAX_EVENTS:
                what = "steps" if len(record) > MAX_STEPS else "events"
                raise too_many("multibody", what, t, end, remedy(dyn.mechanism, dyn.give))
        time, length, state, dense_, modes, heading = (np.array(column) for column in zip(*record, strict=True))
        return Steps(time, length, state, dense_, modes, heading, y)

    def _advance(self, t: float, y: np.ndarray, h: float) -> None:
        """Stages 1 to 12 from stage 0; the new state is left in `_new`."""
        dyn, k = self.dynamics, self._k
        for s in range(1, STAGES):
            stage(y, k, s, h, self._temp)
            dyn.rate(t + C[s] * h, self._temp, k[s])
        stage(y, k, STAGES, h, self._new)
        dyn.rate(t + h, self._new, k[STAGES])

    def _dense(self, t: float, y: np.ndarray, h: float) -> np.ndarray:
        """The interpolant of the step just taken, shape (POWERS, N)."""
        for s in range(STAGES + 1, ALL_STAGES):
            stage(y, self._k, s, h, self._temp)
            self.dynamics.rate(t + C[s] * h, self._temp, self._k[s])
        dense = np.empty((POWERS, y.size))
        interpolant(y, self._new, self._k, h, dense)
        return dense

    def _polish(self, hit: int, t: float, y: np.ndarray, full: float, part: float) -> float:
        """Length at which guard `hit` is zero, by Newton on the step itself (the interpolant is less accurate)."""
        dyn = self.dynamics
        for _ in range(4):
            self._advance(t, y, part)
            dyn.guard(t + part, self._new, self._guard, self._slope)
            value = self._guard[hit]
            probe = max(1e-7 * full, 1e-12)
            np.multiply(self._k[STAGES], probe, out=self._temp)
            self._temp += self._new
            dyn.guard(t + part + probe, self._temp, self._guard, self._slope)
            rate = (self._guard[hit] - value) / probe
            if rate >= 0.0:
                break
            change = -value / rate
            if part + change <= 0.0 or part + change > full:
                break
            part += change
            if abs(change) < max(NEAR * full, 1e-15 * max(1.0, abs(t))):
                break
        self._advance(t, y, part)
        return part

    def _kick(self, t: float, y: np.ndarray, impulse: object) -> None:
        dyn = self.dynamics
        dyn.rate(t, y, self._slope)
        row = dyn.port_row(impulse.port).copy()  # type: ignore[attr-defined]
        jump = impulse.impulse * row  # type: ignore[attr-defined]
        solve(dyn.scratch.factor, dyn.assembly.split, jump)
        speed = float(row @ y[dyn.nq : dyn.nq + dyn.nv])
        work = impulse.impulse * (speed + 0.5 * float(row @ jump))  # type: ignore[attr-defined]
        y[dyn.nq : dyn.nq + dyn.nv] += jump
        self.kicks.append(Kick(t, impulse.name, work))  # type: ignore[attr-defined]
        contact = int(dyn.modes[0])
        self._modes.start(t, y)
        dyn.modes[0] = contact
        dyn.rate(t, y, self._k[0])

    def _event(self, t: float, index: int) -> Event:
        dyn, t = self.dynamics, float(t)
        mode = int(dyn.modes[index])
        if index == 0:
            return Event(t, "contact", _CONTACT[mode])
        if index <= dyn.forces:
            return Event(t, dyn.names.forces[index - 1], "edge")
        name = dyn.names.frictions[index - 1 - dyn.forces]
        return Event(t, name, "stick" if mode == STICK else "slip")
