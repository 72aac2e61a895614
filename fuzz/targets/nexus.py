"""Vicon's CSV export."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from fuzz.targets.csv import studies

_STREAMS = (
    'time = "time"\nchannels."Rig:box.position.x" = { is = "target.x" }',
    'time = "time"\nformat = "nexus"\nrows = [0, 2]\nchannels.3 = { is = "contact.force" }',
)

_TRIAL = b"""Devices
200
,,Plate - Force,,Plate - Moment
Frame,Sub Frame,Fx,Fy,Mx
,,N,N,N.mm
1,0,0.1,1000,0.3
1,1,0.1,,0.3
2,0,0.2,1002,0.3

Trajectories
100
,,Rig:box,,
Frame,Sub Frame,X,Y,Z
,,mm,mm,mm
1,0,1,2,3
2,0,,,
"""
_TRACKER = _TRIAL[_TRIAL.index(b"Traj") :].replace(b"\n", b"\r\n")


def _prepare(folder: Path) -> Callable[[bytes], None]:
    return studies(folder, _STREAMS, "csv")


TARGET = Target(
    "nexus",
    _prepare,
    tuple(bytes([i]) + text for i in range(2) for text in (_TRIAL, _TRACKER)),
    ("Frame,Sub Frame,", "Trajectories", "Objects", "Devices", "TX", "RX", '"', ",,", "\n\n", "nan"),
    cases=60_000,
)
