"""Front door of the multibody backend: simulate a scene's mechanism, then read states, forces and momenta."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.events import Event
from spacerobot.simulation.multibody.assembly import Assembly, assemble_bodies
from spacerobot.simulation.multibody.balance import balanced
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.multibody.integrate import DONE, TOO_MANY_STEPS, VANISHED, Steps, integrate
from spacerobot.simulation.multibody.kernel import load
from spacerobot.simulation.multibody.machine import SLACK
from spacerobot.simulation.multibody.sample import displacements, pushes, read, widths
from spacerobot.simulation.reduced.arrays import REST
from spacerobot.simulation.reduced.assemble import recorded, rested
from spacerobot.simulation.reduced.forces import APART, AT_REST, PRESSED, RELEASED, STICK
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.unfinished import remedy, too_many
from spacerobot.support.errors import InputError, SimulationError

MARGIN = 0.1
"""Error per step as a share of the tolerance, so that what a whole run gathers stays within it."""

_CONTACT = {APART: "apart", PRESSED: "touch", RELEASED: "release"}

ROUNDING = 4e-15
"""Least error per step that is asked of a configuration [m, rad]."""


@dataclass(frozen=True, eq=False)
class MultibodySample:
    """States and forces at given times.

    T times; of the mechanism n coordinates, P ports, F forces, R frictions, S laws with a memory and U inputs.

    Attributes:
        time: shape (T,) [s].
        position, velocity, acceleration: of the mechanism's coordinates, shape (T, n).
        force, friction, remembered: along their ports, shapes (T, F), (T, R) and (T, S).
        configuration, rates: Pinocchio's q and v of the assembly, shapes (T, nq) and (T, nv).
        features: displacements and rates from which ports are combined, shape (T, nf, 2).
        slider: displacement and rate of the wrist slider, shape (T, 2).
        contact: penetration, sliding sideways and upwards, each with its rate, shape (T, 6).
        generalized: generalised force of all elements, shape (T, nv).
        place: world position of hand, tip, base and target, shape (T, 4, 3).
        kinetic, potential: energy of motion, and of weight, shape (T,) [J].
        momentum: linear, and angular about the world's origin, of everything that moves, shape (T, 6).
        work: done by every force, friction, law with a memory and input since the start, shape (T, F + R + S + U) [J].
        memory: what laws with a memory keep, shape (T, S).
        modes: shape (T, 1 + F + R + S).
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray
    friction: np.ndarray
    remembered: np.ndarray
    configuration: np.ndarray
    rates: np.ndarray
    features: np.ndarray
    slider: np.ndarray
    contact: np.ndarray
    generalized: np.ndarray
    place: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    momentum: np.ndarray
    work: np.ndarray
    memory: np.ndarray
    modes: np.ndarray


@dataclass(frozen=True)
class Kick:
    """A known impulse that happened: when, by whom, and the energy it brought [J]."""

    time: float
    name: str
    work: float


