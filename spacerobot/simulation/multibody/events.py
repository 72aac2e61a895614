"""Events inside a step: guards bracketed so that none is missed, located, and what mode follows."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.multibody.kernel import solve
from spacerobot.simulation.multibody.sliding import start_heading
from spacerobot.simulation.multibody.stepper import interpolate
from spacerobot.simulation.reduced.arrays import FOLLOWS
from spacerobot.simulation.reduced.forces import APART, AT_REST, PRESSED, RELEASED, STICK

SAMPLES = 8
"""Parts of a step at whose ends the guards are looked at; between them, at every extremum of the gap."""


class Probe:
    """Guards anywhere inside one step."""

    def __init__(self, dynamics: Dynamics) -> None:
        self.dynamics = dynamics
        count = dynamics.modes.size
        self.samples, self.rates = np.empty((SAMPLES + 1, count)), np.empty(SAMPLES + 1)
        self._guard, self._y, self._slope = np.empty(count), np.empty(dynamics.size), np.empty(dynamics.size)

    def at(self, theta: float) -> tuple[np.ndarray, float]:
        """All guards (a work array) and the rate of the penetration at a fraction of the step."""
        interpolate(self._start, self._dense, theta, self._y)
        rate = self.dynamics.guard(self._t + theta * self._h, self._y, self._guard, self._slope)
        return self._guard, rate

    def first(self, t: float, y: np.ndarray, h: float, dense: np.ndarray) -> tuple[int, float]:
        """The first guard that falls below zero in the step: (index, fraction), or (-1, 1.0)."""
        self._t, self._start, self._h, self._dense = t, y, h, dense
        for j in range(SAMPLES + 1):
            guard, self.rates[j] = self.at(j / SAMPLES)
            self.samples[j] = guard
        best, where = -1, 2.0
        watched = np.flatnonzero((self.samples[1:] < 0.0).any(axis=0) | self._may_dip())
        for i in watched:
            bracket = self._bracket(int(i))
            if bracket is not None and bracket[0] < where:
                theta = self._root(int(i), *bracket)
                if theta < where:
                    best, where = int(i), theta
        return best, where

    def _may_dip(self) -> np.ndarray:
        """Guards that may fall below zero and come back between samples."""
        g = self.samples
        low = (g[1:-1] <= g[:-2]) & (g[1:-1] <= g[2:])
        dips = np.any(low, axis=0)
        if self.dynamics.modes[0] != PRESSED:
            dips[0] = bool(np.any((self.rates[:-1] > 0.0) & (self.rates[1:] < 0.0)))
        return np.asarray(dips)

    def _bracket(self, i: int) -> tuple[float, float] | None:
        """Fractions between which guard i falls through zero for the first time."""
        g = self.samples[:, i]
        for j in range(1, SAMPLES + 1):
            low = (j - 1) / SAMPLES
            if g[j] < 0.0:
                return self._inside(i, low, j / SAMPLES)
            dip = self._dip(i, j)
            if dip is not None and self.at(dip)[0][i] < 0.0:
                return self._inside(i, low if dip > low else low - 1.0 / SAMPLES, dip)
        return None

    def _dip(self, i: int, j: int) -> float | None:
        """Where guard i may be lowest around sample j, None if it cannot be."""
        g = self.samples[:, i]
        if i == 0 and self.dynamics.modes[0] != PRESSED:
            if self.rates[j - 1] > 0.0 and self.rates[j] < 0.0:
                return self._extremum((j - 1) / SAMPLES, j / SAMPLES)
            return None
        if not (0 < j < SAMPLES and g[j] <= g[j - 1] and g[j] <= g[j + 1]):
            return None
        curve = g[j - 1] - 2.0 * g[j] + g[j + 1]
        return (j + 0.5 * (g[j - 1] - g[j + 1]) / curve) / SAMPLES if curve > 0.0 else None

    def _extremum(self, low: float, high: float) -> float:
        """Where the rate of the penetration turns negative: the deepest point."""
        for _ in range(40):
            middle = 0.5 * (low + high)
            if self.at(middle)[1] > 0.0:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def _inside(self, i: int, low: float, high: float) -> tuple[float, float]:
        """The bracket with its start moved off a zero at which the mode itself began."""
        if self.at(low)[0][i] > 0.0 or low > 0.0:
            return low, high
        theta = high
        for _ in range(40):
            theta *= 0.5
            if self.at(theta)[0][i] > 0.0:
                return theta, high
        return 0.0, 0.0

    def _root(self, i: int, low: float, high: float) -> float:
        """The zero of guard i in a bracket, by regula falsi (Illinois); the side on which it is negative."""
        if high <= low:
            return high
        at_low, at_high = float(self.at(low)[0][i]), float(self.at(high)[0][i])
        side = 0
        for _ in range(80):
            if high - low < 1e-14:
                break
            middle = (low * at_high - high * at_low) / (at_high - at_low)
            if not low < middle < high:
                middle = 0.5 * (low + high)
            value = float(self.at(middle)[0][i])
            if value < 0.0:
                high, at_high = middle, value
                at_low *= 0.5 if side == -1 else 1.0
                side = -1
            elif value > 0.0:
                low, at_low = middle, value
                at_high *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                return middle
        return high


class Modes:
    """Choice of modes at a state. `y` and `slope` are (ambient state, its rate)."""

    def __init__(self, dynamics: Dynamics) -> None:
        self.dynamics = dynamics
        self._slope = np.empty(dynamics.size)

    def start(self, t: float, y: np.ndarray) -> None:
        """Modes that fit the state y."""
        dyn = self.dynamics
        dyn.modes[:] = 1
        dyn.modes[0] = APART
        dyn.rate(t, y, self._slope)
        gap, speed = dyn.port_position("contact"), dyn.port_rate("contact")
        if gap > AT_REST or (gap > -AT_REST and speed > 0.0):
            dyn.modes[0] = PRESSED
        for r in range(dyn.frictions):
            self._start_friction(r)
        self.settle(t, y)
        dyn.turn()
        bilateral = dyn.mechanism.contact is not None and dyn.mechanism.contact.bilateral
        if dyn.modes[0] == PRESSED and dyn.contact_push() < -1e-9 * dyn.slack and not bilateral:
            dyn.modes[0] = RELEASED
        dyn.settle_edges()

    def _start_friction(self, r: int) -> None:
        dyn = self.dynamics
        mate = int(dyn.mates[r])
        if mate == FOLLOWS:
            return
        if mate >= 0:
            rates = dyn.sliding(r)
            speed = math.hypot(*rates)
            self._set(r, STICK if speed < AT_REST else 1)
            dyn.heading[[r, mate]] = rates / speed if speed > 0.0 else 0.0
            return
        rate = dyn.port_rate(dyn.mechanism.frictions[r].port)
        self._set(r, STICK if abs(rate) < AT_REST else (1 if rate > 0.0 else -1))

    def _set(self, r: int, mode: int) -> None:
        """The mode of a friction, and of its mate."""
        dyn = self.dynamics
        dyn.modes[1 + dyn.forces + r] = mode
        if dyn.mates[r] >= 0:
            dyn.modes[1 + dyn.forces + dyn.mates[r]] = mode

    def _break_away(self, r: int) -> None:
        """Lets a friction that sticks slide, the way that the state last evaluated drives it."""
        dyn = self.dynamics
        self._set(r, -1 if dyn.mates[r] < 0 and dyn.friction_force(r) > 0.0 else 1)

    def settle(self, t: float, y: np.ndarray) -> None:
        """Lets every stuck port whose friction exceeds its limit slide; repeated until consistent."""
        dyn = self.dynamics
        base = 1 + dyn.forces
        for _ in range(dyn.frictions + 1):
            for r in np.flatnonzero(dyn.mates >= 0):
                if dyn.modes[base + r] != STICK and math.hypot(*dyn.sliding(int(r))) <= AT_REST:
                    start_heading(dyn, int(r), t, y, self._slope)
            dyn.rate(t, y, self._slope)
            stuck = [r for r in range(dyn.frictions) if dyn.modes[base + r] == STICK and dyn.mates[r] != FOLLOWS]
            over = [(dyn.friction_excess(r), r) for r in stuck]
            excess, worst = max(over, default=(0.0, -1))
            if excess <= 0.0:
                return
            self._break_away(worst)

    def switch(self, i: int, t: float, y: np.ndarray) -> None:
        """Changes mode i after its guard fell to zero at state y, and what follows from it."""
        dyn = self.dynamics
        dyn.rate(t, y, self._slope)
        if i == 0:
            self._switch_contact()
        elif i <= dyn.forces:
            dyn.modes[i] = -dyn.modes[i]
        else:
            self._switch_friction(i - 1 - dyn.forces, y)
        self.settle(t, y)

    def _switch_contact(self) -> None:
        dyn = self.dynamics
        assert dyn.mechanism.contact is not None
        over = dyn.port_position("contact") > AT_REST
        if dyn.modes[0] == APART:
            dyn.modes[0] = PRESSED
        elif dyn.modes[0] == PRESSED:
            dyn.modes[0] = RELEASED if over and not dyn.mechanism.contact.bilateral else APART
        else:
            dyn.modes[0] = PRESSED if over else APART
        for r in range(dyn.frictions):
            if dyn.pressed_by_contact[r]:
                self._start_friction(r)
                if dyn.modes[0] != PRESSED:
                    self._set(r, 1)

    def _switch_friction(self, r: int, y: np.ndarray) -> None:
        dyn = self.dynamics
        if dyn.modes[1 + dyn.forces + r] == STICK:
            self._break_away(r)
            return
        if dyn.mates[r] >= 0 and math.hypot(*dyn.sliding(r)) > dyn.still:
            dyn.turn()  # it did not stop, but turned by more than a right angle within a step
            return
        self._halt([r, int(dyn.mates[r])] if dyn.mates[r] >= 0 else [r], y)
        self._set(r, STICK)

    def _halt(self, frictions: list[int], y: np.ndarray) -> None:
        """Takes the last rounding of what slid out of the velocities in y; whether it can stick is seen after."""
        dyn = self.dynamics
        rows = np.array([dyn.port_row(dyn.mechanism.frictions[r].port) for r in frictions])
        kicks = rows.copy()
        for kick in kicks:
            solve(dyn.scratch.factor, dyn.assembly.split, kick)
        speeds = y[dyn.nq : dyn.nq + dyn.nv]
        speeds -= np.linalg.lstsq(rows @ kicks.T, rows @ speeds, rcond=1e-12)[0] @ kicks
