"""Right-hand side of the reduced model, whole for readers and lean for the integrator. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.reduced.arrays import (
    CONSTANT,
    CONTACT_FORCE,
    FORCES,
    FRICTIONS,
    LINEAR,
    LIVE_FORCES,
    LIVE_PORTS,
    MASS,
    PORTS,
    PRESS,
    STATES,
    TAU,
    Z_RATE,
    N,
)
from spacerobot.simulation.reduced.forces import STICK, act, say, stick
from spacerobot.simulation.reduced.ports import kinematics
from spacerobot.support.jit import lean


@lean
def evaluate(x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, out: Any) -> None:
    """out = dy/dt; `w` keeps every force. modes = (contact, edge signs (F), frictions (R))."""
    n, tau = c[N], c[TAU]
    kinematics(x, c, y, w, c[PORTS])
    for i in range(n):
        w[tau + i] = x[c[CONSTANT] + i]
    stuck = act(x, c, laws, t, modes, u, w, c[FORCES])
    if stuck > 0:
        stick(x, c, stuck, w)
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = w[tau + i] * x[c[MASS] + i]
    for s in range(c[STATES]):
        out[2 * n + s] = w[c[Z_RATE] + s]


@lean
def accelerate(x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, out: Any) -> None:
    """As `evaluate`, but linear springs and dampers act through one matrix, and `w` keeps only the live forces."""
    n, tau, linear = c[N], c[TAU], c[LINEAR]
    kinematics(x, c, y, w, c[LIVE_PORTS])
    for i in range(n):
        total = x[c[CONSTANT] + i]
        row = linear + 2 * n * i
        for j in range(2 * n):
            total += x[row + j] * y[j]
        w[tau + i] = total
    stuck = act(x, c, laws, t, modes, u, w, c[LIVE_FORCES])
    if stuck > 0:
        stick(x, c, stuck, w)
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = w[tau + i] * x[c[MASS] + i]
    for s in range(c[STATES]):
        out[2 * n + s] = w[c[Z_RATE] + s]


@lean
def sense(x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, slope: Any) -> None:
    """What guards need of the state y, and no more: accelerations only where something sticks."""
    base = 1 + c[FORCES]
    for r in range(c[FRICTIONS]):
        if modes[base + r] == STICK:
            accelerate(x, c, laws, t, y, modes, u, w, slope)
            return
    kinematics(x, c, y, w, c[LIVE_PORTS])
    if c[PRESS] >= 0:
        say(x, c, laws, modes, w, c[CONTACT_FORCE])
