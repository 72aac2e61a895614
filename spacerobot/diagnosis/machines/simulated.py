"""Motion simulated from a window's start under the recorded drives, against what was recorded: output error."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from typing import Self

import numpy as np

from spacerobot.diagnosis.machines.contract import FACTORS, Machine, Nuisance, Predicted, Variant
from spacerobot.diagnosis.machines.doubted import NONE, Doubted, beyond
from spacerobot.diagnosis.machines.mechanism_cache import MechanismCache
from spacerobot.diagnosis.machines.readings_noise import readings_noise
from spacerobot.diagnosis.machines.riders import SETTLED, Riders, State, placed, riding
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.machines.windows import CHANGED, FOLDS, Drive, Local, beside, cut, local, overlap, spread_over
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site
from spacerobot.effects.effect import Effect
from spacerobot.effects.learned import Variable
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across
from spacerobot.effects.primitives import Impulse, Readout
from spacerobot.effects.sizes import Sizes
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import InputError, SimulationError

BUDGET = 4_000
"""Readings that a fit looks at; windows of longer recordings are taken evenly over them."""

NEAR = 0.05
"""Readings within this share of the motion's own time tell how a window starts."""

TRIFLE = 1e-4
"""Share of what is typical of a coordinate below which no step of a fit moves its start."""

LOOSEST = 1e-4
"""Relative tolerance of the integrator; drives that are joined by lines make it no better than this."""

RESOLVED = 1e-3
"""Share of what is typical of a coordinate by which derivatives tell how a window starts: ten times that tolerance."""

PLACE, RATE = 1e-3, 0.1
"""Lengths [m] and speeds [m/s] whose share of a tolerance is the integrator's own absolute error."""

LONGER = 1.5
"""By how much another trial may be lengthened."""

Build = Callable[[Mapping[str, float], TrialData], Mechanism]


