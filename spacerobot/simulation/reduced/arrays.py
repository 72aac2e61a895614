"""A mechanism as flat arrays, two of them, which the compiled integrator reads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

NONE = -1
FOLLOWS = -2
"""In place of a mate: the friction across this one's direction speaks for both."""
NATIVE_SPRING, NATIVE_DAMPER, NATIVE_CONTACT = -2, -3, -4
"""Laws compiled into the integrator, because nearly every mechanism holds them; a listed law costs 0.1 us a call."""


class System(NamedTuple):
    """The arrays. n coordinates, P ports, F forces, R frictions, S states, U inputs.

    `rows` of the contact and slide ports are templates; their yaw entries depend on the state.
    """

    inverse_mass: np.ndarray  # (n,)
    rows: np.ndarray  # (P, n)
    geometry: np.ndarray  # (2,) contact point ahead, lateral [m]
    special: np.ndarray  # (4,) int: contact port, slide port, yaw coordinate, contact force index
    force_port: np.ndarray  # (F,) int
    force_sense: np.ndarray  # (F,) int
    force_aux: np.ndarray  # (F,) int: port whose rate is aux, or NONE
    force_aside: np.ndarray  # (F,) int: a second port across, or NONE
    force_law: np.ndarray  # (F,) int into the table of laws
    force_edge: np.ndarray  # (F,) int into the table of laws, or NONE
    force_slope: np.ndarray  # (F,) int into the table of laws, or NONE
    parameters: np.ndarray  # (F, PARAMETERS)
    contact: np.ndarray  # (2,) hold [N], bilateral (0 or 1)
    friction_port: np.ndarray  # (R,) int
    friction_law: np.ndarray  # (R,) int
    friction_normal: np.ndarray  # (R,) int: 1 if pressed by the contact
    friction_steady: np.ndarray  # (R,) int: 1 if its level does not change while it slides one way
    friction_mate: np.ndarray  # (R,) int: the friction across it that shares its limit (a disc), NONE or FOLLOWS
    friction_parameters: np.ndarray  # (R, PARAMETERS)
    state_port: np.ndarray  # (S,) int
    state_rate: np.ndarray  # (S,) int into the table of laws
    state_force: np.ndarray  # (S,) int into the table of laws
    state_normal: np.ndarray  # (S,) int: 1 if pressed by the contact
    state_linear: np.ndarray  # (S,) int: 1 if its laws are linear
    state_first: np.ndarray  # (S,) int into the parameters
    state_parameters: np.ndarray  # of all, one after the other
    constant: np.ndarray  # (n,) generalised force of the fields
    input_port: np.ndarray  # (U,) int
    input_gain: np.ndarray  # (U,)
    impulse_time: np.ndarray  # (I,) sorted
    impulse: np.ndarray  # (I, n) generalised momentum


# Where the packed integers keep counts, special indices, and offsets of the float and integer blocks. Two plain
# arrays instead of twenty cut the cost of a compiled call to a quarter: Numba counts references per array.
N, PORTS, FORCES, FRICTIONS, STATES, INPUTS, KICKS, PRESS, SLIDE, YAW, CONTACT_FORCE = range(11)
MASS, ROWS, GEOMETRY, PARAMETER, FRICTION_PARAMETER, STATE_PARAMETER, CONSTANT, GAIN, KICK_TIME, KICK = range(11, 21)
LINEAR = 21
PORT, SENSE, AUX, ASIDE, LAW, EDGE, SLOPE, FRICTION_PORT, FRICTION_LAW, FRICTION_NORMAL = range(22, 32)
FRICTION_STEADY, FRICTION_MATE, STATE_PORT, STATE_RATE, STATE_FORCE, STATE_NORMAL, STATE_LINEAR = range(32, 39)
STATE_FIRST, INPUT_PORT, FORCE_ORDER, PORT_ORDER = range(39, 43)
D, V, BIAS, W_ROWS, TAU, RAW, FORCE, FRICTION, HEADING, MATRIX, VECTOR, STUCK = range(43, 55)
Z, Z_RATE, REMEMBERED, REST, WORK_SIZE = range(55, 60)
LIVE_FORCES, LIVE_PORTS = 60, 61
HEADER = 62


class Packed(NamedTuple):
    """The system as the compiled code takes it.

    GEOMETRY holds (ahead, lateral, hold, bilateral). LINEAR, shape (n, 2n), holds what linear springs and dampers at
    ports of constant rows do to the generalised forces; the forces and ports beyond them are the live ones, first in
    FORCE_ORDER and PORT_ORDER. The work array holds what the last evaluation found: D and V displacements and rates
    of the ports, TAU generalised forces, RAW what the laws say, FORCE what acts; HEADING, which the caller keeps, the
    direction in which each disc of friction slid at the start of the step; Z states, Z_RATE their rates, REMEMBERED
    their forces; REST, which the caller sets, the speed below which a port is as good as at rest.
    """

    floats: np.ndarray
    ints: np.ndarray

    def work(self) -> np.ndarray:
        """A fresh work array."""
        w = np.zeros(self.ints[WORK_SIZE])
        n, ports = self.ints[N], self.ints[PORTS]
        w[self.ints[W_ROWS] : self.ints[W_ROWS] + n * ports] = self.floats[
            self.ints[ROWS] : self.ints[ROWS] + n * ports
        ]
        return w