@dataclass(frozen=True, eq=False)
class MultibodyRun:
    """A finished integration.

    Attributes:
        mechanism: what was simulated, fields written as forces.
        assembly: the Pinocchio model and where everything sits in it.
        steps, events, kicks: the record.
        start, end: [s].
    """

    mechanism: Mechanism
    assembly: Assembly
    steps: Steps
    events: tuple[Event, ...]
    kicks: tuple[Kick, ...]
    start: float
    end: float
    dynamics: Dynamics = field(repr=False)
    _memo: dict[str, MultibodySample] = field(default_factory=dict, repr=False)

    @property
    def starts_pressed(self) -> bool:
        """Whether the contact carries force from the start."""
        return bool(self.steps.modes[0, 0] == PRESSED)

    def boundaries(self) -> np.ndarray:
        """Times of all step ends, shape (m + 1,) [s]."""
        return np.append(self.steps.time, self.end)

    def switches(self) -> np.ndarray:
        """Times at which a mode changes, ascending, shape (E,) [s]."""
        return np.array([event.time for event in self.events])

    def sample(self, times: np.ndarray) -> MultibodySample:
        """States at `times`, shape (T,); at an event's own time the side after it, outside the run the ends."""
        times = np.ascontiguousarray(times, dtype=float)
        last = self._memo.get("last")
        if last is not None and np.array_equal(last.time, times):
            return last
        dyn = self.dynamics
        nf = len(dyn.features)
        columns = widths(nf, dyn.nq, dyn.nv, dyn.forces, dyn.frictions, dyn.states, len(dyn.names.inputs))
        ends = np.cumsum(list(columns.values()))
        rows = np.empty((times.size, int(ends[-1])))
        read(dyn.machine, self.steps.rows, self._index(times), times, rows)
        parts = dict(zip(columns, np.split(rows, ends[:-1], axis=1), strict=True))
        features = parts["feature"].reshape(times.size, nf, 2)
        self._memo["last"] = out = MultibodySample(
            time=times,
            position=features[:, :, 0] @ dyn.coordinates.T,
            velocity=features[:, :, 1] @ dyn.coordinates.T,
            acceleration=parts["acceleration"] @ dyn.coordinates.T,
            force=parts["force"],
            friction=parts["friction"],
            remembered=parts["remembered"],
            configuration=parts["configuration"],
            rates=parts["rates"],
            features=features,
            slider=features[:, dyn.features.index("slider")],
            contact=parts["contact"],
            generalized=parts["generalized"],
            place=parts["place"].reshape(times.size, 4, 3),
            kinetic=parts["kinetic"][:, 0],
            potential=parts["potential"][:, 0],
            momentum=parts["momentum"],
            work=parts["work"],
            memory=parts["memory"],
            modes=parts["modes"].astype(np.int64),
        )
        return out

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities at `times`, as `sample` gives them."""
        taken = self.sample(times)
        return taken.position, taken.velocity

    def positions(self, times: np.ndarray) -> np.ndarray:
        """Positions alone at `times`."""
        return self.sample(times).position

    def accelerations(self, times: np.ndarray) -> np.ndarray:
        """Accelerations alone at `times`."""
        return self.sample(times).acceleration

    def _index(self, times: np.ndarray) -> np.ndarray:
        """The step of each time."""
        steps = self.steps
        return np.clip(np.searchsorted(steps.time, times, side="right") - 1, 0, steps.time.size - 1)

    def contact_at(self, times: np.ndarray) -> np.ndarray:
        """Contact force, positive in compression, at `times`, shape (T,) [N]."""
        times = np.ascontiguousarray(times, dtype=float)
        out = np.empty(times.size)
        pushes(self.dynamics.machine, self.steps.rows, self._index(times), times, out)
        return out

    @property
    def pieces(self) -> int:
        """Steps of order 8 resolve what happens in them to the tolerance; a quarter of one turns once at most."""
        return 4

    def pressed(self) -> np.ndarray:
        """Whether the contact carries force in each step, shape (m,)."""
        return np.asarray(self.steps.modes[:, 0] == PRESSED)

    def deflection_at(self, times: np.ndarray) -> np.ndarray:
        """Of the wrist, positive pushed in, at `times`, shape (T,) [m]."""
        times = np.ascontiguousarray(times, dtype=float)
        at, out = self.assembly.model.joints[self.assembly.joints["slider"]].idx_q, np.empty(times.size)
        displacements(self.steps.rows, self.dynamics.size, self._index(times), times, at, out)
        return out

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        """A port's displacement, rate or acceleration from the coordinates', shape (T,)."""
        names = list(self.mechanism.coordinates)
        total = np.zeros(states.shape[0])
        for coordinate, share in self.mechanism.ports[name].items():
            total += share * states[:, names.index(coordinate)]
        return total

    def ports(self, names: Sequence[str], states: np.ndarray) -> np.ndarray:
        """Several ports' displacements, rates or accelerations from the coordinates', shape (P, T)."""
        return np.array([self.port(name, states) for name in names])

    def port_values(self, name: str, taken: MultibodySample, order: int) -> np.ndarray:
        """Displacement (order 0) or rate (1) of a port as its elements see it, shape (T,)."""
        if name in ("contact", "contact.slide"):
            return taken.contact[:, order + (2 if name == "contact.slide" else 0)]
        row = self.dynamics.layout.ports[list(self.mechanism.ports).index(name)]
        return np.asarray(taken.features[:, :, order] @ row)

    def contact_force(self, taken: MultibodySample) -> np.ndarray:
        """Contact force, positive in compression, shape (T,) [N]."""
        return -taken.force[:, 0]


def integrate_scene(
    scene: Scene,
    end: float,
    *,
    mechanism: Mechanism | None = None,
    inputs: tuple[np.ndarray, Mapping[str, np.ndarray]] | None = None,
    tolerance: float = 1e-9,
    first_step: float = 1e-4,
    max_step: float = math.inf,
    fixed: bool = False,
) -> MultibodyRun:
    """Simulate a scene on the multibody backend from t = 0 to `end` [s].

    Args:
        scene: what there is.
        end: [s].
        mechanism: the scene's, or another edit of its baseline.
        inputs: times shape (T,) and recorded drives by channel, shape (T,) each, for the mechanism's inputs. A servo
            that follows a recorded reference is two of them at its joint: its stiffness times the reference, from
            where it stands, and its damping times the reference's rate.
        tolerance: relative to the approach speed, and to the penetration that it makes; 1e-12 to 1e-2.
        first_step, max_step: [s].
        fixed: take every step at `max_step`, whatever its error; for measuring the order.

    Raises:
        InputError: a time or tolerance that cannot be, or a coordinate that no body of the scene is.
        SimulationError: the integration could not be finished.
    """
    if not (np.isfinite(end) and end > 0.0):
        raise InputError("a simulation must end after it starts", given=end)
    if not 1e-13 <= tolerance <= 1e-1:
        raise InputError("tolerance out of range", given=tolerance, valid="1e-13 to 0.1")
    if not (first_step > 0.0 and max_step > 0.0):
        raise InputError("steps must be positive", given=(first_step, max_step))
    mechanism = mechanism or scene.mechanism("multibody")
    assembly = assemble_bodies(scene, mechanism)
    drives = recorded(mechanism, inputs)
    if not np.isfinite(drives).all() or (np.diff(drives[0]) <= 0.0).any():
        raise InputError("recorded inputs must be finite, at ascending times", given=[i.name for i in mechanism.inputs])
    dynamics = Dynamics(assembly, balanced(scene, mechanism, assembly), drives)
    scale, slack = _scale(scene, dynamics, tolerance)
    dynamics.settings[SLACK] = slack
    dynamics.w[dynamics.packed.ints[REST]] = max(AT_REST, float(scale[dynamics.nq]))
    y = np.zeros(dynamics.size)
    y[: dynamics.nq] = assembly.start
    y[dynamics.nq : dynamics.nq + dynamics.nv] = assembly.velocity
    load(y, dynamics.layout.joints, dynamics.q, dynamics.v)
    y[: dynamics.nq] = dynamics.q
    if dynamics.states:
        with dynamics.whole():
            dynamics.rate(0.0, y, np.empty_like(y))
        y[-dynamics.states :] = rested(dynamics.mechanism, dynamics.port_position)
    impulses = sorted((i for i in dynamics.mechanism.impulses if i.time >= 0.0), key=lambda i: i.time)
    kicks = np.array([(i.time, i.impulse) for i in impulses]).reshape(-1, 2)
    ports = np.array([dynamics.names.port(i.port) for i in impulses], dtype=np.int64)
    longest = min(max_step, end)
    clock = np.array([0.0, min(first_step, longest), end, longest, float(fixed)])
    record = integrate(dynamics.machine, y, scale, clock, kicks, ports)
    if record.status != DONE:
        advice = remedy(dynamics.mechanism, dynamics.give)
        if record.status == VANISHED:
            raise SimulationError(f"multibody model: the step vanished at t = {record.reached:.6g} s: {advice}")
        what = "steps" if record.status == TOO_MANY_STEPS else "events"
        raise too_many("multibody", what, record.reached, end, advice)
    return MultibodyRun(
        mechanism=dynamics.mechanism,
        assembly=assembly,
        steps=record.steps,
        events=tuple(_event(dynamics, *row) for row in record.events.tolist()),
        kicks=tuple(Kick(i.time, i.name, work) for i, work in zip(impulses, record.kicks.tolist(), strict=False)),
        start=0.0,
        end=end,
        dynamics=dynamics,
    )


def _event(dynamics: Dynamics, t: float, index: float, mode: float) -> Event:
    """An event by the names of what switched."""
    i = int(index)
    if i == 0:
        return Event(t, "contact", _CONTACT[int(mode)])
    if i <= dynamics.forces:
        return Event(t, dynamics.names.forces[i - 1], "edge")
    i -= 1 + dynamics.forces
    if i < dynamics.frictions:
        return Event(t, dynamics.names.frictions[i], "stick" if mode == STICK else "slip")
    return Event(t, dynamics.names.states[i - dynamics.frictions], "turn")


def _scale(scene: Scene, dynamics: Dynamics, tolerance: float) -> tuple[np.ndarray, float]:
    """Error per step that is tolerated in every state, and the force that is rounding.

    All of it is measured by the approach: its speed v, the penetration v/omega it makes, its energy; so a contact
    a meter from the origin is resolved as well as one at it.
    """
    speed = max(scene.touching_speed, 1e-3)
    light = 1.0 / (1.0 / scene.wrist.mass + 1.0 / scene.target.mass)
    depth = speed * math.sqrt(light / scene.contact.stiffness)
    share = MARGIN * tolerance
    scale = np.empty(dynamics.size)
    nq, nv = dynamics.nq, dynamics.nv
    scale[:nq] = max(share * depth, ROUNDING)
    scale[nq : nq + nv] = max(share * speed, 1e-16)
    scale[nq + nv :] = max(share * 0.5 * scene.target.mass * speed**2, 1e-18)
    scale[dynamics.size - dynamics.states :] = [share * s.size for s in dynamics.mechanism.states]
    return scale, 1e-12 * scene.contact.stiffness * depth
