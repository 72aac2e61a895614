"""Recordings as labs have them: ways in which readings, their noise or a trial's label are not what the study says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, filtfilt

from spacerobot.proof.campaign import Campaign, Readings, noisy
from spacerobot.proof.engine.sensors import Reading

Spoilt = tuple[Campaign, Readings]
Label = tuple[str, str]


@dataclass(frozen=True)
class Way:
    """One way of spoiling a campaign.

    Attributes:
        spoil: the campaign, its readings without noise and a source of chance -> what the lab holds in its hands.
        effects: labels under which it may rightly be named.
        values: believed values that may rightly be said to be wrong.
        refused: whether the honest answer is to refuse the study.
    """

    spoil: Callable[[Campaign, Readings, np.random.Generator], Spoilt]
    effects: tuple[Label, ...] = ()
    values: tuple[str, ...] = ()
    refused: bool = False


def _tracks(campaign: Campaign) -> dict[str, tuple[str, float]]:
    """Channel -> (stream, sigma) of what is measured in metres."""
    found = {c.name: (s.name, c.sigma) for s in campaign.streams for c in s.channels}
    return {name: own for name, own in found.items() if not name.endswith((".force", ".yaw"))}


def _each(campaign: Campaign, readings: Readings, stream: str, change: Callable[[Reading, int], Reading]) -> Readings:
    """The readings with one stream changed; `change` is told the number of the trial."""
    trials = [t.id for t in campaign.trials]
    return {t: {**own, stream: change(own[stream], trials.index(t))} for t, own in readings.items()}


def _channel(
    campaign: Campaign, readings: Readings, name: str, change: Callable[[np.ndarray, int], np.ndarray]
) -> Readings:
    stream = next(s.name for s in campaign.streams if any(c.name == name for c in s.channels))

    def on(reading: Reading, number: int) -> Reading:
        return replace(reading, value={**reading.value, name: change(reading.value[name].copy(), number)})

    return _each(campaign, readings, stream, on)


def _one_glitch(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """One reading of one trial 5 mm off."""
    trial = int(rng.integers(len(campaign.trials)))

    def change(value: np.ndarray, number: int) -> np.ndarray:
        if number == trial:
            value[int(rng.integers(value.size // 4, value.size))] += 5e-3
        return value

    return campaign, _channel(campaign, noisy(campaign, clean), "target.x", change)


def _outliers(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """One reading of two hundred is 10 to 60 sigmas off, in every channel."""
    readings = noisy(campaign, clean)
    for stream in campaign.streams:
        for channel in stream.channels:

            def change(value: np.ndarray, number: int, sigma: float = channel.sigma) -> np.ndarray:
                at = np.flatnonzero(rng.random(value.size) < 0.005)
                value[at] += sigma * rng.choice([-1.0, 1.0], at.size) * rng.uniform(10.0, 60.0, at.size)
                return value

            readings = _channel(campaign, readings, channel.name, change)
    return campaign, readings


def _heavy_tails(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Noise of Student's t with three degrees of freedom, its standard deviation the stated one."""
    readings = clean
    for stream in campaign.streams:
        for channel in stream.channels:

            def change(value: np.ndarray, number: int, sigma: float = channel.sigma) -> np.ndarray:
                return np.asarray(value + sigma * rng.standard_t(3.0, value.size) / np.sqrt(3.0))

            readings = _channel(campaign, readings, channel.name, change)
    return campaign, readings