class Simulated(Machine):
    """Any mechanism of the reduced backend, with its recorded drives, window by window."""

    metric = "simulated motion"
    flies = False
    """Whether nothing carries it, so that what bends its track at once met it."""
    predicts_readings = True

    def __init__(
        self,
        name: str,
        build: Build,
        recorded: Sequence[TrialData],
        drives: Mapping[str, Drive],
        *,
        believed: Believed,
        sizes: Mapping[str, Sizes],
        window: float,
        at_rest: bool = False,
        budget: int = BUDGET,
        covered: frozenset[tuple[str, str]] = frozenset(),
        doubted: Doubted = NONE,
    ) -> None:
        """From recordings.

        Args:
            name: of the body or joint.
            build: values and trial to its baseline mechanism.
            recorded: whole trials, weighted.
            drives: trial -> its recorded inputs; none where nothing drives.
            believed: values and unknowns.
            sizes: what is typical, by place.
            window: length of a window [s]; infinite for whole trials.
            at_rest: whether trials are known to begin at rest.
            budget: readings that a fit looks at.
            covered: effects, each with its place, that a fitted value stands for.
            doubted: of its channels; the columns of its inputs are beside the drives.

        Raises:
            InputError: no window holds enough readings.
        """
        self.name, self.build, self.sizes = name, build, sizes
        self.base = dict(believed.values)
        self.drives = dict(drives)
        self.given = frozenset(c for d in self.drives.values() for c in d.value)
        self.recorded = {t.id: t for t in recorded}
        self.at_rest, self.covered, self.doubted = at_rest, covered, doubted
        self.believed = replace(believed, zeros=doubted.sigma) if doubted.sigma else believed
        self._window = self._length = window
        self._budget = budget
        self._cuts: Mapping[str, Sequence[Moment]] = {}
        windows = [w for t in recorded for w in cut(t, window)]
        if not windows:
            raise InputError(f"{name} has too few readings in every trial", valid="five or more of a channel in one")
        self.trials = tuple(spread_over(windows, budget))
        self._absolute = min(min(s.length / PLACE, s.length / s.time / RATE) for s in sizes.values())
        self._hidden: tuple[TrialData, ...] = ()
        self._lately = MechanismCache()
        self._forget()

    def _forget(self) -> None:
        """What was found of how its windows begin."""
        self._starts: dict[str, tuple[Nuisance, ...]] = {}
        self._riders = Riders()

    @property
    def window(self) -> float:
        """Length of its windows [s]."""
        return self._window

    def everything(self) -> Self:
        """All its windows."""
        return self.in_windows(self._window)

    def in_windows(self, length: float) -> Self:
        """The same recordings in windows of another length [s], all of them."""
        other = copy(self)
        other._length = length
        windows = (w for t in self.recorded.values() for w in cut(t, length, self._cuts.get(t.id, ())))
        other.trials = tuple(w for w in windows if not any(overlap(w, h) for h in self._hidden))
        other._forget()
        return other

    def cut_at(self, moments: Mapping[str, Sequence[Moment]]) -> Self:
        """No window goes over one of these moments, nor over one at which it met something."""
        other = copy(self)
        other._cuts = {t: (*self.met.get(t, ()), *moments.get(t, ())) for t in (*self.met, *moments)}
        other._length = self._window
        windows = [w for t in self.recorded.values() for w in cut(t, self._window, other._cuts.get(t.id, ()))]
        other.trials = tuple(spread_over(windows, self._budget, beside(windows, moments)))
        other._forget()
        return other

    def steady(self, trial: TrialData, start: float, end: float) -> bool:
        """By the recorded inputs, each within a share of all that it does in the trial."""
        drive = self.drives.get(trial.recorded)
        if drive is None:
            return True
        here = (drive.time >= start) & (drive.time <= end)
        return all(not here.any() or np.ptp(v[here]) <= CHANGED * np.ptp(v) for v in drive.value.values())

    def but_for(self, out: Sequence[str]) -> Self:
        """The same without some of its windows: nothing that it fits knows a reading of theirs."""
        other = copy(self)
        other.trials = tuple(t for t in self.trials if t.id not in out)
        kept = {t.recorded for t in other.trials}
        other.recorded = {k: t for k, t in self.recorded.items() if k in kept}
        other._hidden = (*self._hidden, *(t for t in self.trials if t.id in out))
        other._forget()
        return other

    def divided(self) -> Self:
        """One trial alone is cut into windows."""
        if len(self.trials) > 1:
            return self
        (trial,) = self.trials
        parts = self.in_windows((trial.end - trial.start) / FOLDS)
        if len(parts.trials) < 2:
            raise SimulationError("what is left when a fold is left out is too short to choose by")
        return parts

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """The baseline of one trial with these values."""
        return self.build(values, trial)

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData) -> Mechanism:
        """As everywhere; windows of one trial share theirs."""
        make = partial(super().trial_mechanism, hypothesis, z, trial)
        return self._lately.mechanism(hypothesis, z, trial, make, alone=True)

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """As everywhere, less those that a fitted value stands for."""
        return [s for s in super().sites(effects) if s.label not in self.covered]

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """Initial position and velocity of every coordinate that some channel shows."""
        if trial.id not in self._starts:
            values = {**self.base, **self.believed.unknown, **trial.overrides}
            self._starts[trial.id] = tuple(self._start(self.build(values, trial), trial))
        return self._starts[trial.id]

    def variants(self, trial: TrialData) -> Iterator[Variant]:
        """Other drives, or else other initial speeds and longer trials; another mass where one is known."""
        driven = {t: d for t, d in self.drives.items() if d.value}
        for factor in FACTORS:
            if driven:
                other = copy(self)
                other.drives = {t: d.times(factor) for t, d in driven.items()}
                other._forget()
                yield Variant({"drive": f"{factor:g} times the recorded one"}, other, rates=factor)
            else:
                yield Variant({"initial speed": f"{factor:g} times the recorded one"}, self, rates=factor)
            if "body.mass" in self.trials[0].overrides or ("body.mass" in self.base and not self.relative_to):
                yield Variant({"mass": f"{factor:g} times, with the same shape"}, self, masses=factor)
        if not driven:
            yield Variant({"length of the trial": f"{LONGER:g} times the recorded one"}, self, longer=LONGER)

    def _start(self, mechanism: Mechanism, trial: TrialData) -> list[Nuisance]:
        whole = self.recorded[trial.recorded]
        reach = NEAR * self.sizes[""].time
        found = []
        for coordinate in mechanism.coordinates:
            known = [r for r in mechanism.readouts.values() if r.of == coordinate and r.channel in whole.channels]
            shown = {r.kind: r for r in known}
            size = self.sizes.get(coordinate, self.sizes[""])
            trifle, least = TRIFLE * size.length, RESOLVED * size.length  # a counter at rest has no scatter at all
            if "position" in shown:
                time, value = self._seen(whole, shown["position"], trial)
                near = local(time, value, trial.start, reach)
                beside = self._beside(trial, shown["position"], time, reach)
                also = tuple((k, b.value) for k, b in beside)
                found.append(Nuisance(coordinate, False, near.value, max(near.value_sigma, trifle), least, also))
                if not (self.at_rest and trial.start <= whole.start) and "velocity" not in shown:
                    scale = max(near.slope_sigma, trifle / size.time)
                    also = tuple((k, b.slope) for k, b in beside)
                    found.append(Nuisance(coordinate, True, near.slope, scale, least / size.time, also))
            if "velocity" in shown:
                time, value = self._seen(whole, shown["velocity"], trial)
                near = local(time, value, trial.start, reach)
                scale = max(near.value_sigma, trifle / size.time)
                also = tuple((k, b.value) for k, b in self._beside(trial, shown["velocity"], time, reach))
                found.append(Nuisance(coordinate, True, near.value, scale, least / size.time, also))
        return found

    def _beside(self, trial: TrialData, readout: Readout, time: np.ndarray, reach: float) -> list[tuple[str, Local]]:
        """Where a window starts by each doubted column of a channel, counted as its coordinate is."""
        columns = self.doubted.of(trial.recorded, readout.channel, time)
        return [(k, local(time, readout.sign * column, trial.start, reach)) for k, column in columns.items()]

    def _seen(self, whole: TrialData, readout: Readout, trial: TrialData) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of a channel up to the end of a window, counted as its coordinate is.

        What came before a window tells how it begins, unless that is kept aside, or it began anew there.
        """
        time, value, _ = whole.channel(readout.channel)
        known = time <= trial.end + 1e-9
        for moment in self._cuts.get(whole.id, ()):
            if moment.high <= trial.start + 1e-9:
                known &= time >= moment.high - 1e-9
        for window in self._hidden:
            if window.recorded == whole.id:
                known &= (time < window.start - 1e-9) | (time > window.end - 1e-9)
        return time[known], readout.sign * value[known]

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """Simulate the window from its initial values and read its channels."""
        run = self._run(mechanism, trial, initial)
        blocks = [np.array(list(read_channels(run, mechanism, b.channels, b.time).values())) for b in trial.blocks]
        self.take_off_beside(blocks, mechanism, trial)
        return Predicted(tuple(blocks))

    def logged(self, values: Mapping[str, float]) -> dict[str, float]:
        """As stated; of a body that nothing drives also as its track scatters: nothing else can have moved it."""
        return readings_noise(self.recorded.values(), self.stated, scatter=not self.given)

    def travelled(
        self, port: str, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> Mapping[Variable, np.ndarray]:
        """In the simulated window; the rate of a body that moves in several directions is its speed."""
        run = self._run(mechanism, trial, initial)
        taken = run.sample(np.unique(np.concatenate([b.time for b in trial.blocks])))
        rates = [run.port(p, taken.velocity) for p in (port, *across(mechanism, port))]
        rate = rates[0] if len(rates) == 1 else np.append(0.0, np.sqrt(np.sum(np.square(rates), axis=0)))
        return {"d": run.port(port, taken.position), "v": rate}

    def _run(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> ReducedRun:
        beside = SETTLED
        if riding(mechanism):
            beside = self._riders.beside(
                mechanism, trial, partial(self._in_a_row, mechanism, trial), partial(self._simulated, mechanism)
            )
        return self._simulated(mechanism, trial, placed(mechanism, self._begins(mechanism, trial, initial), beside))

    def _begins(self, mechanism: Mechanism, trial: TrialData, initial: Iterable[float]) -> State:
        """Where a window begins and how fast, of what its readings tell."""
        state: State = {}, {}
        for nuisance, value in zip(self.nuisances(trial), initial, strict=True):
            state[nuisance.rate][nuisance.coordinate] = nuisance.true(float(value), mechanism)
        return state

    def _in_a_row(self, mechanism: Mechanism, trial: TrialData) -> Iterator[tuple[TrialData, State | None]]:
        """All windows of a trial, with where each begins; None where its readings are kept aside."""
        whole = self.recorded[trial.recorded]
        for window in cut(whole, self._length, self._cuts.get(whole.id, ())):
            aside = any(overlap(window, h) for h in self._hidden)
            guesses = () if aside else (n.guess for n in self.nuisances(window))
            yield window, None if aside else self._begins(mechanism, window, guesses)

    def _simulated(self, mechanism: Mechanism, trial: TrialData, begins: State) -> ReducedRun:
        position, velocity = begins
        # what a late sensor shows at the window's start happened before it: the run begins then, with that state
        late = _delays(mechanism, trial)
        start, end = trial.start - max(late), trial.end - min(late) + 1e-9
        drive = self.drives.get(trial.recorded)
        if drive is not None:
            drive = drive.told(partial(beyond, mechanism)).through(mechanism.maps, start, end)
        step, inputs = 0.25 * self.sizes[""].time, None
        if drive is not None and mechanism.inputs:
            first, last = np.searchsorted(drive.time, [start, end])
            part = slice(max(int(first) - 2, 0), int(last) + 2)
            inputs = (drive.time[part], {c: v[part] for c, v in drive.value.items()})
            if drive.jumps.size:
                port, inside = next(iter(mechanism.ports)), (drive.jumps > start) & (drive.jumps < end)
                stops = tuple(Impulse(port, 0.0, float(t), "command") for t in drive.jumps[inside])
                mechanism = replace(mechanism, impulses=(*mechanism.impulses, *stops))
            if drive.bends:
                step = min(step, 2.0 * drive.step)
        return simulate(
            mechanism,
            position=position,
            velocity=velocity,
            start=start,
            end=end,
            tolerance=LOOSEST,
            inputs=inputs,
            max_step=step,
            scale=self._absolute,
        )


def _delays(mechanism: Mechanism, trial: TrialData) -> list[float]:
    """By channel of the trial [s]."""
    return [
        sum(m.value for m in mechanism.maps if m.channel == channel and m.kind == "delay") for channel in trial.channels
    ]
