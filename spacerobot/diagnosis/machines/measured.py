"""An effect's own kernels, evaluated on measured motion instead of inside a simulation."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Protocol

import numpy as np

from spacerobot.effects.filters import BOTH_WAYS, summed
from spacerobot.effects.kernel import padded
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import at_rest
from spacerobot.effects.primitives import ChannelMap
from spacerobot.simulation.reduced.forces import AT_REST, call_law, call_memory
from spacerobot.simulation.reduced.law_table import LAWS
from spacerobot.support.jit import jit


class Lens(Protocol):
    """What a motion was seen through."""

    def blurred(self, x: np.ndarray) -> np.ndarray:
        """A signal that goes on at its ends as it is there, shape (T,) both."""
        ...


@jit
def _along(laws: Any, law: int, d: Any, v: Any, aux: Any, p: Any, out: Any) -> None:
    for i in range(d.size):
        out[i] = call_law(laws[law], d[i], v[i], aux[i], p, 0)


@jit
def _sliding(laws: Any, law: int, d: Any, v: Any, normal: Any, p: Any, out: Any) -> None:
    for i in range(v.size):
        if v[i] > 0.0:
            out[i] = -call_law(laws[law], v[i], normal[i], d[i], p, 0)
        elif v[i] < 0.0:
            out[i] = call_law(laws[law], v[i], normal[i], d[i], p, 0)
        else:
            out[i] = 0.0


@jit
def _remembering(
    laws: Any, rate: int, force: int, step: float, d: Any, v: Any, p: Any, z: float, probe: float, out: Any
) -> None:
    """The force of a law with a memory; exponential steps from sample to sample, at the motion halfway between them."""
    for i in range(d.size):
        way = 1.0 if v[i] >= 0.0 else -1.0
        slope = call_memory(laws[rate], (z, 0.0, d[i], v[i], way, 1.0), p, 0)
        out[i] = call_memory(laws[force], (z, slope, d[i], v[i], way, 1.0), p, 0)
        if i + 1 < d.size:
            middle, speed = 0.5 * (d[i] + d[i + 1]), 0.5 * (v[i] + v[i + 1])
            way = 1.0 if speed >= 0.0 else -1.0
            slope = call_memory(laws[rate], (z, 0.0, middle, speed, way, 1.0), p, 0)
            bend = (call_memory(laws[rate], (z + probe, 0.0, middle, speed, way, 1.0), p, 0) - slope) / probe
            z += slope * (np.expm1(bend * step) / bend if bend != 0.0 else step)


def port_forces(
    mechanism: Mechanism,
    position: Mapping[str, np.ndarray],
    velocity: Mapping[str, np.ndarray],
    step: float,
    lens: Lens | None = None,
    held: Mapping[str, tuple[np.ndarray, float]] | None = None,
    at: Collection[str] | None = None,
) -> dict[str, np.ndarray]:
    """What the mechanism's forces, frictions and laws with a memory exert at each port along a measured motion.

    Friction is read as sliding, and as nothing where the velocity is exactly zero. What holds a body at rest takes
    whatever value the rest of the balance asks for, up to its level; where `held` tells what is asked, so it does.

    Args:
        mechanism: what acts; at ports without a measured motion it is left out.
        position, velocity: by coordinate, shape (T,) each [m or rad, and per s].
        step: from sample to sample [s].
        lens: what the motion, and the forces it is compared with, were seen through: where a law leaps with the sign of
            a smoothed rate, the force itself leaps no faster than that shows.
        held: port -> what all forces on its one coordinate together must be, shape (T,), and the rate below which that
            may stand still.
        at: the ports asked for, those that share a coordinate with a held one among them; all if None.

    Returns:
        port -> force along it, shape (T,) [N or N m].
    """
    count = next(iter(position.values())).size
    # compiled code does not look where it writes
    assert all(x.shape == (count,) for x in (*position.values(), *velocity.values()))
    moving = {p: row for p, row in mechanism.ports.items() if row and all(c in position for c in row)}

    def seen(port: str, states: Mapping[str, np.ndarray]) -> np.ndarray:
        row = moving[port]
        (first, *rest) = row  # most ports are one coordinate, and nothing need be summed
        along = states[first] if row[first] == 1.0 else row[first] * states[first]
        return np.ascontiguousarray(sum((row[c] * states[c] for c in rest), along), dtype=float)

    wanted = moving if at is None else moving.keys() & at
    out: dict[str, np.ndarray] = {}
    value, nothing, whole = np.empty(count), np.zeros(count), np.ones(count)
    held = {port: asked for port, asked in (held or {}).items() if len(moving.get(port, ())) == 1}
    for force in mechanism.forces:
        sense = force.sense or force.port
        if force.port not in wanted or not {sense, *force.beside} <= moving.keys():
            continue
        aux = force.read_beside(lambda p: seen(p, velocity))
        aux, law = nothing if aux is None else aux, LAWS.index(force.kernel.force)
        _along(LAWS.laws, law, seen(sense, position), seen(sense, velocity), aux, padded(force.p), value)
        out[force.port] = out.get(force.port, 0.0) + value
    for state in mechanism.states:
        if state.port not in wanted or state.normal is not None:
            continue
        places, p = seen(state.port, position), np.array(state.p, dtype=float)
        rate, law = (LAWS.index(f, memory=True) for f in (state.law.rate, state.law.force))
        start = at_rest(state.law, float(places[0]), state.size, state.p)
        _remembering(LAWS.laws, rate, law, step, places, seen(state.port, velocity), p, start, 1e-6 * state.size, value)
        out[state.port] = out.get(state.port, 0.0) + value
    for friction in sorted(mechanism.frictions, key=lambda f: f.port in held):  # what may hold takes what others leave
        if friction.port not in wanted or friction.normal is not None:
            continue
        law, p, sliding = LAWS.index(friction.level), padded(friction.p), seen(friction.port, velocity)
        places = seen(friction.port, position)
        _sliding(LAWS.laws, law, places, sliding, whole, p, value)
        rubs = value.copy() if lens is None else lens.blurred(value)
        if friction.port in held:
            needed, slow = held[friction.port]
            ends = np.empty(count), np.empty(count)
            for end, way in zip(ends, (AT_REST, -AT_REST), strict=True):
                _sliding(LAWS.laws, law, places, np.full(count, way), whole, p, end)
            rest = np.abs(sliding) < slow
            (held_by,) = moving[friction.port]
            others = sum(moving[port].get(held_by, 0.0) * force for port, force in out.items())
            rubs[rest] = np.clip(needed - others, *ends)[rest]
        out[friction.port] = out.get(friction.port, 0.0) + rubs
    return out


def _filtered(m: ChannelMap, value: np.ndarray, step: float) -> np.ndarray:
    """A channel, shape (T,), through a low-pass filter that had settled at its first reading.

    As it answers lines between the samples, exactly: steps would be early or late by half of one.
    """
    from scipy.signal import lfilter

    def respond(rate: complex | float) -> np.ndarray:
        times = 2.0 * np.pi * m.value * step * rate
        decay = np.exp(-times)
        mean = (1.0 - decay) / times
        settled = [mean * value[0]]
        return np.asarray(lfilter([1.0 - mean, mean - decay], [1.0, -decay], value, zi=settled)[0])

    return summed(m.form, respond)


def through_sensor(maps: tuple[ChannelMap, ...], value: np.ndarray, step: float) -> np.ndarray:
    """A channel on an even grid of `step` seconds, shape (T,), as its sensor's maps show it."""
    for m in sorted(maps, key=lambda m: m.rank):
        if m.kind == "low_pass" and np.isfinite(m.value):
            value = _filtered(m, value, step)
            if m.form[1] == BOTH_WAYS:
                value = _filtered(m, value[::-1], step)[::-1]
        elif m.kind == "delay" and m.value != 0.0:
            grid = np.arange(value.size) * step
            value = np.interp(grid - m.value, grid, value)
        elif m.kind == "gain":
            value = value * m.value
        elif m.kind == "offset":
            value = value + m.value
    return value
