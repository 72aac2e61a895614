"""What a forward model owes the overlay, and what it hands over."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.recordings.values import kind
from spacerobot.support.errors import NotFoundError
from spacerobot.support.showing import Brief
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class ChannelOverlay(Brief):
    """One channel of one trial, measured and simulated. T samples, SI.

    Attributes:
        channel: canonical name.
        unit: SI unit.
        time: shape (T,) [s].
        measured, simulated: shape (T,).
        sigma: one standard deviation of the noise.
        sigma_stated: whether the study states it; else it is estimated from the recording.
        focus: the stretch of time worth a close look [s], or None for all.
        restarts: times at which the simulation started anew from the recording, ascending, shape (R,) [s].
    """

    channel: str
    unit: str
    time: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    sigma: float
    sigma_stated: bool
    focus: tuple[float, float] | None = None
    restarts: np.ndarray | None = None

    @property
    def residual(self) -> np.ndarray:
        """Predicted minus measured, shape (T,)."""
        return np.asarray(self.simulated - self.measured)

    def to_frame(self) -> pandas.DataFrame:
        """Measured, simulated and residual over time, SI, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        columns = {"measured": self.measured, "simulated": self.simulated, "residual": self.residual}
        return data_frame(
            columns, index=self.time, name="time", units={"time": "s", **dict.fromkeys(columns, self.unit)}
        )


@dataclass(frozen=True, eq=False, repr=False)
class TrialOverlay(Brief):
    """One trial, measured and simulated.

    Attributes:
        id, condition: of the trial.
        channels: those that the baseline predicts.
        touches: predicted times of touch [s].
    """

    id: str
    condition: str
    channels: tuple[ChannelOverlay, ...]
    touches: tuple[float, ...] = ()

    def __getitem__(self, channel: str) -> ChannelOverlay:
        """The channel of this name.

        Raises:
            NotFoundError: the baseline does not predict it.
        """
        for found in self.channels:
            if found.channel == channel:
                return found
        raise NotFoundError("channel", channel, (c.channel for c in self.channels), where=f"trial {self.id}")


@dataclass(frozen=True)
class Value:
    """A value that the simulation took.

    Attributes:
        name: dotted.
        value: SI.
        unit: SI unit.
        source: "believed", "default: ...", or how else it was come by.
    """

    name: str
    value: float
    unit: str
    source: str = "believed"


class ForwardModel(ABC):
    """The baseline of one kind of study, ready to simulate its trials.

    A new kind is a new file: say in `applies` which studies it serves, in `values` and `assumptions` what it took
    for granted, and list it in `choose.MODELS`.
    """

    kind: ClassVar[str]
    """What is simulated, one line."""

    @classmethod
    @abstractmethod
    def applies(cls, study: Study) -> bool:
        """Whether the study is of this kind, from its baseline and channels alone."""

    @classmethod
    @abstractmethod
    def of(cls, study: Study) -> Self:
        """The model of a study it applies to.

        Raises:
            InputError: the study lacks what the simulation needs.
        """

    @property
    @abstractmethod
    def values(self) -> tuple[Value, ...]:
        """The values that the simulation takes, before the trials' overrides."""

    @property
    @abstractmethod
    def assumptions(self) -> tuple[str, ...]:
        """What else was taken for granted, a sentence each; a trial's start among it."""

    @property
    def given(self) -> frozenset[str]:
        """Channels that it takes as they were recorded, beside the inputs."""
        return frozenset()

    @abstractmethod
    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial from its own initial state.

        Raises:
            InputError: the trial lacks a channel that the start needs.
            SimulationError: the simulation could not be finished.
        """


def overlaid(
    series: Series,
    simulated: np.ndarray,
    *,
    focus: tuple[float, float] | None = None,
    restarts: np.ndarray | None = None,
) -> ChannelOverlay:
    """A channel's valid samples beside its simulation, shape (len(series),)."""
    good = series.valid & np.isfinite(simulated)
    return ChannelOverlay(
        series.name,
        series.unit,
        series.time[good],
        series.value[good],
        simulated[good],
        series.sigma,
        series.sigma_stated,
        focus,
        restarts,
    )


def channels_of(study: Study, use: str | None = None) -> set[str]:
    """Names of the channels that some trial has, all or those of one `use` ("input" or "output")."""
    used = {name for trial in study.trials for name in trial.sources}
    return {c.name for s in study.streams.values() if s.name in used for c in s.channels if use is None or c.use == use}


def unit_of(name: str) -> str:
    """SI unit of a believed value or a value of the rig, by dotted name."""
    if name == "gravity.along":
        return "m/s2"
    return kind(name).unit
