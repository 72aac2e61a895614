"""Small studies and recordings to try things on."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.recordings.dataroot import recordings_folder

HEAD = """format = 1
title = "A small study"

[baseline]
robot = "pa10_wrist"
approach = [1, 0, 0]

[baseline.wrist]
mass = 0.7
stiffness = 1000
"""

STREAM = """
[streams.mocap]
time = "t"
[streams.mocap.channels]
x = { is = "target.x", sigma = 1e-4 }
"""

TRIAL = """
[[trials]]
id = "01"
target.mass = 9.0
mocap = "01.csv"
"""

CSV = "t,x\n0,1\n0.1,2\n0.2,4\n"


def write_study(folder: Path, text: str = HEAD + STREAM + TRIAL, csv: str | bytes = CSV, name: str = "01.csv") -> Path:
    """A study folder with one recording; returns the folder."""
    (folder / "study.toml").write_text(text, encoding="utf-8")
    data = csv.encode() if isinstance(csv, str) else csv
    (folder / name).write_bytes(data)
    return folder


def real(*parts: str) -> Path:
    """A file of the real recordings; the test is skipped where they are absent."""
    top = recordings_folder()
    path = None if top is None else top.joinpath("real", *parts)
    if path is None or not path.exists():
        pytest.skip("the real recordings are not here: set SPACEROBOT_DATA")
    return path
