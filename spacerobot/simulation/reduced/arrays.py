"""A mechanism as flat arrays that the compiled integrator reads; built per parameter set, so kept cheap."""

from __future__ import annotations

import functools
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from spacerobot.effects.kernel import PARAMETERS, Kernel, compiled
from spacerobot.effects.laws import CONTACT, DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import NotFoundError

NONE = -1
NATIVE_SPRING, NATIVE_DAMPER, NATIVE_CONTACT = -2, -3, -4
"""Laws compiled into the integrator, because nearly every mechanism holds them; a listed law costs 0.1 us a call."""

_NATIVE = {SPRING: NATIVE_SPRING, DAMPER: NATIVE_DAMPER, CONTACT: NATIVE_CONTACT}


class System(NamedTuple):
    """The arrays. n coordinates, P ports, F forces, R frictions, U inputs.

    `rows` of the contact and slide ports are templates; their yaw entries depend on the state.
    """

    inverse_mass: np.ndarray  # (n,)
    rows: np.ndarray  # (P, n)
    geometry: np.ndarray  # (2,) contact point ahead, lateral [m]
    special: np.ndarray  # (4,) int: contact port, slide port, yaw coordinate, contact force index
    force_port: np.ndarray  # (F,) int
    force_sense: np.ndarray  # (F,) int
    force_aux: np.ndarray  # (F,) int: port whose rate is aux, or NONE
    force_law: np.ndarray  # (F,) int into the table of laws
    force_edge: np.ndarray  # (F,) int into the table of laws, or NONE
    parameters: np.ndarray  # (F, PARAMETERS)
    contact: np.ndarray  # (2,) hold [N], bilateral (0 or 1)
    friction_port: np.ndarray  # (R,) int
    friction_law: np.ndarray  # (R,) int
    friction_normal: np.ndarray  # (R,) int: 1 if pressed by the contact
    friction_parameters: np.ndarray  # (R, PARAMETERS)
    constant: np.ndarray  # (n,) generalised force of the fields
    input_port: np.ndarray  # (U,) int
    input_gain: np.ndarray  # (U,)
    impulse_time: np.ndarray  # (I,) sorted
    impulse: np.ndarray  # (I, n) generalised momentum


# Where the packed integers keep counts, special indices, and offsets of the float and integer blocks. Two plain
# arrays instead of twenty cut the cost of a compiled call to a quarter: Numba counts references per array.
N, PORTS, FORCES, FRICTIONS, INPUTS, KICKS, PRESS, SLIDE, YAW, CONTACT_FORCE = range(10)
MASS, ROWS, GEOMETRY, PARAMETER, FRICTION_PARAMETER, CONSTANT, GAIN, KICK_TIME, KICK = range(10, 19)
LINEAR = 19
PORT, SENSE, AUX, LAW, EDGE, FRICTION_PORT, FRICTION_LAW, FRICTION_NORMAL, INPUT_PORT = range(20, 29)
FORCE_ORDER, PORT_ORDER = 29, 30
D, V, BIAS, W_ROWS, TAU, RAW, FORCE, FRICTION, MATRIX, VECTOR, STUCK, WORK_SIZE = range(31, 43)
LIVE_FORCES, LIVE_PORTS = 43, 44
HEADER = 45


