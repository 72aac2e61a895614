"""Bags: a topic's fields as columns, from ROS 1, ROS 2 and MCAP alike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from spacerobot.recordings.readers import read_table
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Options
from spacerobot.support.errors import InputError

START = 1_700_000_000
TYPE = "sensor_msgs/msg/JointState"


def write_bag(path: Path, kind: str) -> Path:
    """Ten messages of two joints on /joint_states, and one on /other."""
    one = kind == "ros1"
    types = get_typestore(Stores.ROS1_NOETIC if one else Stores.ROS2_HUMBLE)
    state, header, time = (types.types[n] for n in (TYPE, "std_msgs/msg/Header", "builtin_interfaces/msg/Time"))
    if one:
        writer = Writer1(path)
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path, version=9, storage_plugin=plugin)
    with writer:
        joints = writer.add_connection("/joint_states", TYPE, typestore=types)
        other = writer.add_connection("/other", TYPE, typestore=types)
        for i in range(10):
            stamp = time(sec=START + i // 5, nanosec=(i % 5) * 200_000_000)
            extra = {"seq": i} if one else {}
            message = state(
                header=header(stamp=stamp, frame_id="base", **extra),
                name=["j1", "j2"],
                position=np.array([0.1 * i, 1.0]),
                velocity=np.array([0.5, 0.0]),
                effort=np.array([]),
            )
            data = types.serialize_ros1(message, TYPE) if one else types.serialize_cdr(message, TYPE)
            moment = START * 10**9 + i * 200_000_000 + 5_000_000
            writer.write(joints, moment, data)
            if i == 0:
                writer.write(other, moment, data)
    return path


@pytest.mark.parametrize("kind", ["ros1", "mcap", "sqlite"])
def test_fields_of_a_topic(tmp_path: Path, kind: str) -> None:
    bag = write_bag(tmp_path / ("log.bag" if kind == "ros1" else "log"), kind)
    file = next(bag.glob("*.mcap"), bag) if kind == "mcap" else bag
    table = read_table(file, Options(variable="/joint_states"))
    np.testing.assert_allclose(table["position[j1]"], 0.1 * np.arange(10))
    np.testing.assert_allclose(table["header.stamp"] - START, 0.2 * np.arange(10), atol=1e-6)
    np.testing.assert_allclose(table["time"] - table["header.stamp"], 0.005, atol=1e-6)
    with pytest.raises(InputError, match="has 2 topics: choose one"):
        read_table(file)
    with pytest.raises(InputError, match="topic"):
        read_table(file, Options(variable="/joints"))


def test_a_study_reads_a_bag_and_takes_the_epoch_off(tmp_path: Path) -> None:
    write_bag(tmp_path / "01.bag", "ros1")
    (tmp_path / "study.toml").write_text("""format = 1
[baseline]
robot = "pa10_wrist"
[streams.joints]
format = "bag"
variable = "/joint_states"
time = "header.stamp"
[streams.joints.channels]
"position[j1]" = { is = "joint.j1.position" }
"velocity[j1]" = { is = "joint.j1.velocity" }
[[trials]]
id = "01"
joints = "01.bag"
""")
    recording = load_study(tmp_path).recording("01")
    np.testing.assert_allclose(recording["joint.j1.position"].time, 0.2 * np.arange(10), atol=1e-6)
    assert recording.epoch == {"shared": START}


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3"])
def test_damaged_bags_are_refused(tmp_path: Path, name: str) -> None:
    marks = {"a.bag": b"#ROSBAG V2.0\n", "a.mcap": b"\x89MCAP0\r\n", "a.db3": b"SQLite format 3\x00"}
    (tmp_path / name).write_bytes(marks[name] + bytes(range(256)) * 20)
    with pytest.raises(InputError, match="bag file"):
        read_table(tmp_path / name)
