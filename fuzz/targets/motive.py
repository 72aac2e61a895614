"""Motive's CSV export."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from fuzz.targets.csv import studies

_STREAMS = (
    'time = "Time"\nchannels."Target.position.x" = { is = "target.x" }',
    'time = "Frame"\nformat = "motive"\nchannels."m1.position.z" = { is = "marker.m1.position.z", unit = "mm" }',
    'time = 1\nformat = "motive"\nrows = [0, 2]\nchannels.2 = { is = "target.x" }',
)

_OLD = b"""Format Version,1.21,Take Name,Take 1,Rotation Type,Quaternion,Length Units,Millimeters

,,Rigid Body,Rigid Body,Rigid Body,Marker
,,Target,Target,Target,m1
,,"1F","1F","1F","2F"
,,Rotation,Position,Error Per Marker,Position
Frame,Time,X,X,,Z
0,0.0,0.1,1000,0.3,3
1,0.0083,,,,6
2,0.0167,0.2,1002,0.3,
"""
_NEW = b"""\xef\xbb\xbfFormat Version,1.23,Take Name,Take 2,Length Units,Meters\r
,Type,Rigid Body,Rigid Body Marker,Marker\r
,Name,Target,Target:Marker1,m1\r
,ID,1F,2F,3F\r
,Parent,,Target,Target\r
,,Position,Position,Position\r
Frame,Time (Seconds),X,X,Z\r
0,0.0,1,3,4\r
1,0.01,1,3,4\r
"""


def _prepare(folder: Path) -> Callable[[bytes], None]:
    return studies(folder, _STREAMS, "csv")


TARGET = Target(
    "motive",
    _prepare,
    tuple(bytes([i]) + text for i in range(3) for text in (_OLD, _NEW)),
    (
        "Format Version",
        "Frame,",
        "Length Units",
        "Feet",
        "Rigid Body",
        "Position",
        "Rotation",
        "Time",
        '"',
        ",,",
        "nan",
    ),
    cases=250_000,
)
