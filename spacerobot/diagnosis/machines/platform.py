"""A platform that floats in the plane while its arm follows a known motion: momentum says how the base must move.

The common centre of mass moves under outer forces alone, and so does the angular momentum about it:

    m c'' = F,    J_c theta' + h_c = L,    L' = torque of F about c,

with J_c the inertia of the whole about c, and h_c the angular momentum of the arm's motion as seen from the base
(Umetani and Yoshida 1989, IEEE Trans. Robot. Autom. 5, Eqs. 8 and 9, for linear and angular momentum in the plane).
Nothing is integrated but the base's own turn and the outer forces, which are evaluated along the measured track.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.contract import FIRST_NOISE, Machine, Nuisance, Predicted, conditions_of
from spacerobot.diagnosis.machines.doubted import BAR, doubted
from spacerobot.diagnosis.machines.links import robot_of, twice_as_heavy, weighed_links
from spacerobot.diagnosis.machines.measured import port_forces, through_sensor
from spacerobot.diagnosis.machines.readings_noise import readings_noise
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.machines.windows import cut, local
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.dynamics.floating_base import floating_configuration
from spacerobot.effects.effect import Effect
from spacerobot.effects.learned import Variable
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across
from spacerobot.effects.primitives import ChannelMap, Coordinate, Load, Readout
from spacerobot.effects.sizes import Sizes
from spacerobot.model.robot import Robot
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.recordings.values import yawing

TRACK = {"base": "base.position.x", "base.y": "base.position.y", "base.yaw": "base.yaw"}
"""Coordinate -> the channel that shows it."""

ARM = "arm_motion"
"""What the sensors' effects call the arm's known motion: joints that follow late, or by another amount."""

STEP = 0.05
"""Grid of the momentum balance [s]."""

SMOOTH = 1.0
"""Span [s] of a measured track from which its rate in the middle is read."""

EARLY = 1.0
"""Readings within this time [s] tell how a trial starts."""

VALUES = ("platform.mass", "platform.yaw_inertia")


@dataclass(frozen=True, eq=False)
class Shape:
    """What the arm's motion makes of the whole, in the base's frame, on a grid. T times."""

    mass: float  # kg, of all
    moment: np.ndarray  # (2, T) kg m, sum of mass times place
    rate: np.ndarray  # (2, T) kg m/s, its rate seen from the base
    inertia: np.ndarray  # (T,) kg m^2 about the base's origin
    spin: np.ndarray  # (T,) N m s about the base's origin, of the arm's motion seen from the base

    def plus(self, other: Shape, times: float) -> Shape:
        """The whole with another body's share in it, so many times over; all of it is linear in the masses."""
        return Shape(
            self.mass + times * other.mass,
            self.moment + times * other.moment,
            self.rate + times * other.rate,
            self.inertia + times * other.inertia,
            self.spin + times * other.spin,
        )


