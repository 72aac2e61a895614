"""The wrist rig as a model that fits can run: values to mechanism, start of a trial, prediction of its channels."""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from spacerobot.diagnosis.machines.clock_scan import best_offset
from spacerobot.diagnosis.machines.contract import CLOCK, Machine, Nuisance, Predicted, Variant
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.mechanism_cache import MechanismCache
from spacerobot.diagnosis.machines.rig_channels import own_clocks, sensors_of, turning, zeros_of
from spacerobot.diagnosis.machines.rig_trials import CHANNEL_OF, lateness, nuisances_of, touch_time
from spacerobot.diagnosis.machines.rig_values import together, unknown_values
from spacerobot.diagnosis.machines.sizes import beside_usual, sizes_of_hits
from spacerobot.diagnosis.terms.alignment import LEAST
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site
from spacerobot.effects.effect import Effect
from spacerobot.effects.filters import filter_of
from spacerobot.effects.learned import Variable
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.beliefs import ABSORBING, beliefs_of
from spacerobot.recordings.study import Study
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import DEFAULTS, rig
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import InputError

STEP_LIMIT = 5000
"""Steps of one trial after which a fit calls its parameters too stiff to be true; a plain trial takes some 400."""

SHARE, STIFF = 0.03, 0.1
"""Of the largest force in the contact and of the port's spring: as which a further force and what remembers begin."""

SPEEDS = (0.5, 1.0, 2.0, 3.0)
MASSES = (0.5, 1.0, 2.0)
"""Factors of another trial on what was recorded."""


@dataclass(frozen=True, kw_only=True)
class RigPredicted(Predicted):
    """With the run that it was read from."""

    run: ReducedRun


