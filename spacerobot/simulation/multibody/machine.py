"""A machine as the compiled integrator takes it: its arrays in one bundle, rate and guards at a state."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np

from spacerobot.simulation.multibody.kernel import PLAIN_PORTS, exert, locate, rate_of
from spacerobot.simulation.reduced.arrays import (
    FORCES,
    FRICTION_MATE,
    FRICTION_NORMAL,
    FRICTION_PORT,
    FRICTIONS,
    INPUTS,
    NONE,
    PRESS,
    STATES,
    W_ROWS,
    V,
)
from spacerobot.simulation.reduced.forces import PRESSED, STICK
from spacerobot.simulation.reduced.guards import guards
from spacerobot.support.jit import by_address, jit, lean, numba, part

NEEDS, SLACK, RATES, GUARDS = range(4)
"""Where `settings` keeps: what an evaluation needs, see `kernel`; force [N] below which what holds a friction is
rounding; how often rate and guards were evaluated."""


class Machine(NamedTuple):
    """All arrays of one machine. They are its own: one run at a time."""

    x: np.ndarray  # numbers of the mechanism
    c: np.ndarray  # its counts, indices and offsets
    laws: np.ndarray  # addresses of laws
    modes: np.ndarray  # (1 + F + R + S,) int
    drives: np.ndarray  # (1 + U, T): times, then the recorded inputs
    w: np.ndarray  # work of the ports and forces
    ints: np.ndarray  # layout and tree of bodies
    floats: np.ndarray
    work: np.ndarray
    q: np.ndarray
    v: np.ndarray
    settings: np.ndarray  # (5,)
    here: int  # address of a table of all these arrays
    rate: int  # addresses of `_rate` and `_guards`
    guards: int


_outlined, _pointer, _call = by_address()
_carray = numba().carray


def machine_of(**arrays: Any) -> tuple[Machine, np.ndarray]:
    """The bundle of these arrays, and the table that must live as long."""
    table = [entry for a in arrays.values() for entry in (a.ctypes.data, a.size)]
    held = np.array(table, dtype=np.int64)
    rate, guard = entries()
    return Machine(**arrays, here=held.ctypes.data, rate=rate.address, guards=guard.address), held


@functools.cache
def entries() -> tuple[Any, Any]:
    """Rate and guards as C functions, compiled when a machine is first made."""
    return _outlined(_rate), _outlined(_guards)


@part
def _ints(table: Any, i: int) -> Any:
    return _carray(_pointer(table[2 * i]), (table[2 * i + 1],), np.int64)


@part
def _floats(table: Any, i: int) -> Any:
    return _carray(_pointer(table[2 * i]), (table[2 * i + 1],), np.float64)


@part
def machine_at(here: int) -> Machine:
    """The machine whose table lies there."""
    t = _carray(_pointer(here), (24,), np.int64)
    c = _ints(t, 1)
    drives = _floats(t, 4).reshape((1 + c[INPUTS], t[9] // (1 + c[INPUTS])))
    return Machine(
        _floats(t, 0), c, _ints(t, 2), _ints(t, 3), drives, _floats(t, 5), _ints(t, 6), _floats(t, 7),
        _floats(t, 8), _floats(t, 9), _floats(t, 10), _floats(t, 11), here, 0, 0,
    )  # fmt: skip


@lean
def _exert(m: Any, t: float, y: Any) -> None:
    locate(m.c, m.w, m.ints, m.floats, m.work, y, m.q, m.v, PLAIN_PORTS)
    exert(m.x, m.c, m.laws, t, m.modes, m.drives, m.w, m.v.size)


@lean
def size_of(m: Any) -> int:
    """Of the ambient state: configuration, velocity, work of every force, friction, state and input, states."""
    return int(m.q.size + m.v.size + m.c[FORCES] + m.c[FRICTIONS] + 2 * m.c[STATES] + m.c[INPUTS])


def _rate(here: int, t: float, y: Any, out: Any, spare: Any) -> float:
    m = machine_at(here)
    m.settings[RATES] += 1.0
    needs, n = m.settings[NEEDS], size_of(m)
    state, slope = _carray(y, (n,)), _carray(out, (n,))
    rate_of(m.x, m.c, m.laws, t, m.modes, m.drives, m.w, m.ints, m.floats, m.work, state, m.q, m.v, needs, slope)
    return 0.0


def _guards(here: int, t: float, y: Any, out: Any, slope: Any) -> float:
    m = machine_at(here)
    m.settings[GUARDS] += 1.0
    n, sticks = size_of(m), False
    for r in range(m.c[FRICTIONS]):
        sticks |= m.modes[1 + m.c[FORCES] + r] == STICK
    state, rate, found = _carray(y, (n,)), _carray(slope, (n,)), _carray(out, (m.modes.size,))
    if sticks:
        needs = m.settings[NEEDS]
        rate_of(m.x, m.c, m.laws, t, m.modes, m.drives, m.w, m.ints, m.floats, m.work, state, m.q, m.v, needs, rate)
    else:
        _exert(m, t, state)
    c, modes = m.c, m.modes
    guards(m.x, c, m.laws, modes, m.w, found)
    base = 1 + c[FORCES]
    for r in range(c[FRICTIONS]):
        if c[c[FRICTION_NORMAL] + r] == 1 and modes[0] != PRESSED:
            found[base + r] = 1.0  # nothing presses: the friction is idle, whatever its rate does
        elif modes[base + r] == STICK:
            found[base + r] += m.settings[SLACK]
        elif c[c[FRICTION_MATE] + r] == NONE:
            for other in range(c[FRICTIONS]):  # where another one holds the same port, nothing slides
                if modes[base + other] == STICK and c[c[FRICTION_PORT] + other] == c[c[FRICTION_PORT] + r]:
                    found[base + r] = 1.0
    return float(m.w[c[V] + c[PRESS]]) if c[PRESS] >= 0 else 0.0


@lean
def rate_at(m: Any, t: float, y: Any, out: Any) -> None:
    """out = dy/dt in the present modes, and all forces into the work array."""
    _call(m.rate, m.here, t, y, out, out)


@lean
def guards_at(m: Any, t: float, y: Any, out: Any, slope: Any) -> float:
    """Guards of all modes into `out`; returns the rate of the penetration. `slope` may be overwritten."""
    return float(_call(m.guards, m.here, t, y, out, slope))


@lean
def port_speed(m: Any, r: int) -> float:
    """Rate of the port of friction `r` at the state last evaluated."""
    return float(m.w[m.c[V] + m.c[m.c[FRICTION_PORT] + r]])


@lean
def row_of(m: Any, r: int) -> int:
    """Where the row of friction `r` begins in the work array."""
    return int(m.c[W_ROWS] + m.c[m.c[FRICTION_PORT] + r] * m.v.size)


@jit
def called(function: int, here: int, t: float, a: Any, b: Any, c: Any) -> float:
    """For a caller in Python: what `Machine.rate` or `Machine.guards` gives."""
    return float(_call(function, here, t, a, b, c))