class Packed(NamedTuple):
    """The system as the compiled code takes it.

    GEOMETRY holds (ahead, lateral, hold, bilateral). LINEAR, shape (n, 2n), holds what linear springs and dampers at
    ports of constant rows do to the generalised forces; the forces and ports beyond them are the live ones, first in
    FORCE_ORDER and PORT_ORDER. The work array holds what the last evaluation found: D and V displacements and rates
    of the ports, TAU generalised forces, RAW what the laws say, FORCE what acts.
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
    ports, n = s.rows.shape
    f, r = s.force_port.size, s.friction_port.size
    linear, force_order, live_forces, port_order, live_ports = _folded(s)
    header = np.zeros(HEADER, dtype=np.int64)
    header[:PRESS] = n, ports, f, r, s.input_port.size, s.impulse_time.size
    header[PRESS:MASS] = s.special
    floats: list[np.ndarray] = [
        s.inverse_mass,
        s.rows.ravel(),
        np.concatenate([s.geometry, s.contact]),
        s.parameters.ravel(),
        s.friction_parameters.ravel(),
        s.constant,
        s.input_gain,
        s.impulse_time,
        s.impulse.ravel(),
        linear.ravel(),
    ]
    offset = 0
    for slot, block in zip(range(MASS, PORT), floats, strict=True):
        header[slot] = offset
        offset += block.size
    ints = [
        s.force_port,
        s.force_sense,
        s.force_aux,
        s.force_law,
        s.force_edge,
        s.friction_port,
        s.friction_law,
        s.friction_normal,
        s.input_port,
        force_order,
        port_order,
    ]
    offset = HEADER
    for slot, block in zip(range(PORT, D), ints, strict=True):
        header[slot] = offset
        offset += block.size
    offset = 0
    for slot, size in zip(range(D, WORK_SIZE), (ports, ports, ports, ports * n, n, f, f, r, r * r, r, r), strict=True):
        header[slot] = offset
        offset += size
    header[WORK_SIZE] = offset
    header[LIVE_FORCES], header[LIVE_PORTS] = live_forces, live_ports
    return Packed(np.concatenate(floats), np.concatenate([header, *ints]))


def _folded(s: System) -> tuple[np.ndarray, np.ndarray, int, np.ndarray, int]:
    """What linear forces do, as a matrix; and the order of forces and ports, those left to be evaluated first."""
    ports, n = s.rows.shape
    turning = {int(s.special[0]), int(s.special[1])}  # their rows depend on the state
    linear = np.zeros((n, 2 * n))
    live: list[int] = []
    needed = {*turning, *s.friction_port.tolist()} - {NONE}
    for j, (port, sensed, aux, law) in enumerate(
        zip(s.force_port.tolist(), s.force_sense.tolist(), s.force_aux.tolist(), s.force_law.tolist(), strict=True)
    ):
        if law in (NATIVE_SPRING, NATIVE_DAMPER) and port not in turning and sensed not in turning:
            first = 0 if law == NATIVE_SPRING else n
            linear[:, first : first + n] -= s.parameters[j, 0] * np.outer(s.rows[port], s.rows[sensed])
        else:
            live.append(j)
            needed |= {sensed} | ({aux} if aux >= 0 else set())
    folded = [j for j in range(s.force_port.size) if j not in live]
    rest = [p for p in range(ports) if p not in needed]
    forces, order = np.array(live + folded, dtype=np.int64), np.array([*needed, *rest], dtype=np.int64)
    return linear, forces, len(live), order, len(needed)


@dataclass(frozen=True)
class Layout:
    """Names behind the arrays: what index a coordinate, port, force or friction has."""

    coordinates: tuple[str, ...]
    ports: tuple[str, ...]
    forces: tuple[str, ...]
    frictions: tuple[str, ...]
    inputs: tuple[str, ...]

    def port(self, name: str) -> int:
        """Index of a port."""
        if name not in self.ports:
            raise NotFoundError("port", name, self.ports)
        return self.ports.index(name)


class LawTable:
    """Addresses of every compiled law seen so far, as one array, so that systems hold plain indices."""

    def __init__(self) -> None:
        self._index: dict[Any, int] = {}
        self._kept: list[Any] = []
        self._addresses = np.zeros(1, dtype=np.int64)
        self._lock = threading.Lock()

    def index(self, law: Any) -> int:
        """The law's place in `laws`, compiling it on first use."""
        found = self._index.get(law)
        if found is None:
            with self._lock:  # fits run in threads, and the table must not grow twice for one law
                found = self._index.get(law)
                if found is None:
                    self._kept.append(compiled(law))
                    self._addresses = np.array([k.address for k in self._kept], dtype=np.int64)
                    found = self._index[law] = len(self._kept) - 1
        return found

    @property
    def laws(self) -> np.ndarray:
        """The addresses, shape (at least 1,)."""
        return self._addresses


LAWS = LawTable()


@functools.lru_cache(maxsize=4096)
def _law_pair(kernel: Kernel) -> tuple[int, int]:
    native = _NATIVE.get(kernel)
    if native is not None:
        return native, NONE
    return LAWS.index(kernel.force), LAWS.index(kernel.edge) if kernel.has_edge else NONE


