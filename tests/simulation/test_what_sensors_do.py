"""What a sensor does to a reading, each against its definition: late, weak, shifted, and riding on what it measures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.sensors import read_channels

RIG = rig({"wrist.stiffness": 1020.0, "wrist.damping": 3.0, "contact.damping": 60.0})
TIMES = np.arange(0.02, 0.4, 1e-3)


@pytest.fixture(scope="module")
def run() -> ReducedRun:
    return simulate(RIG, position={"target": -0.005}, velocity={"target": 0.1}, end=0.42, tolerance=1e-10)


def shown(
    run: ReducedRun, name: str, sensor: str, values: dict[str, float], times: np.ndarray
) -> dict[str, np.ndarray]:
    """Channels of a sensor with an effect at it."""
    mechanism: Mechanism = effect(name).apply(RIG, sensor, values)
    return read_channels(run, mechanism, RIG.sensors[sensor], times)


def plain(run: ReducedRun, sensor: str, times: np.ndarray) -> dict[str, np.ndarray]:
    return read_channels(run, RIG, RIG.sensors[sensor], times)


@pytest.mark.parametrize("sensor", ["force_sensor", "mocap"])
@pytest.mark.parametrize("delay", [0.004, -0.003])
def test_a_late_reading_shows_what_was(run: ReducedRun, sensor: str, delay: float) -> None:
    late, before = shown(run, "time_offset", sensor, {"delay_s": delay}, TIMES), plain(run, sensor, TIMES - delay)
    for name, value in late.items():
        np.testing.assert_allclose(value, before[name], atol=1e-12)


@pytest.mark.parametrize("sensor", ["force_sensor", "mocap"])
def test_a_scale_multiplies_and_a_bias_adds(run: ReducedRun, sensor: str) -> None:
    usual = plain(run, sensor, TIMES)
    for name, value in shown(run, "scale", sensor, {"factor": 1.07}, TIMES).items():
        np.testing.assert_allclose(value, 1.07 * usual[name], rtol=1e-12)
    for name, value in shown(run, "bias", sensor, {"value": -0.3}, TIMES).items():
        np.testing.assert_allclose(value, usual[name] - 0.3, rtol=1e-12)


def test_a_gain_acts_before_an_offset(run: ReducedRun) -> None:
    """As MAP_ORDER says, in whatever order they are written down."""
    usual = plain(run, "force_sensor", TIMES)["contact.force"]
    both = [("scale", {"factor": 2.0}), ("bias", {"value": 1.0})]
    for order in (both, both[::-1]):
        machine = RIG
        for name, values in order:
            machine = effect(name).apply(machine, "force_sensor", values)
        found = read_channels(run, machine, ("contact.force",), TIMES)["contact.force"]
        np.testing.assert_allclose(found, 2.0 * usual + 1.0, rtol=1e-12)


def test_a_sensor_that_rides_on_the_slider_reads_less_by_its_mass_times_acceleration(run: ReducedRun) -> None:
    """F_read = F - m a: while the target pushes the slider in, the sensor's mass takes its share of the push."""
    mass = 0.2
    found = shown(run, "sensor_inertia", "force_sensor", {"mass_kg": mass}, TIMES)["contact.force"]
    index = list(run.layout.coordinates).index("wrist")
    acceleration = run.sample(TIMES).acceleration[:, index]
    assert np.abs(acceleration).max() > 1.0
    np.testing.assert_allclose(
        found, plain(run, "force_sensor", TIMES)["contact.force"] - mass * acceleration, atol=1e-9
    )


@pytest.mark.parametrize("cutoff", [3.0, 20.0])
def test_a_filter_lags_and_weakens_a_wave_as_its_transfer_function(cutoff: float) -> None:
    """1/(1 + i f/f_c), of `through_sensor` on measured motion as of the simulated channels."""
    step, frequency = 1e-3, 5.0
    time = np.arange(0.0, 4.0, step)
    wave = np.exp(2j * np.pi * frequency * time)
    maps = (ChannelMap("x", "low_pass", cutoff),)
    found = through_sensor(maps, wave.real, step) + 1j * through_sensor(maps, wave.imag, step)
    settled = time > 2.0
    response = np.mean(found[settled] / wave[settled])
    assert abs(response - 1.0 / (1.0 + 1j * frequency / cutoff)) < 0.02


@pytest.mark.parametrize("step", [0.5, 0.05])
def test_a_filter_answers_a_ramp_as_its_equation_does_whatever_the_step(step: float) -> None:
    """y = t - tau (1 - exp(-t / tau)): a filter that took a line for steps would be early or late by half of one."""
    time, cutoff = np.arange(0.0, 5.0, step), 0.4
    tau = 1.0 / (2.0 * np.pi * cutoff)
    found = through_sensor((ChannelMap("x", "low_pass", cutoff),), time, step)
    np.testing.assert_allclose(found, time - tau * (1.0 - np.exp(-time / tau)), atol=1e-12)


@pytest.mark.parametrize("delay", [0.05, -0.02])
def test_measured_motion_is_late_in_the_same_sense(delay: float) -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    found = through_sensor((ChannelMap("x", "delay", delay),), np.sin(3.0 * time), 1e-3)
    inner = slice(100, -100)
    np.testing.assert_allclose(found[inner], np.sin(3.0 * (time - delay))[inner], atol=1e-5)


def test_measured_motion_is_scaled_before_it_is_shifted() -> None:
    maps = (ChannelMap("x", "offset", 1.0), ChannelMap("x", "gain", 2.0))
    np.testing.assert_allclose(through_sensor(maps, np.arange(5.0), 0.1), 2.0 * np.arange(5.0) + 1.0)


def test_delays_of_one_channel_add_up(run: ReducedRun) -> None:
    """A sensor's own and that of the whole stream, for instance: what is late twice is late by both."""
    maps = tuple(ChannelMap("contact.force", "delay", value) for value in (0.003, 0.002))
    seen = read_channels(run, replace(RIG, maps=maps), ("contact.force",), TIMES)["contact.force"]
    np.testing.assert_allclose(seen, plain(run, "force_sensor", TIMES - 0.005)["contact.force"], atol=1e-12)


def test_channels_read_together_show_what_each_shows_alone(run: ReducedRun) -> None:
    channels = list(RIG.readouts)[::-1]
    together = read_channels(run, RIG, channels, TIMES)
    assert list(together) == channels
    for name, value in together.items():
        np.testing.assert_allclose(value, read_channels(run, RIG, [name], TIMES)[name], rtol=1e-13, atol=1e-16)