class Platform(Machine):
    """The track of a floating base, from its arm's known motion."""

    metric = "motion of the base"

    def __init__(self, study: Study, trials: Sequence[Trial], drives: Mapping[str, str]) -> None:
        """From trials without thrust; `drives` says which channel each joint follows."""
        self.name = "base"
        self.study, self.drives = study, dict(drives)
        self.given = frozenset(self.drives.values()) | {s.name for t in trials for s in _thrust(study.recording(t))}
        self.robot: Robot = robot_of(study, floating=True)
        own = self.robot.model.inertias[1]
        believed = yawing(study.values(), "platform")
        self.base = {"platform.mass": own.mass, "platform.yaw_inertia": float(own.inertia[2, 2]), **believed}
        self._link_mass = weighed_links(self.robot, (*study.sigma, *sorted(study.baseline.unknown)), self.drives)
        self._twice = {n: r.model for n, r in twice_as_heavy(self.robot, self._link_mass).items()}
        self._bodies = BodyColumns(self.robot, Rigid(self.robot, study.baseline.gravity, list(self.drives)))
        self._links = self._bodies.ends(self.drives, self.drives)
        self.base |= {f"link.{n}.mass": m for n, m in self._link_mass.items()}
        self._grid: dict[str, np.ndarray] = {}
        self._joints: dict[str, np.ndarray] = {}
        self._shape: dict[tuple[object, ...], tuple[Shape, dict[str, Shape], np.ndarray]] = {}
        self._loads: dict[tuple[object, ...], Shape] = {}
        self._arms: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
        self._seen: dict[str, tuple[dict[str, np.ndarray], dict[str, np.ndarray]]] = {}
        self.doubted = doubted(study, trials, {*TRACK.values(), *self.drives.values()})
        self._raw = {t.id: {c: study.recording(t)[c].good() for c in TRACK.values()} for t in trials}
        self.sizes = self._sizes()
        self._whole = tuple(self._trial(t) for t in trials)
        self.trials = self._whole
        fitted = (*VALUES, *(f"link.{n}.mass" for n in self._link_mass))
        sigma = {n: s for n, s in {**study.sigma, **yawing(study.sigma, "platform")}.items() if n in fitted}
        unknown = {n: self.base[n] for n in fitted if n in study.baseline.unknown}
        zeros = self.doubted.sigma
        self.believed = Believed(self.base, sigma, {}, conditions_of(self.trials), unknown, zeros=zeros)
        self.stated = frozenset(c for c in TRACK.values() if all(study.recording(t)[c].sigma_stated for t in trials))

    def _sizes(self) -> Mapping[str, Sizes]:
        out = {}
        for coordinate, channel in TRACK.items():
            pairs = [raw[channel] for raw in self._raw.values()]
            place = np.concatenate([v for _, v in pairs])
            rate = np.concatenate([np.gradient(v, t) for t, v in pairs])
            inertia = self.base[VALUES[coordinate == "base.yaw"]]
            force = np.array([inertia * np.var(rate) / max(float(np.std(place)), 1e-12)])
            out[coordinate] = sizes_of(force, place, rate)
        return out | {"": max(out.values(), key=lambda s: s.length)}

    def _trial(self, trial: Trial) -> TrialData:
        recording, blocks = self.study.recording(trial), []
        for coordinate, channel in TRACK.items():
            series = recording[channel]
            time, value = series.good()
            noise = series.sigma if series.sigma_stated else FIRST_NOISE * self.sizes[coordinate].length
            blocks.append(Block(series.stream, (channel,), time, value[None], np.full((1, time.size), 1.0 / noise)))
        start, end = float(min(b.time[0] for b in blocks)), float(max(b.time[-1] for b in blocks))
        self._arms[trial.id] = [recording[c].good() for c in self.drives.values()]
        return self._gridded(TrialData(trial.id, self.study.condition(trial), {}, tuple(blocks), start, end))

    def _gridded(self, trial: TrialData) -> TrialData:
        """A trial, or a stretch of one, with its grid, its arm's motion and its base's track on that."""
        self._grid[trial.id] = grid = np.arange(trial.start, trial.end + STEP, STEP)
        self._joints[trial.id] = np.array([_follow(grid, t, v) for t, v in self._arms[trial.recorded]])
        self._raw[trial.id] = {c: trial.channel(c)[:2] for c in TRACK.values()}
        places = {n: np.interp(grid, *self._raw[trial.id][c]) for n, c in TRACK.items()}
        self._seen[trial.id] = places, {n: _rate(p) for n, p in places.items()}
        return trial

    def cut_at(self, moments: Mapping[str, Sequence[Moment]]) -> Platform:
        """Each stretch between these moments is a trial of its own."""
        other = copy(self)
        pieces = [w for t in self._whole for w in cut(t, np.inf, moments.get(t.id, ()))]
        other.trials = tuple(w if w.id == w.recorded else self._gridded(w) for w in pieces)
        return other

    def impulse(self, mechanism: Mechanism, trial: TrialData, rates: Mapping[str, float]) -> dict[str, float]:
        """On the whole, which moves with its base: at the base's origin, and about the common centre of mass."""
        shape, yaw = self._shaped(trial, mechanism), self._seen[trial.id][0]["base.yaw"][-1]
        ahead, left = shape.moment[:, -1] / shape.mass
        offset = np.array([np.cos(yaw) * ahead - np.sin(yaw) * left, np.sin(yaw) * ahead + np.cos(yaw) * left])
        spin = rates.get("base.yaw", 0.0)
        pushed = shape.mass * np.array(
            [rates.get("base", 0.0) - spin * offset[1], rates.get("base.y", 0.0) + spin * offset[0]]
        )
        about_centre = (shape.inertia[-1] - shape.mass * float(offset @ offset)) * spin
        # the push acts at the base, and its moment about the common centre is part of what turns the whole
        turned = about_centre + float(offset[0] * pushed[1] - offset[1] * pushed[0])
        return {n: v for n, v in zip(TRACK, (*pushed.tolist(), turned), strict=True) if n in rates}

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """As everywhere, less what nothing tells apart: a payload is the platform's mass."""
        return [s for s in super().sites(effects) if "mass" not in s.effect.same_as]

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """The platform's three coordinates, its sensor, and the arm's motion as something that is read."""
        mass, inertia = (values[n] for n in VALUES)
        coordinates = {
            "base": Coordinate("base", mass),
            "base.y": Coordinate("base.y", mass),
            "base.yaw": Coordinate("base.yaw", inertia, angular=True),
        }
        ports = {n: {n: 1.0} for n in coordinates}
        coordinates |= {f"link.{n}": Coordinate(f"link.{n}", values[f"link.{n}.mass"]) for n in self._link_mass}
        (stream,) = dict.fromkeys(b.stream for b in trial.blocks)
        return Mechanism(
            coordinates=coordinates,
            ports=ports,
            readouts={c: Readout(c, "position", n) for n, c in TRACK.items()},
            sensors={stream: tuple(TRACK.values()), ARM: tuple(self.drives.values())},
            links=self._links,
        )

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """Where the base is and how it moves at the start."""
        out = []
        for coordinate, channel in TRACK.items():
            near = local(*self._raw[trial.id][channel], trial.start, EARLY)
            size, time = self.sizes[coordinate], self._raw[trial.id][channel][0]
            columns = self.doubted.of(trial.recorded, channel, time)
            beside = {k: local(time, column, trial.start, EARLY) for k, column in columns.items()}
            place, rate = (tuple((k, getattr(b, of)) for k, b in beside.items()) for of in ("value", "slope"))
            far, fast = max(near.value_sigma, 1e-3 * size.length), max(near.slope_sigma, 1e-2 * size.length / size.time)
            out.append(Nuisance(coordinate, False, near.value, far, beside=place))
            out.append(Nuisance(coordinate, True, near.slope, fast, beside=rate))
        return tuple(out)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """The base's track that momentum asks for."""
        grid = self._grid[trial.id]
        if self.doubted.sigma:
            pairs = zip(self.nuisances(trial), initial, strict=True)
            initial = np.array([n.true(float(v), mechanism) for n, v in pairs])
        x0, vx, y0, vy, yaw0, spin0 = (float(v) for v in initial)
        shape = self._shaped(trial, mechanism)
        force, torque = self._outer(mechanism, trial, shape)
        about = shape.moment / shape.mass
        inertia = shape.inertia - shape.mass * (about**2).sum(axis=0)
        spin = shape.spin - (about[0] * shape.rate[1] - about[1] * shape.rate[0])
        start = inertia[0] * spin0 + spin[0]
        yaw = yaw0 + _integral((start + _integral(torque, grid) - spin) / inertia, grid)
        cos, sin = np.cos(yaw), np.sin(yaw)
        offset = np.array([cos * about[0] - sin * about[1], sin * about[0] + cos * about[1]])
        drift = shape.rate[:, 0] / shape.mass + spin0 * np.array([-about[1, 0], about[0, 0]])
        turn = np.array([[cos[0], -sin[0]], [sin[0], cos[0]]])
        speed = np.array([vx, vy]) + turn @ drift
        moved = np.array([_integral(_integral(f / shape.mass, grid), grid) for f in force])
        centre = np.array([x0, y0])[:, None] + offset[:, :1] + speed[:, None] * (grid - grid[0]) + moved
        track = dict(zip(TRACK.values(), [*(centre - offset), yaw], strict=True))
        out = []
        for block in trial.blocks:
            (channel,) = block.channels
            maps = tuple(m for m in mechanism.maps if m.channel == channel)
            out.append(np.interp(block.time, grid, through_sensor(maps, track[channel], STEP))[None])
        self.take_off_beside(out, mechanism, trial)
        return Predicted(tuple(out))

    def logged(self, values: Mapping[str, float]) -> dict[str, float]:
        """Of its track."""
        return readings_noise(self._whole, self.stated, scatter=True)

    def travelled(
        self, port: str, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> Mapping[Variable, np.ndarray]:
        """Along the measured track; the rate along it where it may go in several directions."""
        places, rates = self._seen[trial.id]
        along = [rates[p] for p in (port, *across(mechanism, port))]
        rate = along[0] if len(along) == 1 else np.append(0.0, np.hypot(*along))
        return {"d": places[port], "v": rate}

    def _outer(self, mechanism: Mechanism, trial: TrialData, shape: Shape) -> tuple[np.ndarray, np.ndarray]:
        """Force on the whole, shape (2, T), and torque about its centre of mass, shape (T,), in the world."""
        places, rates = self._truly(mechanism, trial)
        force = np.zeros((2, self._grid[trial.id].size))
        torque = np.zeros(force.shape[1])
        for field in mechanism.fields:  # of gravity: it pulls at the centre of mass
            force[int(field.body == "base.y")] += shape.mass * field.acceleration
        acting = port_forces(mechanism, places, rates, STEP)
        if acting:
            pull = np.array([acting.get(n, 0.0) + np.zeros(force.shape[1]) for n in ("base", "base.y")])
            cos, sin = np.cos(places["base.yaw"]), np.sin(places["base.yaw"])
            ahead, left = shape.moment / shape.mass
            arm = np.array([-(cos * ahead - sin * left), -(sin * ahead + cos * left)])
            force = force + pull
            torque = torque + arm[0] * pull[1] - arm[1] * pull[0] + acting.get("base.yaw", 0.0)
        return force, torque

    def _truly(
        self, mechanism: Mechanism, trial: TrialData
    ) -> tuple[Mapping[str, np.ndarray], Mapping[str, np.ndarray]]:
        """Where the base was and how it moved, on the grid, by a mechanism's factors."""
        places, rates = self._seen[trial.id]
        if not self.doubted.sigma:
            return places, rates
        grid = self._grid[trial.id]
        more = {n: self.doubted.brought(mechanism, trial.recorded, c, grid) for n, c in TRACK.items()}
        return (
            {n: place + more[n] for n, place in places.items()},
            {n: rate + _rate(more[n]) for n, rate in rates.items()},
        )

    def _shaped(self, trial: TrialData, mechanism: Mechanism) -> Shape:
        """The arm's motion through the maps of its sensor, with the platform's own values; kept while they stay."""
        maps = tuple(m for m in mechanism.maps if m.channel.partition(BAR)[0] in self.drives.values())
        mass, inertia = mechanism.coordinates["base"].mass, mechanism.coordinates["base.yaw"].mass
        key = (trial.id, maps)
        if key not in self._shape:
            if len(self._shape) > 64:
                self._shape.clear()
                self._loads.clear()
            grid = self._grid[trial.id]
            moved = [
                through_sensor(
                    tuple(m for m in maps if m.channel == c),
                    q + self.doubted.brought(mechanism, trial.recorded, c, grid),
                    STEP,
                )
                for c, q in zip(self.drives.values(), self._joints[trial.id], strict=True)
            ]
            joints, grid = np.array(moved), self._grid[trial.id]
            whole = self._arm(self.robot.model, joints, grid)
            twice = {n: self._arm(model, joints, grid) for n, model in self._twice.items()}
            self._shape[key] = whole, {n: heavier.plus(whole, -1.0) for n, heavier in twice.items()}, joints
        arm, links, _ = self._shape[key]
        for name, share in links.items():
            arm = arm.plus(share, mechanism.coordinates[f"link.{name}"].mass / self._link_mass[name] - 1.0)
        for load in mechanism.loads:
            arm = arm.plus(self._carried(key, load), load.mass)
        own = self.robot.model.inertias[1]
        more = mass - own.mass
        lever = own.lever[:2]
        return Shape(
            arm.mass + more,
            arm.moment + more * lever[:, None],
            arm.rate,
            arm.inertia + inertia - float(own.inertia[2, 2]) + more * float(lever @ lever),
            arm.spin,
        )

    def _carried(self, motion: tuple[str, tuple[ChannelMap, ...]], load: Load) -> Shape:
        """What each kilogram of a load has of the whole's motion, along one of the arm's that is kept."""
        if (key := (*motion, load.link, load.place)) not in self._loads:
            whole, _, joints = self._shape[motion]
            link = load.link.removeprefix("link.")
            body = {self._bodies.joint_of(link): self._bodies.numbers(link, load.place)}
            loaded = self._bodies.arm.with_bodies(body, np.zeros(3))
            self._loads[key] = self._arm(loaded.model, joints, self._grid[motion[0]]).plus(whole, -1.0)
        return self._loads[key]

    def _arm(self, model: pin.Model, joints: np.ndarray, grid: np.ndarray) -> Shape:
        from scipy.interpolate import CubicSpline

        data = model.createData()
        index = [self.robot.velocity_index(j) for j in self.drives]
        rates = CubicSpline(grid, joints, axis=1)(grid, 1)
        base = pin.neutral(model)[:7]
        position, v = np.zeros(model.nv), np.zeros(model.nv)
        rows = np.empty((grid.size, 6))
        for i in range(grid.size):
            position[index], v[index] = joints[:, i], rates[:, i]
            matrix = pin.crba(model, data, floating_configuration(model, base, position[6:]))
            matrix = np.triu(matrix) + np.triu(matrix, 1).T
            momentum = matrix[:6] @ v
            rows[i] = matrix[1, 5], -matrix[0, 5], momentum[0], momentum[1], matrix[5, 5], momentum[5]
        mass = float(matrix[0, 0])
        return Shape(mass, rows[:, :2].T, rows[:, 2:4].T, rows[:, 4], rows[:, 5])


def _follow(grid: np.ndarray, time: np.ndarray, value: np.ndarray) -> np.ndarray:
    """A known motion on a grid: cubic between its samples, still outside of them."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(time, value)(np.clip(grid, time[0], time[-1])))


def _rate(place: np.ndarray) -> np.ndarray:
    """Rate of a track on the grid, shape (T,): of the cubic through SMOOTH around each time (Savitzky and Golay 1964).

    A mean over so long would take a twentieth of a motion of 1 rad/s, and of a drag that goes with its square a tenth.
    """
    from scipy.signal import savgol_filter

    longest = place.size - (place.size + 1) % 2
    width = min(2 * round(0.5 * SMOOTH / STEP) + 1, longest)
    if width < 2:
        return np.asarray(np.gradient(place, STEP))
    return np.asarray(savgol_filter(place, width, min(3, width - 1), deriv=1, delta=STEP, mode="interp"))


def _integral(rate: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Integral from the first time on, shape (T,): trapezia, and what they leave of a curve, to fourth order (Euler
    and Maclaurin).
    """
    step = np.diff(grid)
    area = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)])
    slope = np.gradient(rate, grid, edge_order=2 if rate.size > 2 else 1)
    return np.asarray(area - step[0] ** 2 / 12.0 * (slope - slope[0]))


def _thrust(recording: Recording) -> list[Series]:
    """Inputs that push the base."""
    return [s for s in recording.inputs() if s.name.startswith(("base.force", "base.torque"))]


def platform_models(study: Study) -> list[Machine]:
    """The model of a free base whose joints follow a known motion; none for other studies."""
    if study.baseline.base != "free" or study.robot_source is None:
        return []
    found: dict[tuple[tuple[str, str], ...], list[Trial]] = {}
    for trial in study.trials:
        recording = study.recording(trial)
        named = {c.split(".")[1]: c for c in recording if c.startswith("joint.") and c.endswith(".reference")}
        named |= {c.split(".")[1]: c for c in recording if c.startswith("joint.") and c.endswith(".position")}
        pushed = any(np.any(s.good()[1] != 0.0) for s in _thrust(recording))
        if named and set(TRACK.values()) <= set(recording) and not pushed:
            found.setdefault(tuple(sorted(named.items())), []).append(trial)
    return [Platform(study, trials, dict(names)) for names, trials in found.items()]
