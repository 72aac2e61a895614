"""The equations of motion of an assembly in a mode, compiled; Pinocchio is the reference."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import numpy as np

from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.multibody.assembly import Assembly
from spacerobot.simulation.multibody.kernel import ALL, BIASES, CIRCLE, PLAIN_PORTS, STRAIGHT, solve
from spacerobot.simulation.multibody.layout import packed, scratch_from
from spacerobot.simulation.multibody.machine import NEEDS, called, machine_of
from spacerobot.simulation.multibody.ports import for_bodies, layout_of, mates
from spacerobot.simulation.reduced.arrays import BIAS, FORCE, FRICTION, W_ROWS, D, System, V, pack
from spacerobot.simulation.reduced.assemble import assemble
from spacerobot.simulation.reduced.law_table import LAWS


class Dynamics:
    """Right-hand side and guards. Holds work arrays, so one at a time.

    The ambient state is (configuration, velocity, work of every force, friction, law with a memory and input, what such
    laws keep); quaternions and cosine-sine pairs are brought back to length 1 before they are used.

    Attributes:
        modes: shape (1 + F + R + S,), contact, sign of every edge, friction, way of every law with a memory.
        features, coordinates: names of what ports are combined from, and the mechanism's coordinates in them,
            shape (n, nf).
        layout, scratch: constant and work arrays of the kernel, as views.
        nq, nv, size: of configuration, velocity and ambient state.
        settings: shape (4,), see `machine`.
        machine: all arrays, as the compiled integrator takes them.
    """

    def __init__(self, assembly: Assembly, mechanism: Mechanism, drives: np.ndarray | None = None) -> None:
        self.assembly = assembly
        self.mechanism = for_bodies(mechanism)
        self.model = assembly.model
        self.layout, self.features, self.coordinates = layout_of(assembly, self.mechanism)
        system, self.names = assemble(self.mechanism)
        self.nq, self.nv = self.model.nq, self.model.nv
        self.forces, self.frictions = len(self.names.forces), len(self.names.frictions)
        self.states = len(self.names.states)
        worked = self.forces + self.frictions + self.states + len(self.names.inputs)
        self.size = self.nq + self.nv + worked + self.states
        self.packed = pack(self._widened(system))
        self.w = self.packed.work()
        self.modes = np.zeros(1 + self.forces + self.frictions + self.states, dtype=np.int64)
        self.q, self.v = np.zeros(self.nq), np.zeros(self.nv)
        ints, floats, work = packed(self.layout, assembly.tree, self.frictions)
        self.scratch = scratch_from(ints, work)
        self.settings = np.array([BIASES if self._needs_bias() else PLAIN_PORTS, 0.0, 0.0, 0.0])
        self.machine, self._table = machine_of(
            x=self.packed.floats,
            c=self.packed.ints,
            laws=LAWS.laws,
            modes=self.modes,
            drives=np.zeros((1 + len(self.names.inputs), 1)) if drives is None else drives,
            w=self.w,
            ints=ints,
            floats=floats,
            work=work,
            q=self.q,
            v=self.v,
            settings=self.settings,
        )

    def _widened(self, system: System) -> System:
        """The reduced model's arrays over this model's velocities: rows and masses come from Pinocchio."""
        ports, nv = system.rows.shape[0], self.nv
        special = system.special.copy()
        special[2] = -1
        return system._replace(
            inverse_mass=np.ones(nv),
            rows=np.zeros((ports, nv)),
            special=special,
            friction_mate=mates(self.mechanism),
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
    def whole(self) -> Iterator[None]:
        """Every port and feature is found, with its bias acceleration; a run does without most of them."""
        before = self.settings[NEEDS]
        self.settings[NEEDS] = ALL
        try:
            yield
        finally:
            self.settings[NEEDS] = before

    def rate(self, t: float, y: np.ndarray, out: np.ndarray) -> None:
        """out = dy/dt, and all forces into the work array."""
        called(self.machine.rate, self.machine.here, t, y, out, out)

    def guard(self, t: float, y: np.ndarray, out: np.ndarray, slope: np.ndarray) -> float:
        """Guards of all modes into `out`; returns the rate of the penetration. `slope` may be overwritten."""
        return float(called(self.machine.guards, self.machine.here, t, y, out, slope))

    def friction_force(self, r: int) -> float:
        """Force of friction `r` along its port at the state last evaluated [N]."""
        return float(self.w[self.packed.ints[FRICTION] + r])

    def force_place(self, i: int) -> int:
        """Where force `i` (the contact is 0) stands in the work array."""
        return int(self.packed.ints[FORCE] + i)

    def _at(self, block: int, port: str) -> int:
        return int(self.packed.ints[block]) + self.names.ports.index(port)

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
