"""From a mechanism to the arrays; built per parameter set, so what its shape alone decides is made once."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from spacerobot.effects.kernel import PARAMETERS, Kernel
from spacerobot.effects.laws import CONTACT, DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory, at_rest
from spacerobot.simulation.reduced.arrays import (
    NATIVE_CONTACT,
    NATIVE_DAMPER,
    NATIVE_SPRING,
    NONE,
    YAW,
    Folding,
    Packed,
    System,
    folding,
    linear_part,
    packed_floats,
    packed_ints,
)
from spacerobot.simulation.reduced.law_table import LAWS
from spacerobot.support.errors import InputError, NotFoundError

_NATIVE = {SPRING: NATIVE_SPRING, DAMPER: NATIVE_DAMPER, CONTACT: NATIVE_CONTACT}


@dataclass(frozen=True)
class Layout:
    """Names behind the arrays: what index a coordinate, port, force, friction or state has."""

    coordinates: tuple[str, ...]
    ports: tuple[str, ...]
    forces: tuple[str, ...]
    frictions: tuple[str, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]

    def port(self, name: str) -> int:
        """Index of a port."""
        if name not in self.ports:
            raise NotFoundError("port", name, self.ports)
        return self.ports.index(name)


@functools.lru_cache(maxsize=4096)
def _laws(kernel: Kernel) -> tuple[int, int, int]:
    native = _NATIVE.get(kernel)
    if native is not None:
        return native, NONE, NONE
    edge = LAWS.index(kernel.edge) if kernel.has_edge else NONE
    return LAWS.index(kernel.force), edge, NONE if kernel.slope is None else LAWS.index(kernel.slope)


class _Law(NamedTuple):
    """A force without its numbers: which law reads which ports."""

    name: str
    port: str
    sense: str
    aux: str | None
    aside: str | None
    kernel: Kernel


class Shape(NamedTuple):
    """What a mechanism consists of, without the numbers that a fit changes."""

    coordinates: tuple[str, ...]
    ports: tuple[tuple[str, tuple[tuple[str, float], ...]], ...]
    contact: tuple[str, Kernel] | None
    forces: tuple[_Law, ...]
    frictions: tuple[tuple[str, str, Any, bool, bool], ...]  # name, port, law, pressed by the contact, steady
    states: tuple[tuple[str, str, Memory, bool, int], ...]  # name, port, law, pressed, how many parameters
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
        tuple(_Law(f.name, f.port, f.sense or f.port, f.aux, f.aside, f.kernel) for f in m.forces),
        tuple((f.name, f.port, f.level, f.normal is not None, f.steady) for f in m.frictions),
        tuple((s.name, s.port, s.law, s.normal is not None, len(s.p)) for s in m.states),
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
    laws = [*of.forces]
    if of.contact is not None:
        laws.insert(0, _Law(of.contact[0], "contact", "contact", None, None, of.contact[1]))
    found = [_laws(law.kernel) for law in laws]
    blank = System(
        inverse_mass=np.zeros(len(names)),
        rows=rows,
        geometry=np.zeros(2),
        special=special,
        force_port=np.array([place[law.port] for law in laws], dtype=np.int64),
        force_sense=np.array([place[law.sense] for law in laws], dtype=np.int64),
        force_aux=np.array([NONE if law.aux is None else place[law.aux] for law in laws], dtype=np.int64),
        force_aside=np.array([NONE if law.aside is None else place[law.aside] for law in laws], dtype=np.int64),
        force_law=np.array([law for law, _, _ in found], dtype=np.int64),
        force_edge=np.array([edge for _, edge, _ in found], dtype=np.int64),
        force_slope=np.array([slope for _, _, slope in found], dtype=np.int64),
        parameters=np.zeros((len(laws), PARAMETERS)),
        contact=np.zeros(2),
        friction_port=np.array([place[port] for _, port, *_ in of.frictions], dtype=np.int64),
        friction_law=np.array([LAWS.index(level) for _, _, level, _, _ in of.frictions], dtype=np.int64),
        friction_normal=np.array([normal for *_, normal, _ in of.frictions], dtype=np.int64),
        friction_steady=np.array([steady for *_, steady in of.frictions], dtype=np.int64),
        friction_mate=np.full(len(of.frictions), NONE, dtype=np.int64),
        friction_parameters=np.zeros((len(of.frictions), PARAMETERS)),
        state_port=np.array([place[port] for _, port, *_ in of.states], dtype=np.int64),
        state_rate=np.array([LAWS.index(law.rate, memory=True) for _, _, law, _, _ in of.states], dtype=np.int64),
        state_force=np.array([LAWS.index(law.force, memory=True) for _, _, law, _, _ in of.states], dtype=np.int64),
        state_normal=np.array([normal for *_, normal, _ in of.states], dtype=np.int64),
        state_linear=np.array([law.linear for _, _, law, _, _ in of.states], dtype=np.int64),
        state_first=np.cumsum([0, *(count for *_, count in of.states)][: len(of.states)], dtype=np.int64),
        state_parameters=np.zeros(sum(count for *_, count in of.states)),
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
        tuple(name for name, *_ in of.states),
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
        ints = made.ints[kicks] = packed_ints(system, made.order)
    return system, made.layout, Packed(packed_floats(system, linear_part(system, made.order)), ints)


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
    if mechanism.states:
        changed["state_parameters"] = np.array([value for s in mechanism.states for value in s.p], dtype=float)
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


def rested(mechanism: Mechanism, displacement: Callable[[str], float]) -> np.ndarray:
    """The states of laws with a memory at the start, given the displacements of their ports then, shape (S,)."""
    return np.array([at_rest(s.law, displacement(s.port), s.size, s.p) for s in mechanism.states])


def recorded(mechanism: Mechanism, inputs: tuple[np.ndarray, Mapping[str, np.ndarray]] | None) -> np.ndarray:
    """Times, then the recorded drive of each input of a mechanism, shape (1 + U, T).

    Raises:
        InputError: it has inputs that were not given, or their records do not fit.
    """
    names = [i.name for i in mechanism.inputs]
    if inputs is None:
        if names:
            raise InputError("the mechanism is driven by recorded inputs, which were not given", given=names)
        return np.zeros((1, 1))
    times, channels = inputs
    missing = [i.channel for i in mechanism.inputs if i.channel not in channels]
    if missing:
        raise InputError("recorded inputs without a record", given=missing, valid=", ".join(channels))
    rows = [np.asarray(times, dtype=float), *(np.asarray(channels[i.channel], dtype=float) for i in mechanism.inputs)]
    if len({r.shape for r in rows}) != 1 or rows[0].ndim != 1 or not rows[0].size:
        raise InputError("times and recorded inputs must be of one length", given=[r.shape for r in rows])
    return np.array(rows)


def head_on(system: System, y0: np.ndarray) -> bool:
    """Whether a target that could turn never will from this state, shape (2n + S,): it is hit in line with its centre.

    Then the contact's row stays what it is, and everything may be straight.
    """
    _, slide, yaw, _ = system.special
    if yaw == NONE or system.geometry[1] != 0.0 or y0[yaw] != 0.0 or y0[system.inverse_mass.size + yaw] != 0.0:
        return False
    acting = np.concatenate([system.force_port, system.friction_port, system.state_port, system.input_port])
    still = not system.rows[acting, yaw].any() and slide not in acting
    return bool(still and system.constant[yaw] == 0.0 and not system.impulse[:, yaw].any())


def unturning(packed: Packed) -> Packed:
    """The same system without its angle."""
    ints = packed.ints.copy()
    ints[YAW] = NONE
    return Packed(packed.floats, ints)
