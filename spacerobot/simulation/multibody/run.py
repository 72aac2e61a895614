"""Front door of the multibody backend: simulate a scene's mechanism, then read states, forces and momenta."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.events import Event
from spacerobot.simulation.multibody.assembly import Assembly, assemble_bodies
from spacerobot.simulation.multibody.balance import balanced
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.multibody.integrate import Integrator, Kick, Steps
from spacerobot.simulation.multibody.kernel import load
from spacerobot.simulation.multibody.stepper import interpolate
from spacerobot.simulation.reduced.arrays import FORCE, FRICTION, TAU
from spacerobot.simulation.reduced.forces import AT_REST, PRESSED, STICK
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError

MARGIN = 0.1
"""Error per step as a share of the tolerance, so that what a whole run gathers stays within it."""

ROUNDING = 4e-15
"""Least error per step that is asked of a configuration [m, rad]."""


@dataclass(frozen=True, eq=False)
class MultibodySample:
    """States and forces at given times. T times; n coordinates and P ports of the mechanism, F forces, R frictions.

    Attributes:
        time: shape (T,) [s].
        position, velocity, acceleration: of the mechanism's coordinates, shape (T, n).
        force, friction: along their ports, shapes (T, F) and (T, R).
        configuration, rates: Pinocchio's q and v of the assembly, shapes (T, nq) and (T, nv).
        features: displacements and rates from which ports are combined, shape (T, nf, 2).
        slider: displacement and rate of the wrist slider, shape (T, 2).
        contact: penetration, sliding sideways and upwards, each with its rate, shape (T, 6).
        generalized: generalised force of all elements, shape (T, nv).
        place: world position of hand, tip, base and target, shape (T, 4, 3).
        kinetic, potential: energy of motion, and of weight, shape (T,) [J].
        momentum: linear, and angular about the world's origin, of everything that moves, shape (T, 6).
        work: done by every force and friction since the start, shape (T, F + R) [J].
        modes: shape (T, 1 + F + R).
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray
    friction: np.ndarray
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
    modes: np.ndarray


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
        dyn, steps, model = self.dynamics, self.steps, self.assembly.model
        n, count = len(self.mechanism.coordinates), times.size
        shapes: dict[str, tuple[int, ...]] = {
            **dict.fromkeys(("position", "velocity", "acceleration"), (n,)),
            "force": (dyn.forces,),
            "friction": (dyn.frictions,),
            "configuration": (dyn.nq,),
            "rates": (dyn.nv,),
            "features": (len(dyn.features), 2),
            "slider": (2,),
            "contact": (6,),
            "generalized": (dyn.nv,),
            "place": (4, 3),
            "kinetic": (),
            "potential": (),
            "momentum": (6,),
            "work": (dyn.forces + dyn.frictions,),
            "modes": (dyn.modes.size,),
        }
        out = MultibodySample(time=times, **{k: np.empty((count, *shape)) for k, shape in shapes.items()})
        rate = np.empty(dyn.size)
        ints, w, slider = dyn.packed.ints, dyn.w, dyn.features.index("slider")
        touch, centre = dyn.contact_places(), np.empty((count, 3))
        with dyn.with_bias():
            for i, (t, step, y) in enumerate(self._placed(times)):
                dyn.modes[:] = out.modes[i] = steps.modes[step]
                dyn.heading[:] = steps.heading[step]
                dyn.rate(t, y, rate)
                value, row = dyn.scratch.value, dyn.scratch.row
                free = rate[dyn.nq : dyn.nq + dyn.nv]
                out.position[i] = dyn.coordinates @ value[:, 0]
                out.velocity[i] = dyn.coordinates @ value[:, 1]
                out.acceleration[i] = dyn.coordinates @ (row @ free + value[:, 2])
                out.features[i] = value[:, :2]
                out.slider[i] = value[slider, :2]
                out.force[i] = w[ints[FORCE] : ints[FORCE] + dyn.forces]
                out.friction[i] = w[ints[FRICTION] : ints[FRICTION] + dyn.frictions]
                out.generalized[i] = w[ints[TAU] : ints[TAU] + dyn.nv]
                for r in range(dyn.frictions):
                    if dyn.modes[1 + dyn.forces + r] == STICK:  # what holds is not in TAU yet
                        out.generalized[i] += out.friction[i, r] * dyn.port_row(self.mechanism.frictions[r].port)
                out.contact[i] = w[touch]
                out.configuration[i], out.rates[i] = dyn.q, dyn.v
                out.place[i] = dyn.scratch.place[1:]
                out.kinetic[i] = 0.5 * dyn.v @ dyn.inertia @ dyn.v
                out.potential[i] = pin.computePotentialEnergy(model, dyn.data, dyn.q)
                momentum = pin.computeCentroidalMomentum(model, dyn.data, dyn.q, dyn.v)
                out.momentum[i, :3], out.momentum[i, 3:] = momentum.linear, momentum.angular
                centre[i] = dyn.data.com[0]
                out.work[i] = y[dyn.nq + dyn.nv :]
        out.momentum[:, 3:] += np.cross(centre, out.momentum[:, :3])
        self._memo["last"] = out
        return out

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities at `times`, as `sample` gives them."""
        taken = self.sample(times)
        return taken.position, taken.velocity

    def positions(self, times: np.ndarray) -> np.ndarray:
        """Positions alone at `times`."""
        return self.sample(times).position

    def _placed(self, times: np.ndarray) -> Iterator[tuple[float, int, np.ndarray]]:
        """Each time with its step and the ambient state there, a work array."""
        steps, y = self.steps, np.empty(self.dynamics.size)
        index = np.clip(np.searchsorted(steps.time, times, side="right") - 1, 0, steps.time.size - 1)
        for t, step in zip(times.tolist(), index.tolist(), strict=True):
            length = steps.length[step]
            theta = min(max((t - steps.time[step]) / length, 0.0), 1.0) if length > 0.0 else 0.0
            interpolate(steps.state[step], steps.dense[step], theta, y)
            yield t, step, y

    def contact_at(self, times: np.ndarray) -> np.ndarray:
        """Contact force, positive in compression, at `times`, shape (T,) [N]."""
        dyn, out = self.dynamics, np.empty(len(times))
        for i, (t, step, y) in enumerate(self._placed(np.asarray(times, dtype=float))):
            dyn.modes[:] = self.steps.modes[step]
            out[i] = dyn.contact_force(t, y)
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
        at = self.assembly.model.joints[self.assembly.joints["slider"]].idx_q
        return np.array([y[at] for _, _, y in self._placed(np.asarray(times, dtype=float))])

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        """A port's displacement, rate or acceleration from the coordinates', shape (T,)."""
        names = list(self.mechanism.coordinates)
        total = np.zeros(states.shape[0])
        for coordinate, share in self.mechanism.ports[name].items():
            total += share * states[:, names.index(coordinate)]
        return total

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
    if mechanism.inputs:
        raise InputError("the multibody backend takes no recorded inputs", given=[i.name for i in mechanism.inputs])
    assembly = assemble_bodies(scene, mechanism)
    dynamics = Dynamics(assembly, balanced(scene, mechanism, assembly))
    scale, dynamics.slack = _scale(scene, dynamics, tolerance)
    dynamics.still = max(AT_REST, float(scale[dynamics.nq]))
    integrator = Integrator(dynamics, scale, first_step, min(max_step, end), fixed=fixed)
    y = np.zeros(dynamics.size)
    y[: dynamics.nq] = assembly.start
    y[dynamics.nq : dynamics.nq + dynamics.nv] = assembly.velocity
    load(y, dynamics.layout.joints, dynamics.q, dynamics.v)
    y[: dynamics.nq] = dynamics.q
    steps = integrator.run(y, 0.0, end)
    return MultibodyRun(
        dynamics.mechanism, assembly, steps, tuple(integrator.events), tuple(integrator.kicks), 0.0, end, dynamics
    )


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
    return scale, 1e-12 * scene.contact.stiffness * depth
