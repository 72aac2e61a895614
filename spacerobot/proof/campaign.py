"""A campaign: what the lab believes, what is built, what is hidden, and the trials; written as a study and a seal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.proof.engine.arm import ArmRig
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.physics import apply
from spacerobot.proof.engine.rig import Rig, Values
from spacerobot.proof.engine.run import run
from spacerobot.proof.engine.sensors import COLUMNS, Channel, Reading, Stream, read, spoil
from spacerobot.support.errors import InputError
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps

UNLUCKY = 2.5
"""Standard deviations beyond which a believed value that was drawn is as good as wrong: one in 80 lies there."""


@dataclass(frozen=True)
class Trial:
    """One trial as it is run.

    Attributes:
        id: in the study.
        values: the rig as built, in this trial.
        overrides: what the study says of this trial, by dotted name.
        position, velocity: start, by joint of the engine.
        duration: in s.
    """

    id: str
    values: Values
    overrides: Mapping[str, float]
    position: Mapping[str, float]
    velocity: Mapping[str, float]
    duration: float


@dataclass(frozen=True)
class Belief:
    """What the study states.

    Attributes:
        head: keys of [baseline] itself: robot, base, joints, approach, gravity.
        values: dotted name -> believed value.
        sigma, scatter: dotted name -> relative standard deviation.
    """

    head: Mapping[str, Any]
    values: Mapping[str, Any]
    sigma: Mapping[str, float]
    scatter: Mapping[str, float] = field(default_factory=dict)

    def moved(self, **changes: float) -> Belief:
        """With values replaced; names with __ for the dot."""
        return replace(self, values={**self.values, **{k.replace("__", "."): v for k, v in changes.items()}})


@dataclass(frozen=True)
class Campaign:
    """A campaign before it is run.

    Attributes:
        title: of the study; says nothing of what is hidden.
        belief: what the lab states.
        as_built: dotted name -> true value, of the same names.
        trials: in the order in which they were taken.
        streams: the instruments.
        missing: what is hidden.
        seed: of the noise.
        family: scene: "rig", "spinning", "chaser" or "servo arm".
    """

    title: str
    belief: Belief
    as_built: Mapping[str, float]
    trials: tuple[Trial, ...]
    streams: tuple[Stream, ...]
    missing: tuple[Missing, ...] = ()
    seed: int = 0
    family: str = "rig"

    def rig(self, number: int) -> Rig:
        """The engine's rig of a trial, counted from 0, without what is hidden."""
        values = self.trials[number].values
        if self.family in ("chaser", "servo arm"):
            return ArmRig(values, trial=number, floating=self.family == "chaser")
        return Rig(values, trial=number)

    def unlucky(self) -> tuple[str, ...]:
        """Believed values that happen to lie further off than a lab would think: to say so is no error."""

        def off(name: str) -> float:
            if name in self.belief.values and name in self.as_built:
                return float(self.as_built[name]) / float(self.belief.values[name]) - 1.0
            return self.as_built.get(f"{name} over believed", 1.0) - 1.0

        return tuple(n for n, sigma in self.belief.sigma.items() if abs(off(n)) > UNLUCKY * sigma)

    def with_missing(self, *missing: Missing) -> Campaign:
        """The same campaign with other hidden physics."""
        return replace(self, missing=missing)


Readings = dict[str, dict[str, Reading]]
"""Trial id -> stream -> reading."""


def perform(campaign: Campaign) -> Readings:
    """Run every trial in MuJoCo and read the instruments, without noise.

    Raises:
        InputError: the tip never touches in a trial.
    """
    found: Readings = {}
    for number, trial in enumerate(campaign.trials):
        missing = tuple(m.at(number) for m in campaign.missing)
        rig = apply(campaign.rig(number), missing)
        position, velocity = dict(trial.position), dict(trial.velocity)
        log = run(rig, position, velocity, trial.duration)
        if not log.touches:
            raise InputError("the tip never touches", given=trial.id, where=campaign.title)
        faults = [m for m in missing if m.at_sensor and m.shows(number)]
        found[trial.id] = {
            s.name: read(log, s, tuple(f for f in faults if f.where == s.sensor)) for s in campaign.streams
        }
    return found


