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
    order = folding(s)
    return Packed(_floats(s, _linear(s, order)), _ints(s, order))


def _floats(s: System, linear: np.ndarray) -> np.ndarray:
    return np.concatenate(
        [
            s.inverse_mass,
            s.rows.ravel(),
            s.geometry,
            s.contact,
            s.parameters.ravel(),
            s.friction_parameters.ravel(),
            s.constant,
            s.input_gain,
            s.impulse_time,
            s.impulse.ravel(),
            linear.ravel(),
        ]
    )


def _ints(s: System, order: Folding) -> np.ndarray:
    ports, n = s.rows.shape
    f, r, kicks = s.force_port.size, s.friction_port.size, s.impulse_time.size
    header = np.zeros(HEADER, dtype=np.int64)
    header[:PRESS] = n, ports, f, r, s.input_port.size, kicks
    header[PRESS:MASS] = s.special
    sizes = (n, ports * n, 4, s.parameters.size, s.friction_parameters.size, n, s.input_gain.size, kicks, kicks * n)
    offset = 0
    for slot, size in zip(range(MASS, PORT), (*sizes, 2 * n * n), strict=True):
        header[slot] = offset
        offset += size
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
        order.forces,
        order.ports,
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
    needed = {*turning, *s.friction_port.tolist()} - {NONE}
    for j, (port, sensed, aux, law) in enumerate(
        zip(s.force_port.tolist(), s.force_sense.tolist(), s.force_aux.tolist(), s.force_law.tolist(), strict=True)
    ):
        if law in (NATIVE_SPRING, NATIVE_DAMPER) and port not in turning and sensed not in turning:
            first = 0 if law == NATIVE_SPRING else n
            unit = np.zeros((n, 2 * n))
            unit[:, first : first + n] = -np.outer(s.rows[port], s.rows[sensed])
            units.append(unit.ravel())
            folded.append(j)
        else:
            live.append(j)
            needed |= {sensed} | ({aux} if aux >= 0 else set())
    rest = [p for p in range(ports) if p not in needed]
    return Folding(
        np.array(live + folded, dtype=np.int64),
        len(live),
        np.array([*needed, *rest], dtype=np.int64),
        len(needed),
        np.array(units).reshape(len(folded), 2 * n * n),
    )


def _linear(s: System, order: Folding) -> np.ndarray:
    """What the folded forces do to the generalised forces, shape (2 n n,)."""
    return np.asarray(s.parameters[order.forces[order.live_forces :], 0] @ order.unit)


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


class Shape(NamedTuple):
    """What a mechanism consists of, without the numbers that a fit changes."""

    coordinates: tuple[str, ...]
    ports: tuple[tuple[str, tuple[tuple[str, float], ...]], ...]
    contact: tuple[str, Kernel] | None
    forces: tuple[tuple[str, str, str, str | None, Kernel], ...]  # name, port, sensed port, aux port, law
    frictions: tuple[tuple[str, str, Any, bool], ...]  # name, port, law, pressed by the contact
    inputs: tuple[tuple[str, str], ...]  # name, port


@dataclass(frozen=True, eq=False)
class Template:
    """The arrays of a shape that no number changes, and the places of its names."""

    layout: Layout
    place: Mapping[str, int]
    index: Mapping[str, int]
    blank: System
    order: Folding
    ints: dict[int, np.ndarray]  # packed integers by number of impulses


def shape(m: Mechanism) -> Shape:
    """The shape of a mechanism."""
    return Shape(
        tuple(m.coordinates),
        tuple((port, tuple(row.items())) for port, row in m.ports.items()),
        None if m.contact is None else (m.contact.name, m.contact.kernel),
        tuple((f.name, f.port, f.sense or f.port, f.aux, f.kernel) for f in m.forces),
        tuple((f.name, f.port, f.level, f.normal is not None) for f in m.frictions),
        tuple((i.name, i.port) for i in m.inputs),
    )


