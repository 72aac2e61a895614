"""A channel's samples in one trial."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spacerobot.recordings.table import Floats
from spacerobot.support.showing import Brief
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, repr=False)
class Series(Brief):
    """What one sensor said in one trial.

    Attributes:
        name: canonical channel.
        time: (n,) s, strictly increasing; the number of the event for an events stream.
        value: (n,) SI, NaN where not valid.
        valid: (n,) whether there was a reading.
        sigma: one standard deviation of the noise, SI: as the study states it, else estimated from the data
            (NaN for events).
        sigma_stated: whether the study states it.
        stream: name of the stream.
        clock: name of the clock; series of one clock share it exactly.
        unit: SI unit.
        use: "output" or "input".
        zero: one standard deviation of where its zero is, SI; 0 where it is exact.
        beside: other columns that come in by a factor which is doubted: name -> (n,) readings in this channel's unit,
            and the factor's standard deviation.
        frame: "body" of a force that was commanded along its body's axes; its values are along the world's.
    """

    name: str
    time: Floats
    value: Floats
    valid: NDArray[np.bool_]
    sigma: float
    sigma_stated: bool
    stream: str
    clock: str
    unit: str
    use: str = "output"
    zero: float = 0.0
    beside: Mapping[str, tuple[Floats, float]] = field(default_factory=dict, repr=False)
    frame: str = "world"

    def __len__(self) -> int:
        return len(self.time)

    @functools.cached_property
    def rate(self) -> float:
        """Median samples per second, Hz; NaN for fewer than two samples."""
        if len(self.time) < 2:
            return float("nan")
        return float(1.0 / np.median(np.diff(self.time)))

    def to_frame(self) -> pandas.DataFrame:
        """The samples over time, SI, as a table of pandas with one column.

        Raises:
            InputError: pandas is not installed.
        """
        return data_frame({self.name: self.value}, index=self.time, name="time", units={self.name: self.unit})

    def good(self) -> tuple[Floats, Floats]:
        """Times and values of the valid samples."""
        return self.time[self.valid], self.value[self.valid]


def estimate_noise(value: Floats, order: int = 3) -> float:
    """One standard deviation of white noise on a smooth signal, from its differences.

    The third difference of noise alone has variance 20 sigma^2 (sum of squared binomials 1, 3, 3, 1) and
    takes a quadratic trend away; the median absolute value (over 0.6745) does not see impacts.

    Args:
        value: (n,) samples at an even rate, NaN left out.
        order: of the differences; higher ones leave less of a motion that is quick beside the rate.

    Returns:
        The estimate, in the unit of `value`; NaN for fewer than `order` + 5 samples.
    """
    value = value[np.isfinite(value)]
    if len(value) < order + 5:
        return float("nan")
    difference = np.abs(np.diff(value, order)) / math.sqrt(math.comb(2 * order, order))
    estimate = float(np.median(difference) / 0.6744897501960817)
    return estimate if estimate > 0 else float(np.linalg.norm(difference) / np.sqrt(len(difference)))
