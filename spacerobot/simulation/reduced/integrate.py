"""The integration loop: adaptive steps, events, kicks, and the record of every step. Compiled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.simulation.reduced.affine import DEGREE, DRIVEN, advance, series, shorten, straight, system
from spacerobot.simulation.reduced.arrays import (
    EDGE,
    FORCES,
    FRICTIONS,
    INPUTS,
    KICK,
    KICK_TIME,
    KICKS,
    MASS,
    PRESS,
    STATES,
    N,
)
from spacerobot.simulation.reduced.crossings import first_fall, linear_guards
from spacerobot.simulation.reduced.edges import first_edge
from spacerobot.simulation.reduced.events import (
    SUBSAMPLES,
    find_event,
    settle,
    start_modes,
    switch,
)
from spacerobot.simulation.reduced.guards import guards
from spacerobot.simulation.reduced.motion import accelerate
from spacerobot.simulation.reduced.ports import ramp
from spacerobot.simulation.reduced.rosenbrock import (
    STABLE,
    STAGES,
    Room,
    hastiness,
    linearise,
    remembers,
    stiff_dense,
    stiff_norm,
    stiff_stages,
)
from spacerobot.simulation.reduced.stepper import ORDER, dense, error_norm, interpolate, stages
from spacerobot.support.jit import jit, lean, part

OK, TOO_MANY_STEPS, TOO_MANY_EVENTS, NOT_FINITE = 0, 1, 2, 3
NEAR = 1e-7
"""Share of a step: Newton's correction of an event's time is the last when it is smaller, for the next one would be of
the order of its square."""
MAX_STEPS, MAX_EVENTS = 1_000_000, 100_000

CORNERS = 8
"""Steps of the series that cost as much as one of the general method: where a drive bends more often, the latter."""


class Steps(NamedTuple):
    """Every accepted step. m steps, N = 2n + S states, G modes."""

    time: np.ndarray  # (m,)
    length: np.ndarray  # (m,)
    state: np.ndarray  # (m, N) at the start of the step
    dense: np.ndarray  # (m, N, DEGREE, or DRIVEN)
    order: np.ndarray  # (m,) int, how many of the dense coefficients are the step's own
    modes: np.ndarray  # (m, G) int

    @classmethod
    def shaped(cls, size: int, *flat: np.ndarray) -> Steps:
        """From what `integrate` returns, for states of this size."""
        time, length, state, dense, order, modes = flat
        m = time.size
        return cls(
            time,
            length,
            state.reshape(m, size),
            dense.reshape(m, size, dense.size // max(m * size, 1)),
            order,
            modes.reshape(m, modes.size // max(m, 1)),
        )


@part
def _grow(a: Any) -> Any:
    out = np.empty(2 * a.size, dtype=a.dtype)
    for i in range(a.size):
        out[i] = a[i]
    return out


@lean
def _advance(
    x: Any, c: Any, laws: Any, t: float, y: Any, h: float, modes: Any, u: Any, w: Any, k: Any, o: Any, stiff: bool,
    new: Any,
) -> None:  # fmt: skip
    """A step of the general method whose first slope is k[0]; its end is left in `new`."""
    if stiff:
        stiff_stages(x, c, laws, t, y, h, modes, u, w, k, o, new)
    else:
        stages(x, c, laws, t, y, h, modes, u, w, k, new)


@lean
def _interpolant(y: Any, new: Any, h: float, k: Any, stiff: bool, q: Any) -> None:
    """Coefficients of the interpolant of the step just taken."""
    if stiff:
        stiff_dense(y, new, h, k, q)
    else:
        dense(k, q)


@jit
def integrate(
    x: Any,
    c: Any,
    laws: Any,
    w: Any,
    y0: Any,
    t0: float,
    t1: float,
    rtol: float,
    atol: Any,
    h_first: float,
    h_max: float,
    u: Any,
    most: int,
) -> Any:
    """Integrates from t0 to t1; returns the steps as flat arrays, events (time, index, new mode), and status.

    Arrays of one shape only are kept, because the compiler takes a second over each further kind that grows.
    """
    size = y0.size
    y = y0.copy()
    new, temp, slope = np.empty(size), np.empty(size), np.empty(size)
    k = np.zeros((1 + STAGES, size))
    wide = DEGREE if c[INPUTS] == 0 else DRIVEN
    q = np.empty((size, wide))
    across = size + 1 + c[INPUTS]
    a, total = np.empty((size - c[N], across)), np.empty(size - c[N])
    held, drives = np.empty((c[FRICTIONS], across)), np.zeros((2, c[INPUTS]))
    own, scale = size - c[N], atol.copy()
    o = Room(np.empty((own, size)), np.empty((own, own)), np.empty(own), np.empty(size), np.empty((2, size)))
    bends, stiff, hasty = remembers(c), False, 0.0
    guarding = 2 + 2 * c[FRICTIONS] + c[STATES]
    rows, owner, p = np.empty((guarding, across)), np.empty(guarding, dtype=np.int64), np.empty(wide + 1)
    modes = start_modes(x, c, laws, t0, y, u, w, slope)
    count = modes.size
    samples = np.empty((SUBSAMPLES + 2, count))
    rates = np.empty(SUBSAMPLES + 1)
    cap = 512
    times, lengths = np.empty(cap), np.empty(cap)
    states, denses = np.empty(cap * size), np.empty(cap * size * wide)
    kept, orders = np.empty(cap * count, dtype=np.int64), np.empty(cap, dtype=np.int64)
    ecap = 64
    etime, eindex, emode = np.empty(ecap), np.empty(ecap, dtype=np.int64), np.empty(ecap, dtype=np.int64)
    m, e, kick = 0, 0, 0
    t = t0
    h = min(h_first, h_max)
    status = OK
    edged = False
    for j in range(c[FORCES]):
        edged |= c[c[EDGE] + j] >= 0
    watched = edged or c[PRESS] >= 0 or c[FRICTIONS] > 0 or c[STATES] > 0
    while kick < c[KICKS] and x[c[KICK_TIME] + kick] < t0:
        kick += 1
    alike = max(t1 - t0, 0.0) / max(h_max, 1e-300) + c[KICKS]  # about as many steps of the general method
    plain = c[INPUTS] == 0 or np.sum((u[0] > t0) & (u[0] < t1)) <= CORNERS * alike
    corner, bend = 0, np.inf  # of the drives: the last one, and when the next one is
    fresh, even, known, sloped = True, False, False, False  # modes just changed; straight; k[0] is dy/dt
    reach, linear = 0.0, -1  # longest step of a straight mode; how many guards, where all are linear
    while t < t1 and status == OK:
        # room is made out here: in the loop that steps, an array that may be another one next time is counted each time
        if m == times.size:
            times, lengths, states, denses = _grow(times), _grow(lengths), _grow(states), _grow(denses)
            kept, orders = _grow(kept), _grow(orders)
        if e == etime.size:
            etime, eindex, emode = _grow(etime), _grow(eindex), _grow(emode)
        while t < t1 and m < times.size and e < etime.size:
            stop = t1
            if kick < c[KICKS] and x[c[KICK_TIME] + kick] <= t1:
                stop = x[c[KICK_TIME] + kick]
            if kick < c[KICKS] and stop == x[c[KICK_TIME] + kick] and stop - t <= 1e-15 * max(1.0, abs(t)):
                moved = False
                for i in range(c[N]):
                    y[c[N] + i] += x[c[MASS] + i] * x[c[KICK] + kick * c[N] + i]
                    moved |= x[c[KICK] + kick * c[N] + i] != 0.0
                kick += 1
                if not moved:  # where a drive leaps
                    continue
                begun = start_modes(x, c, laws, t, y, u, w, slope)
                for i in range(1, count):
                    modes[i] = begun[i]
                fresh = True
                continue
            if fresh:
                even = plain and straight(x, c, modes)
                if even:
                    reach = (
                        system(x, c, laws, y, modes, w, a, held) * wide / DEGREE
                    )  # a shorter series is stable for less
                linear = linear_guards(x, c, laws, modes, w, even, held, rows, owner)
                fresh, known = False, False
            full = min(reach if even else h, h_max)
            if even and c[INPUTS] > 0:
                corner, bend = ramp(u, corner, t, drives)
                full = min(full, bend - t)
            bent, final = even and full == bend - t, False
            if full >= (stop - t) * (1.0 - 1e-12):
                full, final = stop - t, True
            order = wide if even else ORDER
            grow = 1.0
            if even:
                part = series(y, a, drives, full, rtol, atol, q, temp, total)
                if part < full:
                    full, bent, final = part, False, False
                if not full > 0.0:
                    status = NOT_FINITE
                    break
                advance(y, full, q, new)
            else:
                if not known:
                    accelerate(x, c, laws, t, y, modes, u, w, k[0])
                    known, hasty = True, hastiness(x, c, laws, y, modes, w, rtol, atol, scale) if bends else 0.0
                    sloped = False
                stiff = hasty * full > STABLE
                if stiff and not sloped:
                    linearise(x, c, laws, t, y, modes, u, w, k[0], atol, o)
                    sloped = True
                _advance(x, c, laws, t, y, full, modes, u, w, k, o, stiff, new)
                norm = stiff_norm(y, new, k, rtol, scale) if stiff else error_norm(y, new, full, k, rtol, scale)
                if not np.isfinite(norm):
                    if full < 1e-14:
                        status = NOT_FINITE
                        break
                    h = 0.1 * full
                    continue
                if norm > 1.0:
                    h = full * max(0.2, 0.9 * norm**-0.2)
                    if h < 1e-15 * max(1.0, abs(t)):
                        status = TOO_MANY_STEPS
                        break
                    continue
                grow = 5.0 if norm < 1e-10 else min(5.0, 0.9 * norm**-0.2)
                _interpolant(y, new, full, k, stiff, q)
            hit = -1
            if linear >= 0:
                hit, theta = first_fall(rows, owner, linear, y, drives, full, q, order, p)
            elif watched:
                hit, theta = find_event(x, c, laws, t, y, full, q, order, modes, u, w, temp, slope, samples, rates)
            if edged:  # a gap may be entered and left between the moments at which `find_event` looks
                hit, theta = first_edge(x, c, laws, modes, w, y, full, q, order, p, hit, theta)
            part = full
            if hit >= 0 and even:
                shorten(q, theta)
                part = theta * full
                advance(y, part, q, new)
            elif hit > c[FORCES] + c[FRICTIONS]:
                # a memory's port turns: nothing jumps, and the interpolant is near enough
                part = max(theta * full, 0.0)
                interpolate(y, full, q, order, theta, new)
                shorten(q, theta)
            elif hit >= 0:
                # the interpolant is less accurate than the step: redo the step to the event and polish its length
                part = max(theta * full, 0.0)
                stiff = stiff and part > 0.0
                for _ in range(4):
                    _advance(x, c, laws, t, y, part, modes, u, w, k, o, stiff, new)
                    accelerate(x, c, laws, t + part, new, modes, u, w, slope)
                    guards(x, c, laws, modes, w, samples[0])
                    value = samples[0, hit]
                    probe = max(1e-7 * full, 1e-12)
                    for i in range(size):
                        temp[i] = new[i] + probe * slope[i]
                    accelerate(x, c, laws, t + part + probe, temp, modes, u, w, slope)
                    guards(x, c, laws, modes, w, samples[1])
                    rate = (samples[1, hit] - value) / probe
                    if rate >= 0.0:
                        break
                    change = -value / rate
                    if part + change <= 0.0 or part + change > full:
                        break
                    part += change
                    if abs(change) < max(NEAR * full, 1e-15 * max(1.0, abs(t))):
                        break
                _advance(x, c, laws, t, y, part, modes, u, w, k, o, stiff, new)
                _interpolant(y, new, part, k, stiff, q)
            times[m], lengths[m], orders[m] = t, part, order
            for i in range(size):
                states[m * size + i] = y[i]
                for power in range(order):
                    denses[(m * size + i) * wide + power] = q[i, power]
            for i in range(count):
                kept[m * count + i] = modes[i]
            m += 1
            for i in range(size):
                y[i] = new[i]
            if hit >= 0:
                t += part
            elif final:
                t = stop
            else:
                t = bend if bent else t + part
            if hit >= 0:
                switch(x, c, laws, hit, t, y, modes, u, w, slope)
                settle(x, c, laws, t, y, modes, u, w, slope)
                fresh = True
                etime[e], eindex[e], emode[e] = t, hit, modes[hit]
                e += 1
                if e >= MAX_EVENTS:
                    status = TOO_MANY_EVENTS
                    break
            elif not even:
                h = full * grow if not final else max(h, full * grow)
                known = not stiff and not bends
                for i in range(size):
                    k[0, i] = k[6, i]
            if m >= most:
                status = TOO_MANY_STEPS
                break
    return (
        times[:m],
        lengths[:m],
        states[: m * size],
        denses[: m * size * wide],
        orders[:m],
        kept[: m * count],
        etime[:e],
        eindex[:e],
        emode[:e],
        status,
    )
