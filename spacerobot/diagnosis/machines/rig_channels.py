"""What of a study's streams a wrist rig reads: which channels, by which sensors, from which zeros and clocks."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.diagnosis.machines.robot_channels import robot_channels
from spacerobot.recordings.study import Study
from spacerobot.simulation.rig import rig


def turning(study: Study) -> bool:
    """Whether the target may turn: its yaw inertia is stated."""
    return math.isfinite(study.values().get("target.yaw_inertia", math.nan))


def readable(study: Study) -> frozenset[str]:
    """Channels that the rig of this baseline has a readout for; any other is left aside."""
    own = rig({"target.yaw_inertia": 1.0} if turning(study) else {}, lateral=True).readouts
    return frozenset(own) | robot_channels(study)


def sensors_of(study: Study) -> dict[str, tuple[str, ...]]:
    """Sensors by the names verdicts use: force_sensor, mocap, otherwise the stream's own."""
    found: dict[str, tuple[str, ...]] = {}
    shown = readable(study)
    for stream in study.streams.values():
        names = tuple(c.name for c in stream.channels if c.name in shown)
        if not names:
            continue
        if all(n == "contact.force" for n in names):
            label = "force_sensor"
        elif all(n.split(".")[-1] in ("x", "y", "z", "yaw") for n in names):
            label = "mocap"
        else:
            label = stream.name
        found[label] = (*found.get(label, ()), *names)
    return found


def zeros_of(study: Study, shown: set[str]) -> dict[str, float]:
    """Channels whose zero the lab has found, with its standard deviation [SI]."""
    stated = {c.name for s in study.streams.values() for c in s.channels if c.name in shown and c.offset_sigma > 0.0}
    rows = (study.recording(t) for t in study.trials) if stated else ()
    return {name: r[name].zero for r in rows for name in r if name in stated}


def own_clocks(study: Study, sensors: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """ "SENSOR.clock" of each sensor whose clocks no other sensor shares, where there are several clocks."""
    clock_of = {c.name: s.clock for s in study.streams.values() for c in s.channels}
    clocks = {sensor: {clock_of[c] for c in channels} for sensor, channels in sensors.items()}
    if len(set().union(*clocks.values())) < 2:
        return ()
    others = {s: set().union(*(c for other, c in clocks.items() if other != s)) for s in clocks}
    return tuple(f"{s}.clock" for s, own in clocks.items() if not own & others[s])
