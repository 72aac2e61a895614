"""A box that is tossed onto a table: its motion window by window, against corners that bounce and slide."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.machines.contract import FIRST_NOISE, Machine, Predicted, conditions_of
from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id
from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.effect import Effect
from spacerobot.effects.laws import CONTACT
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Contact, Coordinate
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.simulation.tumbling import tumble_all

PLACES = tuple(f"body.position.{a}" for a in "xyz")
STATE = (
    *(f"body.orientation.{a}" for a in "wxyz"),
    *PLACES,
    *(f"body.angular_velocity.{a}" for a in "xyz"),
    *(f"body.velocity.{a}" for a in "xyz"),
)

WINDOW = 16
"""Readings of a window: long enough for an impact, too short for tumbling to become chaotic."""

FINER = 4
"""Steps of the simulation to a reading."""

BUDGET = 60
"""Trials that a fit looks at, evenly over all of them."""

EDGES = ("body.length", "body.width", "body.height")


class Tossed(Machine):
    """Windows of a tumbling box, each from its recorded state; angular velocities are recorded in its own axes."""

    metric = "simulated motion"
    given = frozenset(STATE)  # where each window starts
    no_balance = "its contact's impulses are as short as a reading, so that no force is told between two of them"

    def __init__(self, study: Study, trials: Sequence[Trial]) -> None:
        self.name = "body"
        values = {n: v for n, v in study.values().items() if n.startswith("body.")}
        unknown = {n: 0.3 for n in ("body.restitution",) if n in study.baseline.unknown}
        self.base = {"body.restitution": 0.0, "contact.mu": study.value("contact.mu") or 0.0, **values}
        self._half = 0.5 * np.array([values[n] for n in EDGES])
        self._inertia = np.array([values[f"body.inertia.{a}"] for a in "xyz"])
        self._gravity = np.array(study.baseline.gravity)
        index = np.unique(np.linspace(0, len(trials) - 1, BUDGET).round().astype(int))
        self._states = {trials[i].id: _state(study.recording(trials[i])) for i in index}
        self._step = float(np.median(np.diff(study.recording(trials[0])[PLACES[0]].time)))
        self._height = float(np.median([self._lowest(s[-1]) for s in self._states.values()]))
        self._starts: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self._window = WINDOW
        place = np.concatenate([s[:, 4:7] - s[:1, 4:7] for s in self._states.values()])
        speed = np.concatenate([s[:, 10:13] for s in self._states.values()])
        weight = np.full(1, values["body.mass"] * float(np.linalg.norm(self._gravity)))
        self.sizes: Mapping[str, Sizes] = {"": sizes_of(weight, place, speed)}
        self.trials = tuple(self._trial(study, trials[i]) for i in index)
        sigma = {n: s for n, s in study.sigma.items() if n in self.base}
        self.believed = Believed(self.base, sigma, {}, conditions_of(self.trials), unknown)

    def in_windows(self, length: float) -> Tossed:
        """The same trials in windows of another length [s], each a trial of its own."""
        other = copy(self)
        other._window = max(1, round(length / self._step))
        other._starts, found = {}, []
        for trial in self.trials:
            state, (block,) = self._states[trial.id], trial.blocks
            for n, first in enumerate(range(0, state.shape[0] - other._window, other._window)):
                name, part = piece_id(trial.id, n), slice(first, first + other._window)
                other._starts[name] = self._begins(state[first : first + 1]), np.array([other._window])
                time, value, weight = block.time[part], block.value[:, part], block.weight[:, part]
                blocks = (replace(block, time=time, value=value, weight=weight),)
                found.append(replace(trial, id=name, blocks=blocks, start=float(time[0]), end=float(time[-1])))
        other.trials = tuple(found)
        return other

    @staticmethod
    def _begins(states: np.ndarray) -> np.ndarray:
        """Recorded states, shape (W, 13), with their angular velocity in world axes."""
        out = states.copy()
        out[:, 7:10] = np.einsum("wij,wj->wi", _matrices(out[:, :4]), out[:, 7:10])
        return out

    def _lowest(self, state: np.ndarray) -> float:
        corners = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * self._half
        return float(state[6] + (_matrices(state[None, :4])[0] @ corners.T)[2].min())

    def _trial(self, study: Study, trial: Trial) -> TrialData:
        recording, state = study.recording(trial), self._states[trial.id]
        first = np.arange(0, state.shape[0] - 1, WINDOW)
        rows = np.minimum(WINDOW, state.shape[0] - 1 - first)
        self._starts[trial.id] = self._begins(state[first]), rows
        time = recording[PLACES[0]].time[1:]
        stream = recording[PLACES[0]].stream
        weight = np.full((3, time.size), 1.0 / (FIRST_NOISE * self.sizes[""].length))
        block = Block(stream, PLACES, time, state[1:, 4:7].T.copy(), weight)
        return TrialData(trial.id, study.condition(trial), {}, (block,), float(time[0]), float(time[-1]))

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """Those that windows with many impacts show: what acts in them, and a pull that is the same everywhere."""
        return [s for s in super().sites(effects) if s.effect.instant or self.touched(s) == {"fields"}]

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """A body along both horizontal axes and its contact; the contact's one parameter is its restitution."""
        mass = values["body.mass"]
        coordinates = {n: Coordinate(n, mass) for n in ("target", "target.y")}
        return Mechanism(
            coordinates=coordinates,
            ports={n: {n: 1.0} for n in coordinates},
            contact=Contact(CONTACT, (values["body.restitution"], 0.0)),
            sensors={b.stream: b.channels for b in trial.blocks},
        )

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """Where the box is after each start."""
        starts, rows = self._starts[trial.id]
        assert mechanism.contact is not None
        mu = self.base["contact.mu"] + sum(f.p[0] for f in mechanism.frictions if f.normal == "contact")
        pull = self._gravity.copy()
        for field in mechanism.fields:
            pull[int(field.body == "target.y")] += field.acceleration
        out = np.zeros((starts.shape[0], self._window, 13))
        mass, bounce = mechanism.coordinates["target"].mass, mechanism.contact.p[0]
        tumble_all(
            starts, rows, self._step, FINER, self._half, mass, self._inertia, pull, self._height, bounce, mu, out
        )
        track = np.concatenate([o[:n, 4:7] for o, n in zip(out, rows, strict=True)]).T
        shown = []
        for k, channel in enumerate(PLACES):
            maps = tuple(m for m in mechanism.maps if m.channel == channel)
            shown.append(through_sensor(maps, track[k], self._step))
        return Predicted((np.array(shown),))


def _matrices(q: np.ndarray) -> np.ndarray:
    """Rotation matrices, shape (W, 3, 3), of quaternions w, x, y, z, shape (W, 4)."""
    w, x, y, z = q.T / np.linalg.norm(q, axis=1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.asarray(np.moveaxis(np.array(rows), 2, 0))


def _state(recording: Recording) -> np.ndarray:
    """The recorded state, shape (T, 13)."""
    return np.stack([recording[c].value for c in STATE], axis=1)


def tossed_models(study: Study) -> list[Machine]:
    """The model of a box whose whole state is recorded and whose baseline has a contact; none for other studies."""
    needed = ("body.mass", *EDGES, *(f"body.inertia.{a}" for a in "xyz"))
    if not any(n.startswith("contact.") for n in study.values()) or any(study.value(n) is None for n in needed):
        return []
    trials = [t for t in study.trials if set(STATE) <= set(study.recording(t)) and _whole(study.recording(t))]
    return [Tossed(study, trials)] if trials else []


def _whole(recording: Recording) -> bool:
    return len(recording[PLACES[0]]) > WINDOW and all(recording[c].valid.all() for c in STATE)