class RigModel(Machine):
    """A wrist on a spring and a floating target, from a study's baseline.

    Attributes:
        beliefs: what the study says of its values, and what is assumed of them.
        tolerance: of the integrator in fits.
    """

    name = "wrist rig"
    strides = False
    learns = True
    """Whether a law without a name is looked for at its ports."""
    metric = "simulated motion"
    otherwise = MappingProxyType({"hand.x": "a marker on the hand"})
    free_mass = "target.mass"

    def __init__(self, study: Study, trials: tuple[TrialData, ...], *, tolerance: float = 1e-6) -> None:
        baseline, names = study.baseline, self.names(study)
        known = {n: v for n, v in study.values().items() if n in names}
        unknown = self.unstated(study, known, trials)
        channels = {c for t in trials for c in t.channels}
        self.turning = turning(study)
        self.sideways = "target.y" in channels
        if not self.turning:
            known.pop("target.yaw_inertia", None)
        along = float(np.dot(baseline.gravity, baseline.approach))
        if along:
            known["gravity.along"] = along
        absent = self.absent(known)
        known |= absent  # not stated: found, as what is there to absorb is
        self.base: dict[str, float] = known
        self.beliefs = beliefs_of(study, names)
        sigma = {n: s for n, s in self.beliefs.sigma.items() if n in names and s > 0.0}
        unstated = [n for n in sigma if n not in known and not all(n in t.overrides for t in study.trials)]
        if unstated:
            raise InputError("a value has a sigma but no believed value", given=unstated[0], where=str(study.path))
        scatter = {n: s for n, s in study.scatter.items() if n in names and s > 0.0}
        self.sensors = sensors_of(study)
        self.filters = tuple(filter_of(c, own.cutoff, own.order, own.kind) for c, own in study.filters().items())
        clocks = own_clocks(study, self.sensors)
        conditions = tuple(study.conditions())
        self.doubted = doubted(study, study.trials, channels, zeros=False)
        self.believed = Believed(
            known,
            sigma,
            scatter,
            conditions,
            unknown,
            tuple(ABSORBING),
            clocks=clocks,
            unheld={**self.beliefs.free, **absent},
            zeros={**zeros_of(study, channels), **self.doubted.sigma},
            absolute={n: s for n, s in study.absolute.items() if n in names},
        )
        self._number = {t.id: k for k, t in enumerate(study.trials)}
        self.tolerance = tolerance
        self._lately = MechanismCache()
        self._know(trials)
        rates = [n.guess for motion in self._motion.values() for n in motion if n.coordinate == "target" and n.rate]
        self._size = sizes_of_hits(trials, {**self.base, **unknown}, rates)

    def names(self, study: Study) -> Collection[str]:
        """The values that it is made of."""
        return DEFAULTS

    def unstated(self, study: Study, known: Mapping[str, float], trials: tuple[TrialData, ...]) -> dict[str, float]:
        """Values that the study does not state, with where their search begins."""
        return unknown_values(known, trials)

    def absent(self, known: Mapping[str, float]) -> dict[str, float]:
        """Values that are not stated and found from nothing on: there is something to absorb."""
        return {name: 0.0 for name, added in ABSORBING.items() if name not in known and added not in known}

    def own(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """What is free in a trial alone, from its recordings."""
        return nuisances_of(trial, self.turning, self.sideways)

    def _know(self, trials: tuple[TrialData, ...]) -> None:
        self.trials = trials
        self._trials = {t.id: t for t in trials}
        self._touch = {t.id: touch_time(t) for t in trials}
        self._motion = {t.id: self.own(t) for t in trials}

    def size_at(self, where: str) -> Sizes:
        """Of the wrist, everywhere."""
        return self._size

    def of(self, trial: TrialData) -> RigModel:
        """The same rig, in this trial alone."""
        other = copy.copy(self)
        other._know((trial,))
        return other

    def mechanism(self, values: Mapping[str, float], trial: TrialData | None = None) -> Mechanism:
        """The baseline mechanism of these rig values, alike in every trial."""
        inside = together({n: v for n, v in values.items() if n in DEFAULTS})
        return replace(rig(inside, lateral=self.sideways), sensors=self.sensors, maps=self.filters)

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """Every effect at every place; what happens once, in one of the trials."""
        return [self.site(s.effect, s.where) for s in candidate_sites(self.plain(), self.believed, effects)]

    def site(self, effect: Effect, where: str, trials: tuple[str, ...] = ()) -> Site:
        """An effect at a place, as it stands in the catalogue unless this rig is of another size."""
        return Site(beside_usual(effect, self._size), where, trials)

    def variants(self, trial: TrialData) -> Iterator[Variant]:
        """The trial with another target at other speeds; what is not stated of it cannot be changed."""
        known = trial.overrides.get("target.mass")
        rates = [n.guess for n in self.nuisances(trial) if n.rate and n.coordinate == "target"]
        for mass in MASSES if known is not None else (1.0,):
            for speed in SPEEDS:
                change: dict[str, float | str] = {}
                if rates and speed != 1.0:
                    change["target.speed_m_s"] = float(f"{abs(rates[0]) * speed:.3g}")
                if known is not None and mass != 1.0:
                    change["target.mass"] = float(f"{known * mass:.4g}")
                yield Variant(change, self, rates=speed, masses=mass)

    def trial(self, name: str) -> TrialData:
        """A trial by its id."""
        return self._trials[name]

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """What is free in this trial alone."""
        return self._motion[trial.id]

    def approach_start(self, trial: TrialData, initial: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """Initial values that fit the free approach alone, given the residual at `initial`.

        Args:
            trial: whose.
            initial: present initial values, shape (N,).
            residual: weighted residual there, shape (S,), predicted minus measured.

        Returns:
            shape (N,); before the touch a start moves the track by dx + dv t, so two unknowns per coordinate. Clocks
            go back to where the touch on that approach has them.
        """
        touch = self._touch[trial.id]
        nuisances = self._motion[trial.id]
        pairs = zip(nuisances, initial, strict=True)
        out = np.array([n.guess if n.coordinate.startswith(CLOCK) else x for n, x in pairs])
        row = 0
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                rows = slice(row, row + block.time.size)
                row += block.time.size
                own = [n for n, x in enumerate(nuisances) if CHANNEL_OF.get(x.coordinate) == channel]
                early = (block.time < touch) & (block.weight[c] > 0.0)
                if len(own) != 2 or early.sum() < LEAST:
                    continue
                error = residual[rows][early] / block.weight[c][early]
                slope, offset = np.polyfit(block.time[early] - trial.start, error, 1)
                for n in own:
                    out[n] -= slope if nuisances[n].rate else offset
        return out

    def in_step(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> np.ndarray:
        """Initial values with every clock of the trial's own where its readings fit best, tried at every offset.

        Raises:
            SimulationError: the trial cannot be simulated from there.
        """
        at = {n.coordinate: k for k, n in enumerate(self._motion[trial.id])}
        clocks = dict.fromkeys(b.clock for b in trial.blocks if CLOCK + b.clock in at)
        if not clocks:
            return initial
        shown, out = partial(_shown, self.predict(mechanism, trial, initial).run, mechanism), initial.copy()
        for clock in clocks:
            out[at[CLOCK + clock]] = best_offset([b for b in trial.blocks if b.clock == clock], shown)
        return out

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData) -> Mechanism:
        """The edited mechanism of one trial."""

        def make() -> Mechanism:
            values = hypothesis.trial_values(z, self.base, trial.condition, trial.overrides)
            free = hypothesis.values(z)
            number = self._number.get(trial.recorded, 0)
            made = self.mechanism(values, trial).with_map(*self.zeros(free))
            return hypothesis.edit(made, free, trial.id, number)

        return self._lately.mechanism(hypothesis, z, trial, make)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> RigPredicted:
        """Simulate a trial from its initial values, shape (len(nuisances),), and read its channels."""
        position, velocity = self.start(mechanism, trial, initial)
        run = simulate(
            self._lately.prepared(mechanism),
            position=position,
            velocity=velocity,
            start=trial.start,
            end=trial.end + 1e-9,
            tolerance=self.tolerance,
            step_limit=STEP_LIMIT,
        )
        late = lateness(trial, self._motion[trial.id], initial)
        blocks = tuple(
            _shown(run, mechanism, b.channels, b.time - by if by else b.time)
            for b, by in zip(trial.blocks, late, strict=True)
        )
        self.take_off_beside(blocks, mechanism, trial)
        return RigPredicted(blocks=blocks, touches=tuple(run.touches().tolist()), late=late, run=run)

    def start(
        self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Positions and velocities of the coordinates that do not start at rest [m, rad, m/s, rad/s]."""
        position: dict[str, float] = {}
        velocity: dict[str, float] = {}
        for nuisance, value in zip(self._motion[trial.id], initial, strict=True):
            if nuisance.coordinate in mechanism.coordinates:
                (velocity if nuisance.rate else position)[nuisance.coordinate] = float(value)
        return position, velocity

    def turns(self, where: str) -> bool:
        """Whether what moves at a place is an angle, and its effects are counted so."""
        return False

    def from_rest(self, trials: Sequence[TrialData]) -> tuple[TrialData, ...]:
        """The trials with every channel counted from where the machine stands, as balances read them."""
        return tuple(trials)

    def robot_in(
        self, study: Study, values: Mapping[str, float], trial: TrialData, initial: np.ndarray
    ) -> dict[str, Any]:
        """What a scene of the trial says of the robot: fields of `Scene`."""
        baseline = study.baseline
        return {"robot": study.robot_source or "pa10_wrist", "base": baseline.base, "joints": baseline.joints}

    def travelled(
        self, port: str, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> Mapping[Variable, np.ndarray]:
        """In the simulated trial, wherever something was read; of the contact while the surfaces touch."""
        run = self.predict(mechanism, trial, initial).run
        taken = run.sample(np.unique(np.concatenate([b.time for b in trial.blocks])))
        place, rate = run.port(port, taken.position), run.port(port, taken.velocity)
        if port == "contact":
            place, rate = np.append(0.0, place[place > 0.0]), np.append(0.0, rate[place > 0.0])
        remembered = taken.memory[:, -1:].ravel() if taken.memory.size else np.zeros(1)
        return {"d": place, "v": rate, "N": np.append(0.0, run.contact_force(taken)), "z": remembered}

    def typical_law(self, port: str, seen: Mapping[Variable, tuple[float, float]]) -> tuple[float, float]:
        """By the largest force in the contact, wherever the law acts, and by the port's spring."""
        spring = self.base["contact.stiffness" if port == "contact" else "wrist.stiffness"]
        return SHARE * max(abs(x) for x in seen["N"]), STIFF * spring


def _shown(run: ReducedRun, mechanism: Mechanism, channels: Sequence[str], time: np.ndarray) -> np.ndarray:
    """What channels read at times, shape (C, T)."""
    return np.array(list(read_channels(run, mechanism, channels, time).values()))