def _swapped(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Target's and wrist's markers taken for each other for some readings of two trials."""
    chosen = set(rng.choice(len(campaign.trials), 2, replace=False).tolist())

    def change(reading: Reading, number: int) -> Reading:
        if number not in chosen:
            return reading
        begin, count = int(rng.integers(reading.time.size // 4, reading.time.size - 12)), int(rng.integers(3, 9))
        one, other = reading.value["target.x"].copy(), reading.value["wrist.x"].copy()
        rows = slice(begin, begin + count)
        one[rows], other[rows] = other[rows].copy(), one[rows].copy()
        return replace(reading, value={**reading.value, "target.x": one, "wrist.x": other})

    return campaign, _each(campaign, noisy(campaign, clean), "mocap", change)


def _stated(factor: float) -> Callable[[Campaign, Readings, np.random.Generator], Spoilt]:
    """Sigmas of the tracks stated wrongly by a factor."""

    def spoil(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
        streams = tuple(
            replace(s, channels=tuple(replace(c, sigma=c.sigma * factor) for c in s.channels))
            if s.name == "mocap"
            else s
            for s in campaign.streams
        )
        return replace(campaign, streams=streams), noisy(campaign, clean)

    return spoil


def _smoothed(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Tracks filtered forwards and backwards at a seventh of their rate, as motion capture's software offers."""
    readings = noisy(campaign, clean)
    b, a = butter(2, 2.0 / 7.0)
    for name in _tracks(campaign):

        def change(value: np.ndarray, number: int) -> np.ndarray:
            bad = np.isnan(value)
            index = np.arange(value.size)
            whole = np.interp(index, index[~bad], value[~bad])
            out = np.asarray(filtfilt(b, a, whole))
            out[bad] = np.nan
            return out

        readings = _channel(campaign, readings, name, change)
    return campaign, readings


def _rounded(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Tracks in whole millimetres."""
    readings = noisy(campaign, clean)
    for name in _tracks(campaign):
        readings = _channel(campaign, readings, name, lambda value, number: np.round(value, 3))
    return campaign, readings


def _clipped(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """The force sensor ends at 0.7 of the largest force."""
    readings = noisy(campaign, clean)
    top = max(float(np.nanmax(own["force"].value["contact.force"])) for own in readings.values())
    return campaign, _channel(
        campaign, readings, "contact.force", lambda value, number: np.minimum(value, round(0.7 * top, 2))
    )


def _gaps(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Markers hidden for a tenth of each trial, in three pieces."""

    def change(reading: Reading, number: int) -> Reading:
        size, lost = reading.time.size, reading.lost.copy()
        for begin in rng.integers(size // 10, size - size // 20, 3):
            lost[begin : begin + size // 30] = True
        return replace(reading, lost=lost)

    return campaign, _each(campaign, noisy(campaign, clean), "mocap", change)


def _jitter(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """Time stamps of the tracks off by a tenth of a period, one by one."""
    rate = next(s.rate for s in campaign.streams if s.name == "mocap")

    def change(reading: Reading, number: int) -> Reading:
        return replace(reading, time=np.sort(reading.time + 0.1 / rate * rng.standard_normal(reading.time.size)))

    return campaign, _each(campaign, noisy(campaign, clean), "mocap", change)


def _cut_short(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """The last number of one file lost its last digits when the disk was full."""
    trial = int(rng.integers(len(campaign.trials)))

    def change(value: np.ndarray, number: int) -> np.ndarray:
        if number == trial:
            value[-1] = np.trunc(value[-1] * 10.0) / 10.0
        return value

    return campaign, _channel(campaign, noisy(campaign, clean), "wrist.x", change)


def _mislabelled(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """One trial states another target's mass."""
    choices = [i for i, t in enumerate(campaign.trials) if "target.mass" in t.overrides]
    masses = sorted({float(t.overrides["target.mass"]) for t in campaign.trials if "target.mass" in t.overrides})
    at = int(rng.choice(choices))
    own = float(campaign.trials[at].overrides["target.mass"])
    other = float(rng.choice([m for m in masses if m != own])) if len(masses) > 1 else 1.25 * own
    trials = tuple(
        replace(t, overrides={**t.overrides, "target.mass": other}) if i == at else t
        for i, t in enumerate(campaign.trials)
    )
    return replace(campaign, trials=trials), noisy(campaign, clean)


def _second_day(campaign: Campaign, clean: Readings, rng: np.random.Generator) -> Spoilt:
    """The force sensor reads 5 % more in the second half of the trials."""
    half = len(campaign.trials) // 2
    return campaign, _channel(
        campaign,
        noisy(campaign, clean),
        "contact.force",
        lambda value, number: value * (1.05 if number >= half else 1.0),
    )


WAYS: dict[str, Way] = {
    "one glitch": Way(_one_glitch),
    "outliers": Way(_outliers),
    "heavy tails": Way(_heavy_tails),
    "swapped markers": Way(_swapped),
    "sigma halved": Way(_stated(0.5)),
    "sigma doubled": Way(_stated(2.0)),
    "sigma of another unit": Way(_stated(1000.0), refused=True),
    "smoothed": Way(_smoothed, effects=(("low_pass", "mocap"),)),
    "rounded": Way(_rounded),
    "clipped": Way(_clipped),
    "gaps": Way(_gaps),
    "jitter": Way(_jitter),
    "cut short": Way(_cut_short),
    "mislabelled": Way(_mislabelled, values=("target.mass",)),
    "second day": Way(_second_day, effects=(("scale", "force_sensor"), ("scale", "mocap"))),
}
"""By name."""
