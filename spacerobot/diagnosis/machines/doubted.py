"""What a lab knows of a channel no better than to a standard deviation: its zero, the factors of other columns.

What was measured is x + b c, where the reading x has column c in it with a factor that is b more than believed. A fit
finds b: what is predicted is compared with the readings as they are, so that it lacks b c, and what is taken as it was
recorded (a drive, a start) has b c added to it. A zero is the factor of a column of -1.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spacerobot.diagnosis.terms.parameters import zero_key
from spacerobot.effects.mechanism import Mechanism
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError

BAR = "|"
"""Between a channel and a column of which it holds some; nothing behind it for the channel's zero."""


@dataclass(frozen=True, eq=False)
class Doubted:
    """Factors of columns in the channels of a machine.

    Attributes:
        sigma: "CHANNEL|COLUMN" -> standard deviation of the factor; "CHANNEL|" -> of the zero, in the channel's unit.
        columns: trial -> the same keys -> times [s] and the column in the channel's unit, shape (T,) each.
    """

    sigma: Mapping[str, float] = field(default_factory=dict)
    columns: Mapping[str, Mapping[str, tuple[np.ndarray, np.ndarray]]] = field(default_factory=dict)

    def only(self, wanted: Callable[[str], bool]) -> Doubted:
        """Of some channels alone."""
        sigma = {k: s for k, s in self.sigma.items() if wanted(k.partition(BAR)[0])}
        return Doubted(sigma, {t: {k: c for k, c in own.items() if k in sigma} for t, own in self.columns.items()})

    def of(self, trial: str, channel: str, time: np.ndarray) -> dict[str, np.ndarray]:
        """The columns in a channel at these times, shape (T,) each, by key."""
        own = self.columns.get(trial, {})
        return {k: np.interp(time, *own[k]) for k in own if k.partition(BAR)[0] == channel}

    def brought(self, mechanism: Mechanism, trial: str, channel: str, time: np.ndarray) -> np.ndarray:
        """What they add to a channel's readings at these times, shape (T,), with a mechanism's factors."""
        own = {k: by for k in self.sigma if k.partition(BAR)[0] == channel and (by := beyond(mechanism, k))}
        out = np.zeros_like(time)
        for key, column in self.of(trial, channel, time).items() if own else ():
            out += own.get(key, 0.0) * column
        return out

    def take_off(
        self,
        blocks: Sequence[np.ndarray],
        mechanism: Mechanism,
        trial: str,
        shown: Iterable[tuple[tuple[str, ...], np.ndarray]],
    ) -> None:
        """Take that off what is predicted.

        Args:
            blocks: what was predicted, shape (channels, times) each; changed in place.
            mechanism: with the factors.
            trial: as it was recorded.
            shown: channels and times of each block.
        """
        if not self.sigma:
            return
        for block, (channels, time) in zip(blocks, shown, strict=True):
            for row, channel in zip(block, channels, strict=True):
                row -= self.brought(mechanism, trial, channel, time)


NONE = Doubted()


def beyond(mechanism: Mechanism, key: str) -> float:
    """By how much a mechanism has a factor larger than believed."""
    return sum(m.value for m in mechanism.maps if m.channel == key and m.kind == "offset")


def doubted(study: Study, trials: Iterable[Trial], channels: Collection[str], *, zeros: bool = True) -> Doubted:
    """What a study doubts of these channels.

    Args:
        study: with its recordings.
        trials: whose columns are asked for.
        channels: that a machine reads.
        zeros: whether zeros are among it.
    """
    sigma: dict[str, float] = {}
    columns: dict[str, dict[str, tuple[np.ndarray, np.ndarray]]] = {}
    specs = {c.name: c for s in study.streams.values() for c in s.channels if c.name in channels}
    some = [n for n, c in specs.items() if c.plus_sigma or (zeros and c.offset_sigma > 0.0)]
    for trial in trials if some else ():
        recording, own = study.recording(trial), columns.setdefault(trial.id, {})
        for series in (recording[n] for n in some if n in recording):
            for name, (value, deviation) in series.beside.items():
                good = series.valid & np.isfinite(value)
                own[f"{series.name}{BAR}{name}"] = series.time[good], value[good]
                sigma[f"{series.name}{BAR}{name}"] = deviation
            if zeros and series.zero > 0.0:
                time, _ = series.good()
                own[f"{series.name}{BAR}"] = time, -np.ones_like(time)
                sigma[f"{series.name}{BAR}"] = series.zero
    return Doubted(sigma, columns)


def found_by_none(study: Study, taken: Iterable[str]) -> Iterator[InputError]:
    """Why a study's doubts cannot all be weighed: of some channels no fit of its machines finds them.

    Args:
        study: whose.
        taken: keys that its machines find.
    """
    known = set(taken)
    recorded = {name for trial in study.trials for name in trial.sources}
    for spec in (c for s in study.streams.values() if s.name in recorded for c in s.channels):
        own = {f"{spec.name}{BAR}{column}": f"{column} = " for column, _ in spec.plus_sigma}
        own |= {f"{spec.name}{BAR}": "offset_sigma"} if spec.offset_sigma > 0.0 else {}
        for key, said in own.items():
            if key in known or spec.name.startswith("aux."):
                continue
            column = key.partition(BAR)[2]
            what = f"the factor of {column} in {spec.name}" if column else f"the zero of {spec.name}"
            valid = f"the factor alone, plus = {{ {column} = 0.0 }}" if column else f"the channel without {said}"
            yield InputError(
                f"{what} is doubted, and no fit of this study's machines finds it",
                given=zero_key(key),
                valid=valid,
                where=spec.where,
            )