def assemble(mechanism: Mechanism) -> tuple[System, Layout]:
    """The arrays of a mechanism, and the names behind them.

    Raises:
        NotFoundError: an element names a port that is not there.
    """
    names = tuple(mechanism.coordinates)
    index = {name: i for i, name in enumerate(names)}
    mass = np.array([mechanism.coordinates[c].mass for c in names])
    contact = mechanism.contact
    ports = [*mechanism.ports]
    special = np.full(4, NONE, dtype=np.int64)
    if contact is not None:
        ports += ["contact", "contact.slide"]
        special[0], special[1] = len(ports) - 2, len(ports) - 1
        special[2] = index.get("target.yaw", NONE)
        special[3] = 0
    rows = np.zeros((len(ports), len(names)))
    for p, port in enumerate(mechanism.ports):
        for coordinate, coefficient in mechanism.ports[port].items():
            rows[p, index[coordinate]] = coefficient
    if contact is not None:
        rows[special[0], index["target"]] = 1.0
        rows[special[0], index["wrist"]] = -1.0
        if "target.y" in index:
            rows[special[1], index["target.y"]] = 1.0
    place = {port: i for i, port in enumerate(ports)}
    input_names = tuple(i.name for i in mechanism.inputs)

    laws: list[tuple[str, str, str, str | None, Kernel, tuple[float, ...]]] = []
    if contact is not None:
        laws.append((contact.name, "contact", "contact", None, contact.kernel, contact.p))
    laws += [(f.name, f.port, f.sense or f.port, f.aux, f.kernel, f.p) for f in mechanism.forces]
    count = len(laws)
    force_port, sense, aux, law, edge = (np.empty(count, dtype=np.int64) for _ in range(5))
    parameters = np.zeros((count, PARAMETERS))
    for i, (_, port, sensed, auxiliary, kernel, values) in enumerate(laws):
        force_port[i], sense[i] = place[port], place[sensed]
        aux[i] = NONE if auxiliary is None else place[auxiliary]
        law[i], edge[i] = _law_pair(kernel)
        parameters[i, : len(values)] = values

    constant = np.zeros(len(names))
    for item in mechanism.fields:
        constant[index[item.body]] += mechanism.coordinates[item.body].mass * item.acceleration
    kicks = sorted(mechanism.impulses, key=lambda k: k.time)
    friction_parameters = np.zeros((len(mechanism.frictions), PARAMETERS))
    for i, friction in enumerate(mechanism.frictions):
        friction_parameters[i, : len(friction.p)] = friction.p
    system = System(
        inverse_mass=1.0 / mass,
        rows=rows,
        geometry=np.array([contact.ahead, contact.lateral] if contact else [0.0, 0.0]),
        special=special,
        force_port=force_port,
        force_sense=sense,
        force_aux=aux,
        force_law=law,
        force_edge=edge,
        parameters=parameters,
        contact=np.array([contact.hold, float(contact.bilateral)] if contact else [0.0, 0.0]),
        friction_port=np.array([place[f.port] for f in mechanism.frictions], dtype=np.int64),
        friction_law=np.array([LAWS.index(f.level) for f in mechanism.frictions], dtype=np.int64),
        friction_normal=np.array([f.normal is not None for f in mechanism.frictions], dtype=np.int64),
        friction_parameters=friction_parameters,
        constant=constant,
        input_port=np.array([place[i.port] for i in mechanism.inputs], dtype=np.int64),
        input_gain=np.array([i.gain for i in mechanism.inputs], dtype=float),
        impulse_time=np.array([k.time for k in kicks], dtype=float),
        impulse=np.array([k.impulse * rows[place[k.port]] for k in kicks]).reshape(len(kicks), len(names)),
    )
    layout = Layout(
        names,
        tuple(ports),
        tuple(x[0] for x in laws),
        tuple(f.name for f in mechanism.frictions),
        input_names,
    )
    return system, layout


def initial_vector(layout: Layout, values: Mapping[str, float]) -> np.ndarray:
    """A vector over the coordinates, zero where `values` is silent, shape (n,).

    Raises:
        NotFoundError: a name that is no coordinate.
    """
    vector = np.zeros(len(layout.coordinates))
    for name, value in values.items():
        if name not in layout.coordinates:
            raise NotFoundError("coordinate", name, layout.coordinates)
        vector[layout.coordinates.index(name)] = value
    return vector