def noisy(campaign: Campaign, clean: Readings) -> Readings:
    """The readings with the instruments' noise, from the campaign's seed."""
    rng = np.random.default_rng([campaign.seed, 77])
    return {
        trial: {s.name: spoil(streams[s.name], s, rng) for s in campaign.streams} for trial, streams in clean.items()
    }


def write_study(folder: Path, campaign: Campaign, readings: Readings, *, exact: bool = False) -> Path:
    """Write study.toml and a file for each trial and stream; returns the study file.

    Args:
        folder: where.
        campaign: whose.
        readings: of its trials.
        exact: write all digits, not those of the instruments, and their noise in any case: such readings show none.
    """
    for trial in campaign.trials:
        for stream in campaign.streams:
            text = _table(stream, readings[trial.id][stream.name], exact)
            write_text(folder / f"{trial.id}_{stream.name}.csv", text)
    path = folder / "study.toml"
    write_text(path, study_text(campaign, every_sigma=exact))
    return path


def seal(campaign: Campaign, about: Mapping[str, Any]) -> str:
    """What is hidden, as the text (JSON) that is opened after the diagnosis; `about` goes in beside the effects."""
    truth = {
        "effects": [m.as_json() for m in campaign.missing],
        "rig_as_built": dict(campaign.as_built),
        **about,
    }
    return dumps(truth) + "\n"


def study_text(campaign: Campaign, *, every_sigma: bool = False) -> str:
    """The study file, format 1; with every instrument's noise if asked for, else that which the lab states."""
    belief = campaign.belief
    lines = ["format = 1", f'title = "{campaign.title}"', "", "[baseline]"]
    lines += [f"{key} = {_toml(value)}" for key, value in belief.head.items()]
    groups: dict[str, list[str]] = {}
    for name, value in belief.values.items():
        group, key = name.rsplit(".", 1)
        groups.setdefault(group, []).append(f"{key} = {_toml(value)}")
    for group, rows in groups.items():
        lines += ["", f"[baseline.{group}]", *rows]
    for title, table in (("sigma", belief.sigma), ("scatter", belief.scatter)):
        if table:
            lines += ["", f"[baseline.{title}]", *(f'"{name}" = {value!r}' for name, value in table.items())]
    for stream in campaign.streams:
        lines += ["", f"[streams.{stream.name}]", 'time = "time_s"', f"[streams.{stream.name}.channels]"]
        lines += [f"{column(c.name)} = {_said(c, every_sigma)}" for c in stream.channels]
    for trial in campaign.trials:
        lines += ["", "[[trials]]", f'id = "{trial.id}"']
        lines += [f"{name} = {_toml(value)}" for name, value in trial.overrides.items()]
        lines += [f'{s.name} = "{trial.id}_{s.name}.csv"' for s in campaign.streams]
    return "\n".join(lines) + "\n"


def _said(channel: Channel, sigma: bool) -> str:
    stated = f", sigma = {channel.sigma!r}" if sigma or channel.stated else ""
    return f'{{ is = "{channel.name}"{stated} }}'


def column(channel: str) -> str:
    """Column of a channel: the rig's own names, else the channel's with underscores."""
    return COLUMNS.get(channel, channel.replace(".", "_"))


def _table(stream: Stream, reading: Reading, exact: bool) -> str:
    extra = 5 if exact else 0
    digits = [max(0, math.ceil(-math.log10(c.quantum) - 1e-9)) + extra for c in stream.channels]
    columns = [reading.value[c.name] for c in stream.channels]
    rows = [",".join(["time_s", *(column(c.name) for c in stream.channels)])]
    for i in np.flatnonzero(~reading.lost):
        cells = ["" if np.isnan(v[i]) else f"{v[i]:.{d}f}" for v, d in zip(columns, digits, strict=True)]
        rows.append(",".join([f"{reading.time[i]:.5f}", *cells]))
    return "\n".join(rows) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    return repr(float(value)) if isinstance(value, float | np.floating) else repr(value)
