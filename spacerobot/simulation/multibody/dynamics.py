"""The equations of motion of an assembly in a mode, compiled; Pinocchio is the reference."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator

import numpy as np

from spacerobot.dynamics.tree_arrays import tree_arrays
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.multibody.assembly import Assembly
from spacerobot.simulation.multibody.kernel import CIRCLE, STRAIGHT, exert, locate, rate_of, solve
from spacerobot.simulation.multibody.layout import bodies_from, packed, scratch_from
from spacerobot.simulation.multibody.ports import RISE, SLIDE, for_bodies, layout_of, mates
from spacerobot.simulation.reduced.arrays import BIAS, FORCE, FRICTION, HEADING, RAW, W_ROWS, D, System, V, pack
from spacerobot.simulation.reduced.assemble import assemble
from spacerobot.simulation.reduced.events import fix_edges
from spacerobot.simulation.reduced.forces import AT_REST, PRESSED, STICK, TINY, level
from spacerobot.simulation.reduced.guards import guards
from spacerobot.simulation.reduced.law_table import LAWS


class Dynamics:
    """Right-hand side and guards. Holds work arrays, so one at a time.

    The ambient state is (configuration, velocity, work of every force and friction); quaternions and
    cosine-sine pairs are brought back to length 1 before they are used.

    Attributes:
        modes: shape (1 + F + R,), contact, sign of every edge, friction; see the reduced model.
        features, coordinates: names of what ports are combined from, and the mechanism's coordinates in them,
            shape (n, nf).
        layout, scratch: constant and work arrays of the kernel, as views.
        nq, nv, size: of configuration, velocity and ambient state.
        slack: force [N] below which what holds a friction is rounding.
        still: speed [m/s] below which sliding in two directions has stopped.
        mates: of the frictions, shape (R,), see `ports.mates`.
        heading: direction in which each disc of friction slides, shape (R,); a view into the work array.
        inertia: shape (nv, nv), at the state last evaluated by `rate`; a view.
    """

    def __init__(self, assembly: Assembly, mechanism: Mechanism) -> None:
        self.assembly = assembly
        self.mechanism = for_bodies(mechanism)
        self.model, self.data = assembly.model, assembly.model.createData()
        self.layout, self.features, self.coordinates = layout_of(assembly, self.mechanism)
        system, self.names = assemble(self.mechanism)
        self.nq, self.nv = self.model.nq, self.model.nv
        self.forces, self.frictions = len(self.names.forces), len(self.names.frictions)
        self.size = self.nq + self.nv + self.forces + self.frictions
        self.mates = mates(self.mechanism)
        self.packed = pack(self._widened(system))
        self.w = self.packed.work()
        heading = int(self.packed.ints[HEADING])
        self.heading = self.w[heading : heading + self.frictions]
        self.modes = np.zeros(1 + self.forces + self.frictions, dtype=np.int64)
        self.q, self.v = np.zeros(self.nq), np.zeros(self.nv)
        self._drives = np.zeros((1, 1))
        self._arrays = packed(self.layout, tree_arrays(self.model), self.frictions)
        self.scratch = scratch_from(self._arrays[0], self._arrays[2])
        self.biased = self._needs_bias()
        self.pressed_by_contact = [f.normal is not None for f in self.mechanism.frictions]
        self.slack, self.still = 0.0, AT_REST
        self._press_rate = self._at(V, "contact")
        self.inertia = bodies_from(self._arrays[0], self._arrays[2]).inertia

    def _widened(self, system: System) -> System:
        """The reduced model's arrays over this model's velocities: rows and masses come from Pinocchio."""
        ports, nv = system.rows.shape[0], self.nv
        special = system.special.copy()
        special[2] = -1
        return system._replace(
            inverse_mass=np.ones(nv),
            rows=np.zeros((ports, nv)),
            special=special,
            friction_mate=self.mates,
            constant=np.zeros(nv),
            impulse_time=np.zeros(0),
            impulse=np.zeros((0, nv)),
        )

    def _needs_bias(self) -> bool:
        """Whether a friction may stick at a port whose row turns as the bodies move."""
        constant = {i for i, kind in enumerate(self.layout.feature[:, 0]) if kind in (STRAIGHT, CIRCLE)}
        ports = list(self.mechanism.ports)
        for friction in self.mechanism.frictions:
            if friction.port not in ports:
                return True
            if any(f not in constant for f in np.flatnonzero(self.layout.ports[ports.index(friction.port)])):
                return True
        return False

    @contextlib.contextmanager
    def with_bias(self) -> Iterator[None]:
        """Bias accelerations are found too, which ports at rest do without."""
        before = self.biased
        self.biased = True
        try:
            yield
        finally:
            self.biased = before

    def _locate(self, y: np.ndarray) -> None:
        locate(self.packed.ints, self.w, *self._arrays, y, self.q, self.v, self.biased)

    def rate(self, t: float, y: np.ndarray, out: np.ndarray) -> None:
        """out = dy/dt, and all forces into the work array."""
        floats, ints = self.packed
        rate_of(
            floats,
            ints,
            LAWS.laws,
            t,
            self.modes,
            self._drives,
            self.w,
            *self._arrays,
            y,
            self.q,
            self.v,
            self.biased,
            out,
        )

    def guard(self, t: float, y: np.ndarray, out: np.ndarray, slope: np.ndarray) -> float:
        """Guards of all modes into `out`; returns the rate of the penetration. `slope` may be overwritten."""
        if STICK in self.modes[1 + self.forces :]:
            self.rate(t, y, slope)
        else:
            self._locate(y)
            floats, ints = self.packed
            exert(floats, ints, LAWS.laws, t, self.modes, self._drives, self.w, self.nv)
        floats, ints = self.packed
        guards(floats, ints, LAWS.laws, self.modes, self.w, out)
        base = 1 + self.forces
        for r in range(self.frictions):
            if self.pressed_by_contact[r] and self.modes[0] != PRESSED:
                out[base + r] = 1.0  # nothing presses: the friction is idle, whatever its rate does
            elif self.modes[base + r] == STICK:
                out[base + r] += self.slack
        return float(self.w[self._press_rate])

    def contact_force(self, t: float, y: np.ndarray) -> float:
        """Contact force, positive in compression, at state y in the present modes [N]."""
        self._locate(y)
        floats, ints = self.packed
        exert(floats, ints, LAWS.laws, t, self.modes, self._drives, self.w, self.nv)
        return -float(self.w[ints[FORCE]])

    def friction_excess(self, r: int) -> float:
        """How far the force that holds friction `r` exceeds its limit [N], at the state last evaluated."""
        floats, ints = self.packed
        force = self.w[ints[FRICTION] + r]
        if self.mates[r] >= 0:
            force = math.hypot(force, self.w[ints[FRICTION] + self.mates[r]])
        normal = max(0.0, -self.w[ints[FORCE]]) if self.pressed_by_contact[r] else 0.0
        limit = level(floats, ints, LAWS.laws, r, -TINY if force > 0.0 else TINY, normal)
        return float(abs(force) - limit * (1.0 + 1e-12) - self.slack)

    def sliding(self, r: int) -> np.ndarray:
        """Rates along friction `r` and its mate at the state last evaluated, shape (2,)."""
        ports = (self.mechanism.frictions[int(i)].port for i in (r, self.mates[r]))
        return np.array([self.port_rate(port) for port in ports])

    def turn(self) -> None:
        """Turns the headings of what slides in two directions to where it slides at the state last evaluated."""
        for r in np.flatnonzero(self.mates >= 0):
            if self.modes[1 + self.forces + r] != STICK:
                rates = self.sliding(int(r))
                speed = math.hypot(*rates)
                if speed > AT_REST:
                    self.heading[[r, self.mates[r]]] = rates / speed

    def friction_force(self, r: int) -> float:
        """Force of friction `r` along its port at the state last evaluated [N]."""
        return float(self.w[self.packed.ints[FRICTION] + r])

    def force_place(self, i: int) -> int:
        """Where force `i` (the contact is 0) stands in the work array."""
        return int(self.packed.ints[FORCE] + i)

    def contact_push(self) -> float:
        """What the contact's law asks for beyond its holding force [N], at the state last evaluated."""
        hold = self.mechanism.contact.hold if self.mechanism.contact is not None else 0.0
        return float(hold - self.w[self.packed.ints[RAW]])

    def settle_edges(self) -> None:
        """Sets the sign of every edge to that of the state last evaluated."""
        fix_edges(*self.packed, LAWS.laws, self.modes, self.w)

    def _at(self, block: int, port: str) -> int:
        return int(self.packed.ints[block]) + self.names.ports.index(port)

    def contact_places(self) -> np.ndarray:
        """Where penetration, sliding sideways and upwards, each with its rate, stand in the work array, shape (6,)."""
        return np.array([self._at(block, port) for port in ("contact", SLIDE, RISE) for block in (D, V)])

    def port_position(self, port: str) -> float:
        """Displacement of a port at the state last evaluated."""
        return float(self.w[self._at(D, port)])

    def port_rate(self, port: str) -> float:
        """Rate of a port at the state last evaluated."""
        return float(self.w[self._at(V, port)])

    def port_bias(self, port: str) -> float:
        """Acceleration of a port at zero joint acceleration, at the state last evaluated."""
        return float(self.w[self._at(BIAS, port)])

    def give(self, port: str) -> float:
        """Acceleration of a port per force at it, at the state last evaluated [1/kg or 1/(kg m^2)]."""
        row = self.port_row(port)
        moved = row.copy()
        solve(self.scratch.factor, self.assembly.split, moved)
        return float(row @ moved)

    def port_row(self, port: str) -> np.ndarray:
        """Rate of a port per unit velocity at the state last evaluated, shape (nv,); a view."""
        first = int(self.packed.ints[W_ROWS]) + self.names.ports.index(port) * self.nv
        return self.w[first : first + self.nv]
