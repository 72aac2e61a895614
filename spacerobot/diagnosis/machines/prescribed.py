"""A body carried along a known motion: what a sensor shows of it, and how late."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.machines.contract import FIRST_NOISE, Machine, Nuisance, Predicted, conditions_of
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import PIECES
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial

FINER = 4
"""Points a reading on which the known motion is followed."""

LEAD, SHARE = 1.0, 0.1
"""For so long [s], but no more than this share of a run, nothing is compared: what is late or smoothed shows then how
it moved before anything was recorded.
"""


class Prescribed(Machine):
    """A channel that should show a recorded motion, up to where the two count from, and in which direction."""

    metric = "carried motion"
    no_balance = "its motion is carried along a known one, whatever forces that takes"

    def __init__(self, study: Study, trials: Sequence[Trial], channel: str, source: str) -> None:
        """`channel` is measured, `source` the known motion (both m or rad)."""
        self.name, self.given = channel, frozenset([source])
        self.base: dict[str, float] = {}
        self._grid: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        parts, seen = [], []
        for trial in trials:
            recording = study.recording(trial)
            series, drive = recording[channel], recording[source]
            time, value = series.good()
            known_time, known = drive.good()
            step = float(np.median(np.diff(known_time))) / FINER
            grid = np.arange(known_time[0], known_time[-1] + 0.5 * step, step)
            path = np.interp(grid, known_time, known)
            path = path * float(np.sign(np.corrcoef(np.interp(time, grid, path), value)[0, 1]))
            lead = min(LEAD, SHARE * (grid[-1] - grid[0]))
            inside = (time >= grid[0] + lead) & (time <= grid[-1])
            parts.append((trial, time[inside], value[inside], series))
            self._grid[trial.id] = (grid, path)
            seen.append((path, np.gradient(path, grid)))
        paths, rates = (np.concatenate([s[i] for s in seen]) for i in range(2))
        sizes = sizes_of(np.ones(1), paths, rates)
        self.sizes: Mapping[str, Sizes] = {"": sizes}
        cut: list[TrialData] = []
        for trial, time, value, series in parts:
            noise = series.sigma if series.sigma_stated else FIRST_NOISE * sizes.length
            for n, index in enumerate(np.array_split(np.arange(time.size), PIECES)):
                weight = np.full((1, index.size), 1.0 / noise)
                block = Block(series.stream, (channel,), time[index], value[None, index], weight)
                ends = float(time[index[0]]), float(time[index[-1]])
                cut.append(TrialData(piece_id(trial.id, n), study.condition(trial), {}, (block,), *ends))
        self.trials = tuple(cut)
        self.stated = frozenset([channel] if parts[0][3].sigma_stated else [])
        self.doubted = doubted(study, trials, {channel}, zeros=False)  # its zero is free in every trial
        self.believed = Believed({}, {}, {}, conditions_of(cut), zeros=self.doubted.sigma)
        self._offset = {}
        for trial, time, value, _ in parts:
            apart = value - np.interp(time, *self._grid[trial.id])
            self._offset[trial.id] = float(np.median(apart)), float(np.std(apart))

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """Nothing but a sensor."""
        return Mechanism(coordinates={}, ports={}, sensors={b.stream: b.channels for b in trial.blocks})

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """Where the channel counts from."""
        guess, scale = self._offset[trial.recorded]
        (block,) = trial.blocks
        columns = self.doubted.of(trial.recorded, block.channels[0], block.time)
        beside = tuple((key, float(np.median(column))) for key, column in columns.items())
        return (Nuisance("zero", False, guess, max(scale, 1e-12), beside=beside),)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """The known motion as the sensor shows it."""
        grid, path = self._grid[trial.recorded]
        (block,) = trial.blocks
        maps = tuple(m for m in mechanism.maps if m.channel == block.channels[0])
        shown = through_sensor(maps, path, float(grid[1] - grid[0]))
        (zero,) = self.nuisances(trial)
        blocks = [np.interp(block.time, grid, shown)[None, :] + zero.true(float(initial[0]), mechanism)]
        self.take_off_beside(blocks, mechanism, trial)
        return Predicted(tuple(blocks))


def carried(study: Study) -> list[Prescribed]:
    """Models of bodies whose attitude a recorded joint prescribes: one input position, one measured yaw."""
    groups: dict[tuple[str, str], list[Trial]] = {}
    for trial in study.trials:
        recording = study.recording(trial)
        sources = [s.name for s in recording.inputs() if s.name.endswith(".position")]
        shown = [s.name for s in recording.outputs() if s.name.endswith(".yaw") and "velocity" not in s.name]
        if len(sources) == 1 and len(shown) == 1:
            groups.setdefault((shown[0], sources[0]), []).append(trial)
    return [Prescribed(study, trials, *names) for names, trials in groups.items()]
