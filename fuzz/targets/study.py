"""A study file, beside recordings and traps that it may name."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import numpy as np

from fuzz.target import Target
from spacerobot.recordings import stream, trial, units, values
from spacerobot.recordings.readers import sandbox
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

GOOD = b"""format = 1
title = "A small study"
data = "data"
[baseline]
robot = "pa10_wrist"
base = "fixed"
joints = "locked"
pose_deg = [0, 45, 0, 90, 0, -45, 0]
approach = [1, 0, 0]
[baseline.wrist]
mass = 0.7
stiffness = "unknown"
[baseline.contact]
law = "hertz"
stiffness = 68000
[baseline.target]
contact_point = [0.1, 0.02]
[baseline.joint.S1]
kp = 10
[baseline.sigma]
"wrist.mass" = 0.01
[baseline.scatter]
"target.mass" = 0.01
[streams.mocap]
time = "t"
time_unit = "ms"
missing = [-999]
repeated = "drop"
sort = true
[streams.mocap.channels]
x = { is = "target.x", sigma = 1e-4, unit = "mm", scale = 2, offset = -1 }
y = [{ is = "wrist.x" }, { is = "aux.y", use = "input" }]
[streams.other]
rate = 100
clock = "own"
format = "npz"
variable = "x"
rows = [0, 3]
channels.0 = { is = "contact.force" }
[[trials]]
id = "01"
target.mass = 9.0
window = [0, 8]
mocap = "01.csv"
[[trials]]
each = [2, 3]
id = "{n:02d}"
condition = "slow"
mocap = { file = "01.csv", rows = [0, 2] }
other = "a.npz"
"""

EVENTS = b"""format = 1
[baseline]
base = "free"
[baseline.body]
mass = 2
inertia = [1, 1, 1]
[streams.hits]
time = 0
kind = "events"
separator = "comma"
header_rows = 1
decimal = "."
encoding = "utf-8"
compression = "none"
[streams.hits.channels]
x = [{ is = "body.velocity.x", moment = "before" }, { is = "aux.v", moment = "after" }]
y = { is = "body.yaw", unit = "deg", unwrap = true }
[[trials]]
id = "a"
hits = "data/01.csv"
"""


def _prepare(folder: Path) -> Callable[[bytes], None]:
    (folder / "data").mkdir()
    (folder / "data" / "01.csv").write_text("t,x,y\n0,1,2\n1,2,3\n2,4,5\n3,6,7\n4,8,9\n")
    np.savez(folder / "data" / "a.npz", x=np.arange(5.0))
    (folder / "data" / "a.mat").write_bytes(b"MATLAB 5.0" + bytes(200))
    for name, target in (("passwd", "/etc/passwd"), ("up", "../.."), ("round", "round")):
        os.symlink(target, folder / "data" / name)
    os.mkfifo(folder / "data" / "pipe")
    os.environ.pop("SPACEROBOT_DATA", None)
    sandbox._ask = _no_child  # binary files have a harness of their own
    file = folder / "study.toml"

    def read(data: bytes) -> None:
        file.write_bytes(data)
        study = load_study(folder)
        study.recordings()
        study.conditions()
        study.channels()
        assert study.robot_source is None or len(study.input_hash) == 64

    return read


def _no_child(path: Path, *_: object) -> NoReturn:
    raise InputError("not read here", where=str(path))


_TRAPS = ("data/passwd", "data/up/etc/passwd", "../x", "/etc/passwd", "data/pipe", "data/round", "${SPACEROBOT_DATA}/x")
_WORDS = (
    *stream._KEYS, *stream._CHANNEL_KEYS, *trial._KEYS, *trial._SOURCE_KEYS, *values.GROUPS, *stream.FORMATS,
    *stream.ENCODINGS, *stream.COMPRESSIONS, *units.UNITS, *_TRAPS, "nan", "inf", "1e999", "-1", "[[", "]]", "'''",
    "1979-05-27", "true", "joint.S1.position", "body.orientation.w", '"unknown"', "{n}", "{n:99d}", "\x00", "\xff",
)  # fmt: skip

TARGET = Target("study", _prepare, (GOOD, EVENTS), tuple(map(str, _WORDS)), cases=100_000)
