"""Motive's export: bodies and markers by name, unit from its header, missing frames as no reading."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.recordings.readers import read_table, reader_for
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

OLD = """Format Version,1.21,Take Name,Take 1,Capture Frame Rate,120.0,Rotation Type,Quaternion,Length Units,Millimeters

,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker,Marker,Marker
,,Target,Target,Target,Target,Target,m1,m1,m1
,,"1F","1F","1F","1F","1F","2F","2F","2F"
,,Rotation,Rotation,Position,Position,Error Per Marker,Position,Position,Position
Frame,Time,X,W,X,Y,,X,Y,Z
0,0.0,0.1,0.99,1000,20,0.3,1,2,3
1,0.0083,,,,,,4,5,6
2,0.0167,0.2,0.98,1002,21,0.3,,,
"""

NEW = """Format Version,1.23,Take Name,Take 2,Length Units,Meters
,Type,Rigid Body,Rigid Body,Rigid Body Marker,Marker
,Name,Target,Target,Target:Marker1,Target:Marker1
,ID,1F,1F,2F,3F
,Parent,,,Target,Target
,,Position,Position,Position,Position
Frame,Time (Seconds),X,Y,X,X
0,0.0,1,2,3,4
1,0.01,1,2,3,4
"""


def test_old_layout(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(OLD)
    assert reader_for(path).name == "motive"
    table = read_table(path)
    np.testing.assert_array_equal(table["Target.position.x"], [1000, np.nan, 1002])
    np.testing.assert_array_equal(table["m1.position.z"], [3, 6, np.nan])
    assert table.columns[table.index("Target.position.x")].unit == "mm"
    assert table.columns[table.index("Target.rotation.w")].unit is None
    assert list(table["Time"]) == [0, 0.0083, 0.0167]


def test_new_layout_tells_markers_of_one_name_by_their_kind(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(b"\xef\xbb\xbf" + NEW.replace("\n", "\r\n").encode())
    table = read_table(path)
    np.testing.assert_array_equal(table["Target.position.y"], [2, 2])
    np.testing.assert_array_equal(table["Time"], [0, 0.01])
    with pytest.raises(InputError, match="same name"):
        table.index("Target:Marker1.position.x")
    np.testing.assert_array_equal(table["Marker:Target:Marker1.position.x"], [4, 4])


def test_the_exports_unit_counts_unless_the_study_states_one(tmp_path: Path) -> None:
    (tmp_path / "take.csv").write_text(OLD)
    text = """format = 1
[baseline]
robot = "pa10_wrist"
[streams.mocap]
time = "Time"
[streams.mocap.channels]
"Target.position.x" = { is = "target.x" }
m1.position.x = { is = "wrist.x", unit = "m" }
[[trials]]
id = 1
mocap = "take.csv"
"""
    (tmp_path / "study.toml").write_text(text)
    recording = load_study(tmp_path).recording("1")
    np.testing.assert_allclose(recording["target.x"].good()[1], [1.0, 1.002])
    np.testing.assert_allclose(recording["wrist.x"].good()[1], [1, 4])
    assert list(recording["target.x"].valid) == [True, False, True]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Frame,Time", "Fame,Time", 'starts with "Frame"'),
        ("1,0.0083,,,,,,4,5,6", "1,0.0083,,,", r"take\.csv:9: the row is ragged"),
        ("1002", "1002.5.6", r"take\.csv:10: Target\.position\.x: two numbers run together"),
    ],
)
def test_damage_is_refused_with_the_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "take.csv"
    path.write_text(OLD.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_table(path)
