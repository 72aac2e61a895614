"""A filtered and late reading of a motion that is a straight line: late by both, to the last digit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Readout
from spacerobot.simulation.sensors import read_channels

RATE = 0.3


class Line:
    """A run in which x = 0.3 t, from long ago."""

    start = -100.0

    def positions(self, times: np.ndarray) -> np.ndarray:
        return RATE * times[:, None]

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.positions(times), np.full((times.size, 1), RATE)

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        return states[:, 0]

    def switches(self) -> np.ndarray:
        return np.empty(0)


@pytest.mark.parametrize("delay", [0.0, 0.007])
@pytest.mark.parametrize("cutoff", [5.0, 200.0])
def test_a_ramp_comes_out_late_by_delay_and_time_constant(cutoff: float, delay: float) -> None:
    maps = (ChannelMap("x", "low_pass", cutoff), ChannelMap("x", "delay", delay))
    made = Mechanism(
        coordinates={"x": Coordinate("x", 1.0)},
        ports={"x": {"x": 1.0}},
        readouts={"x": Readout("x", "position", "x")},
        maps=maps,
    )
    times = np.linspace(0.0, 1.0, 101)
    run: Any = Line()
    shown = read_channels(run, made, ["x"], times)["x"]
    late = delay + 1.0 / (2.0 * np.pi * cutoff)
    assert np.abs(shown - RATE * (times - late)).max() < 2e-5 * RATE * late