@functools.lru_cache(maxsize=512)
def template(of: Shape) -> Template:
    """The fixed arrays of a shape; fits ask for the same few thousands of times."""
    names = of.coordinates
    index = {name: i for i, name in enumerate(names)}
    ports = [port for port, _ in of.ports]
    special = np.full(4, NONE, dtype=np.int64)
    if of.contact is not None:
        ports += ["contact", "contact.slide"]
        special[:] = len(ports) - 2, len(ports) - 1, index.get("target.yaw", NONE), 0
    rows = np.zeros((len(ports), len(names)))
    for p, (_, row) in enumerate(of.ports):
        for coordinate, coefficient in row:
            rows[p, index[coordinate]] = coefficient
    if of.contact is not None:
        rows[special[0], index["target"]] = 1.0
        rows[special[0], index["wrist"]] = -1.0
        if "target.y" in index:
            rows[special[1], index["target.y"]] = 1.0
    place = {port: i for i, port in enumerate(ports)}
    laws: list[tuple[str, str, str, str | None, Kernel]] = [*of.forces]
    if of.contact is not None:
        laws.insert(0, (of.contact[0], "contact", "contact", None, of.contact[1]))
    pairs = [_law_pair(kernel) for *_, kernel in laws]
    blank = System(
        inverse_mass=np.zeros(len(names)),
        rows=rows,
        geometry=np.zeros(2),
        special=special,
        force_port=np.array([place[port] for _, port, *_ in laws], dtype=np.int64),
        force_sense=np.array([place[sensed] for _, _, sensed, *_ in laws], dtype=np.int64),
        force_aux=np.array([NONE if aux is None else place[aux] for *_, aux, _ in laws], dtype=np.int64),
        force_law=np.array([law for law, _ in pairs], dtype=np.int64),
        force_edge=np.array([edge for _, edge in pairs], dtype=np.int64),
        parameters=np.zeros((len(laws), PARAMETERS)),
        contact=np.zeros(2),
        friction_port=np.array([place[port] for _, port, *_ in of.frictions], dtype=np.int64),
        friction_law=np.array([LAWS.index(level) for *_, level, _ in of.frictions], dtype=np.int64),
        friction_normal=np.array([normal for *_, normal in of.frictions], dtype=np.int64),
        friction_parameters=np.zeros((len(of.frictions), PARAMETERS)),
        constant=np.zeros(len(names)),
        input_port=np.array([place[port] for _, port in of.inputs], dtype=np.int64),
        input_gain=np.zeros(len(of.inputs)),
        impulse_time=np.zeros(0),
        impulse=np.zeros((0, len(names))),
    )
    layout = Layout(
        names,
        tuple(ports),
        tuple(name for name, *_ in laws),
        tuple(name for name, *_ in of.frictions),
        tuple(name for name, _ in of.inputs),
    )
    return Template(layout, place, index, blank, folding(blank), {})


def assemble(mechanism: Mechanism) -> tuple[System, Layout]:
    """The arrays of a mechanism, and the names behind them.

    Raises:
        NotFoundError: an element names a port that is not there.
    """
    made = template(shape(mechanism))
    return _numbered(mechanism, made), made.layout


def assemble_packed(mechanism: Mechanism) -> tuple[System, Layout, Packed]:
    """`assemble` and `pack` at once; what the shape alone decides is looked up."""
    made = template(shape(mechanism))
    system = _numbered(mechanism, made)
    kicks = system.impulse_time.size
    ints = made.ints.get(kicks)
    if ints is None:
        ints = made.ints[kicks] = _ints(system, made.order)
    return system, made.layout, Packed(_floats(system, _linear(system, made.order)), ints)


def _numbered(mechanism: Mechanism, made: Template) -> System:
    contact, blank = mechanism.contact, made.blank
    parameters = np.zeros_like(blank.parameters)
    row = 0
    if contact is not None:
        parameters[0, : len(contact.p)] = contact.p
        row = 1
    for force in mechanism.forces:
        parameters[row, : len(force.p)] = force.p
        row += 1
    friction_parameters = np.zeros_like(blank.friction_parameters)
    for i, friction in enumerate(mechanism.frictions):
        friction_parameters[i, : len(friction.p)] = friction.p
    constant = np.zeros(len(made.index))
    for item in mechanism.fields:
        constant[made.index[item.body]] += mechanism.coordinates[item.body].mass * item.acceleration
    changed: dict[str, np.ndarray] = {}
    if mechanism.impulses:
        kicks = sorted(mechanism.impulses, key=lambda k: k.time)
        changed["impulse_time"] = np.array([k.time for k in kicks], dtype=float)
        changed["impulse"] = np.array([k.impulse * blank.rows[made.place[k.port]] for k in kicks])
    if mechanism.inputs:
        changed["input_gain"] = np.array([i.gain for i in mechanism.inputs], dtype=float)
    if contact is not None:
        changed["geometry"] = np.array([contact.ahead, contact.lateral])
        changed["contact"] = np.array([contact.hold, float(contact.bilateral)])
    return blank._replace(
        inverse_mass=1.0 / np.array([c.mass for c in mechanism.coordinates.values()]),
        parameters=parameters,
        friction_parameters=friction_parameters,
        constant=constant,
        **changed,
    )


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