def pack(s: System) -> Packed:
    """The two arrays that hold a system."""
    order = folding(s)
    return Packed(packed_floats(s, linear_part(s, order)), packed_ints(s, order))


def packed_floats(s: System, linear: np.ndarray) -> np.ndarray:
    """All numbers in one array; `linear` of `linear_part`."""
    return np.concatenate(
        [
            s.inverse_mass,
            s.rows.ravel(),
            s.geometry,
            s.contact,
            s.parameters.ravel(),
            s.friction_parameters.ravel(),
            s.state_parameters,
            s.constant,
            s.input_gain,
            s.impulse_time,
            s.impulse.ravel(),
            linear.ravel(),
        ]
    )


def packed_ints(s: System, order: Folding) -> np.ndarray:
    """Counts, indices and offsets in one array; `order` of `folding`."""
    ports, n = s.rows.shape
    f, r, z, kicks = s.force_port.size, s.friction_port.size, s.state_port.size, s.impulse_time.size
    header = np.zeros(HEADER, dtype=np.int64)
    header[:PRESS] = n, ports, f, r, z, s.input_port.size, kicks
    header[PRESS:MASS] = s.special
    laws = (s.parameters.size, s.friction_parameters.size, s.state_parameters.size)
    blocks = (n, ports * n, 4, *laws, n, s.input_gain.size, kicks, kicks * n, 2 * n * n)
    offset = 0
    for slot, size in zip(range(MASS, PORT), blocks, strict=True):
        header[slot] = offset
        offset += size
    ints = [
        s.force_port,
        s.force_sense,
        s.force_aux,
        s.force_aside,
        s.force_law,
        s.force_edge,
        s.force_slope,
        s.friction_port,
        s.friction_law,
        s.friction_normal,
        s.friction_steady,
        s.friction_mate,
        s.state_port,
        s.state_rate,
        s.state_force,
        s.state_normal,
        s.state_linear,
        s.state_first,
        s.input_port,
        order.forces,
        order.ports,
    ]
    offset = HEADER
    for slot, block in zip(range(PORT, D), ints, strict=True):
        header[slot] = offset
        offset += block.size
    offset = 0
    work = (ports, ports, ports, ports * n, n, f, f, r, r, r * r, r, r, z, z, z, 1)
    for slot, size in zip(range(D, WORK_SIZE), work, strict=True):
        header[slot] = offset
        offset += size
    header[WORK_SIZE] = offset
    header[LIVE_FORCES], header[LIVE_PORTS] = order.live_forces, order.live_ports
    return np.concatenate([header, *ints])


class Folding(NamedTuple):
    """Which forces act through the matrix, and what a unit of each does; what is left to be evaluated comes first."""

    forces: np.ndarray  # (F,) int, live ones first
    live_forces: int
    ports: np.ndarray  # (P,) int, live ones first
    live_ports: int
    unit: np.ndarray  # (F - live, 2 n n) of the folded forces


def folding(s: System) -> Folding:
    """What of a system can be a matrix; the same for all its parameters."""
    ports, n = s.rows.shape
    turning = {int(s.special[0]), int(s.special[1])}  # their rows depend on the state
    units: list[np.ndarray] = []
    live: list[int] = []
    folded: list[int] = []
    needed = {*turning, *s.friction_port.tolist(), *s.state_port.tolist()} - {NONE}
    read = (s.force_port, s.force_sense, s.force_aux, s.force_aside, s.force_law)
    for j, (port, sensed, aux, aside, law) in enumerate(zip(*(some.tolist() for some in read), strict=True)):
        if law in (NATIVE_SPRING, NATIVE_DAMPER) and port not in turning and sensed not in turning:
            first = 0 if law == NATIVE_SPRING else n
            unit = np.zeros((n, 2 * n))
            unit[:, first : first + n] = -np.outer(s.rows[port], s.rows[sensed])
            units.append(unit.ravel())
            folded.append(j)
        else:
            live.append(j)
            needed |= {p for p in (sensed, aux, aside) if p >= 0}
    rest = [p for p in range(ports) if p not in needed]
    return Folding(
        np.array(live + folded, dtype=np.int64),
        len(live),
        np.array([*needed, *rest], dtype=np.int64),
        len(needed),
        np.array(units).reshape(len(folded), 2 * n * n),
    )


def linear_part(s: System, order: Folding) -> np.ndarray:
    """What the folded forces do to the generalised forces, shape (2 n n,)."""
    return np.asarray(s.parameters[order.forces[order.live_forces :], 0] @ order.unit)
