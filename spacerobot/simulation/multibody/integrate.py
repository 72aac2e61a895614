"""The integration loop: adaptive steps, events, kicks, and the record of every step. Compiled.

A step is explicit, of order 8, where that is stable at the length that accuracy allows, and collocated where it is not.

Python hands the loop room for some rows at a time, so that a long run can be interrupted and its record grows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.simulation.multibody.collocation import (
    Room,
    accepted,
    collocate,
    collocated,
    linearise,
    room_for,
    stretch,
)
from spacerobot.simulation.multibody.dop853 import ALL_STAGES, ORDER, POWERS, STAGES, C
from spacerobot.simulation.multibody.kernel import load, solve
from spacerobot.simulation.multibody.layout import SPLIT, layout_inside, scratch_inside
from spacerobot.simulation.multibody.machine import Machine, guards_at, rate_at
from spacerobot.simulation.multibody.modes import start, switch, turn
from spacerobot.simulation.multibody.radau import NODES
from spacerobot.simulation.multibody.stepper import error_norm, interpolant, stage
from spacerobot.simulation.multibody.watch import SAMPLES, first_event
from spacerobot.simulation.reduced.arrays import EDGE, FORCES, FRICTIONS, HEADING, PORTS, PRESS, STATES, W_ROWS
from spacerobot.support.jit import jit, lean

MAX_STEPS, MAX_EVENTS = 150_000, 5_000
"""The record of so many steps takes most of 1 GB."""

AHEAD = 1e-7
"""Share of a step before its end at which the slope of what comes to rest there is taken."""

NEAR = 1e-7
"""Share of a step: what Newton's correction of an event's time leaves is the square of it, so that the state goes there
along its slope."""

SHORT = 1e-9
"""Share of a run: in a step that is shorter an event is taken where it was found, though its guard does not fall."""

STABLE = 6.1
"""Fastest rate times step up to which the explicit method is stable (Hairer's dop853.f, its test for stiffness)."""

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 6.0
FIRST_ROWS, MOST_ROWS = 128, 4096
"""Steps that a part of the record has room for, doubled from part to part."""

DONE, FULL, VANISHED, TOO_MANY_STEPS, TOO_MANY_EVENTS = range(5)
TIME, STEP, END, LONGEST, FIXED = range(5)
BEGUN, ROWS, EVENTS, KICKS = range(4)


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
        rows: all of it, as `_onwards` wrote it.
    """

    time: np.ndarray
    length: np.ndarray
    state: np.ndarray
    dense: np.ndarray
    modes: np.ndarray
    heading: np.ndarray
    last: np.ndarray
    rows: np.ndarray


@dataclass(frozen=True, eq=False)
class Record:
    """What a run leaves, and how it ended.

    Attributes:
        steps: all steps.
        events: shape (E, 3), time [s], which mode, and what it became.
        kicks: shape (K,), energy that each known impulse brought [J]; of those that happened.
        status: DONE, TOO_MANY_STEPS, TOO_MANY_EVENTS, or VANISHED (no step is short enough).
        reached: [s].
    """

    steps: Steps
    events: np.ndarray
    kicks: np.ndarray
    status: int
    reached: float


@lean
def _advance(m: Any, t: float, y: Any, h: float, k: Any, scale: Any, o: Any, stiff: bool, temp: Any, new: Any) -> float:
    """A step whose first slope is k[0]; its end is left in `new`. Returns its error over its tolerance."""
    if stiff:
        return collocate(m, t, y, h, k[0], scale, o, temp, new)
    for s in range(1, STAGES):
        stage(y, k, s, h, temp)
        rate_at(m, t + C[s] * h, temp, k[s])
    stage(y, k, STAGES, h, new)
    rate_at(m, t + h, new, k[STAGES])
    return error_norm(k, h, scale)


@lean
def _interpolated(m: Any, t: float, y: Any, h: float, k: Any, o: Any, stiff: bool, temp: Any, new: Any, f: Any) -> None:
    """The interpolant of the step just taken, into f shape (POWERS, N)."""
    if stiff:
        collocated(o, f)
        return
    for s in range(STAGES + 1, ALL_STAGES):
        stage(y, k, s, h, temp)
        rate_at(m, t + C[s] * h, temp, k[s])
    interpolant(y, new, k, h, f)


@lean
def _polished(
    m: Any, hit: int, t: float, y: Any, full: float, part: float, k: Any, scale: Any, o: Any, stiff: bool,
    temp: Any, new: Any, slope: Any, g: Any, sure: bool,
) -> float:  # fmt: skip
    """Length at which guard `hit` is zero, by Newton on the step itself (the interpolant is less accurate).

    Negative where a step of such a length does not settle, for it comes too close to where something stands still;
    and, where it must be `sure`, where the guard does not fall there: what the longer step saw was its own error.
    """
    if not np.isfinite(_advance(m, t, y, part, k, scale, o, stiff, temp, new)):
        return -1.0
    for _ in range(4):
        if stiff:
            rate_at(m, t + part, new, k[STAGES])
        guards_at(m, t + part, new, g, slope)
        value = g[hit]
        probe = max(1e-7 * full, 1e-12)
        for i in range(y.size):
            temp[i] = new[i] + probe * k[STAGES, i]
        guards_at(m, t + part + probe, temp, g, slope)
        rate = (g[hit] - value) / probe
        change = -value / rate if rate < 0.0 else np.inf
        if part + change > full and sure:
            return -1.0
        if not 0.0 < part + change <= full:
            break
        part += change
        if abs(change) < max(NEAR * full, 1e-15 * max(1.0, abs(t))):
            for i in range(y.size):
                new[i] += change * k[STAGES, i]
            stretch(o, change)
            # what comes to rest has a direction only just before: there rounding would tell the slope's
            before = AHEAD * part if hit > m.c[FORCES] else 0.0
            for i in range(y.size):
                temp[i] = new[i] - before * k[0, i]
            rate_at(m, t + part - before, temp, k[STAGES])
            break
        if not np.isfinite(_advance(m, t, y, part, k, scale, o, stiff, temp, new)):
            return -1.0
    return part


@lean
def _onto(m: Any, new: Any, y: Any) -> None:
    """y = new, back on the manifold of configurations."""
    load(new, layout_inside(m.ints, m.floats).joints, m.q, m.v)
    for i in range(y.size):
        y[i] = m.q[i] if i < m.q.size else new[i]


@lean
def _kick(m: Any, t: float, y: Any, port: int, impulse: float, slope: Any) -> float:
    """A known impulse at a port; returns the energy it brings [J]."""
    nq, nv = m.q.size, m.v.size
    scratch, contact = scratch_inside(m.ints, m.work), m.modes[0]
    rate_at(m, t, y, slope)
    row, jump, speed, gain = m.c[W_ROWS] + port * nv, scratch.held[0], 0.0, 0.0
    for i in range(nv):
        jump[i] = impulse * m.w[row + i]
        speed += m.w[row + i] * y[nq + i]
    solve(scratch.factor, m.ints[SPLIT], jump)
    for i in range(nv):
        gain += m.w[row + i] * jump[i]
        y[nq + i] += jump[i]
    start(m, t, y, slope)
    m.modes[0] = contact
    return float(impulse * (speed + 0.5 * gain))


@jit
def _onwards(
    m: Any, y: Any, clock: Any, count: Any, k: Any, scale: Any, o: Any,
    kicks: Any, ports: Any, work: Any, rows: Any, happened: Any,
) -> int:  # fmt: skip
    """Goes on from (clock, y) until the end, or until `rows` or `happened` are full.

    Args:
        m: the machine, in its modes.
        y: ambient state, shape (N,); overwritten.
        clock, count: where it stands, TIME to FIXED and BEGUN to KICKS; overwritten.
        k: slopes, shape (ALL_STAGES, N); the first is that of y.
        scale: error per step that is tolerated, shape (N,).
        o: room for collocated steps.
        kicks, ports: times [s] and sizes of known impulses, shape (I, 2), and their ports, shape (I,).
        work: energy each of them brings [J], shape (I,); filled.
        rows: room for (time, length, state, interpolant, modes, heading) of each step; filled.
        happened: room for (time, which, what it became) of each event; filled.
    """
    size, modes, frictions = y.size, m.modes.size, m.c[FRICTIONS]
    new, temp, slope, f = np.empty(size), np.empty(size), np.empty(size), np.empty((POWERS, size))
    g, samples, rates = np.empty(modes), np.empty((SAMPLES + 1, modes)), np.empty(SAMPLES + 1)
    t, h, end = clock[TIME], clock[STEP], clock[END]
    if count[BEGUN] == 0:
        start(m, t, y, slope)
        rate_at(m, t, y, k[0])
        count[BEGUN] = 1
    watched = m.c[PRESS] >= 0 or frictions > 0 or m.c[STATES] > 0
    for j in range(m.c[FORCES]):
        watched |= m.c[m.c[EDGE] + j] >= 0
    status, fastest = DONE, linearise(m, scale, o)
    while t < end:
        if count[ROWS] == rows.shape[0] or count[EVENTS] == happened.shape[0]:
            status = FULL
            break
        stop, i = end, count[KICKS]
        if i < ports.size and kicks[i, 0] <= end:
            stop = kicks[i, 0]
            if stop - t <= 1e-15 * max(1.0, abs(t)):
                work[i] = _kick(m, t, y, ports[i], kicks[i, 1], slope)
                rate_at(m, t, y, k[0])
                fastest = linearise(m, scale, o)
                accepted(o, 0.0)
                count[KICKS] += 1
                continue
        full = min(h, clock[LONGEST])
        final = full >= (stop - t) * (1.0 - 1e-12)
        if final:
            full = stop - t
        stiff = fastest * full > STABLE
        order = NODES + 1.0 if stiff else 1.0 * ORDER
        norm = _advance(m, t, y, full, k, scale, o, stiff, temp, new)
        if clock[FIXED] > 0.0:
            norm = 0.0
        if not norm <= 1.0:
            h = full * (max(_SHRINK, _SAFETY * norm ** (-1.0 / order)) if np.isfinite(norm) else 0.1)
            if h < 1e-15 * max(1.0, abs(t)):
                status = VANISHED
                break
            continue
        grow = _GROW if norm < 1e-12 else min(_GROW, _SAFETY * norm ** (-1.0 / order))
        _interpolated(m, t, y, full, k, o, stiff, temp, new, f)
        hit, theta = -1, 2.0
        if watched:
            hit, theta = first_event(m, t, y, full, f, temp, slope, g, samples, rates)
        part = full
        if hit >= 0:
            sure = hit > 0 and full > SHORT * end  # a gap may close from rest, and hardly fall at first
            part = _polished(m, hit, t, y, full, theta * full, k, scale, o, stiff, temp, new, slope, g, sure)
            if part < 0.0:
                h = full * max(0.5 * theta, _SHRINK)
                if h < 1e-15 * max(1.0, abs(t)):
                    status = VANISHED
                    break
                continue
            _interpolated(m, t, y, part, k, o, stiff, temp, new, f)
        row = rows[count[ROWS]]
        row[0], row[1] = t, part
        for i in range(size):
            row[2 + i] = y[i]
            for p in range(POWERS):
                row[2 + size + p * size + i] = f[p, i]
        at = 2 + size + POWERS * size
        for i in range(modes):
            row[at + i] = m.modes[i]
        for r in range(frictions):
            row[at + modes + r] = m.w[m.c[HEADING] + r]
        count[ROWS] += 1
        _onto(m, new, y)
        t = stop if final and hit < 0 else t + part
        if hit >= 0:
            switch(m, hit, t, y, slope)
            event = happened[count[EVENTS]]
            event[0], event[1], event[2] = t, hit, m.modes[hit]
            count[EVENTS] += 1
        else:
            h = max(h, full * grow) if final else full * grow
            accepted(o, full if stiff else 0.0)
        rate_at(m, t, y, k[0])
        turn(m)
        fastest = linearise(m, scale, o)
    clock[TIME], clock[STEP] = t, h
    return status


def integrate(
    machine: Machine, y: np.ndarray, scale: np.ndarray, clock: np.ndarray, kicks: np.ndarray, ports: np.ndarray
) -> Record:
    """Carry a machine from its state to the end.

    Args:
        machine: its work arrays are used.
        y: shape (N,), overwritten: the state at the end.
        scale: shape (N,), error per step that is tolerated in each ambient state.
        clock: start, first step, end, longest step [s], and 1 for steps of that length whatever their error.
        kicks, ports: known impulses by time, see `_onwards`.
    """
    size, modes, frictions = y.size, machine.modes.size, int(machine.c[FRICTIONS])
    count, k, work = np.zeros(4, dtype=np.int64), np.zeros((ALL_STAGES, size)), np.zeros(ports.size)
    nodes: Room = room_for(size, machine.v.size, int(machine.c[PORTS]), frictions)
    parts, events = [], []
    done, happened, room, status = 0, 0, FIRST_ROWS, FULL
    while status == FULL and done <= MAX_STEPS and happened <= MAX_EVENTS:
        rows = np.empty((room, 2 + (1 + POWERS) * size + modes + frictions))
        some = np.empty((room, 3))
        count[ROWS] = count[EVENTS] = 0
        status = _onwards(machine, y, clock, count, k, scale, nodes, kicks, ports, work, rows, some)
        parts.append(rows[: count[ROWS]])
        events.append(some[: count[EVENTS]])
        done, happened, room = done + count[ROWS], happened + count[EVENTS], min(2 * room, MOST_ROWS, MAX_STEPS + 1)
    if status == FULL:
        status = TOO_MANY_STEPS if done > MAX_STEPS else TOO_MANY_EVENTS
    whole = parts[0] if len(parts) == 1 else np.concatenate(parts)
    at = 2 + (1 + POWERS) * size
    steps = Steps(
        whole[:, 0].copy(),
        whole[:, 1].copy(),
        whole[:, 2 : 2 + size],
        whole[:, 2 + size : at].reshape(-1, POWERS, size),
        whole[:, at : at + modes].astype(np.int64),
        whole[:, at + modes :],
        y,
        whole,
    )
    return Record(steps, np.concatenate(events), work[: count[KICKS]], status, float(clock[TIME]))
