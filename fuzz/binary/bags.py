"""ROS 1 bags, MCAP files, and SQLite bags of which the database or the metadata may be damaged."""

from __future__ import annotations

import functools
import random
import shutil
import sqlite3
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

WORDS = (
    b"\x00" * 8, b"\xff" * 4, b"op=\x03", b"op=\x05", b"conn=", b"size=", b"/joint_states", b"float64[] a",
    b"float64[9999999] a",
    b"string[] name", b"geometry_msgs/Pose a", b"sensor_msgs/JointState a", b"MSG: ",
    b"=" * 80, b"lz4", b"bz2",
    b"none",
    b"\x89MCAP0\r\n", b"SQLite format 3\x00", b"storage_identifier: mcap", b"- ../../etc/passwd", b"&a [*a, *a]",
    b"!!python/object:x",
)  # fmt: skip

_STATE = "sensor_msgs/msg/JointState"
_POSE = "geometry_msgs/msg/PoseStamped"
_SCHEMAS = (
    "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
    " SELECT i AS id, 1 AS topic_id, i AS timestamp, x'00' AS data FROM n",
    "CREATE TABLE messages(id, topic_id, timestamp, data)",
    "CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 1 AS timestamp, zeroblob(500000000) AS data",
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id TEXT, timestamp TEXT, data TEXT)",
)


def seed(dice: random.Random, folder: Path, canary: Path) -> bytes:
    """A file of three messages; the first byte says which container it is and what else lies beside it."""
    kind = dice.choice(("bag", "mcap", "mcap", "db3", "metadata"))
    path = folder / ("seed.bag" if kind == "bag" else "seed")
    one = kind == "bag"
    types = _types(one)
    if one:
        writer = Writer1(path)
        if dice.random() < 0.5:
            writer.set_compression(dice.choice(list(Writer1.CompressionFormat)))
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path, version=dice.choice((8, 9)), storage_plugin=plugin)
        if dice.random() < 0.3:
            modes = [CompressionMode.STORAGE] if kind == "mcap" else [CompressionMode.MESSAGE]
            writer.set_compression(dice.choice(modes), CompressionFormat.ZSTD)
    with writer:
        topic = writer.add_connection("/joint_states", _STATE if dice.random() < 0.7 else _POSE, typestore=types)
        for i in range(3):
            message = _message(types, topic.msgtype, i, one)
            pack = types.serialize_ros1 if one else types.serialize_cdr
            writer.write(topic, 10**18 + i * 10**8, pack(message, topic.msgtype))
    data = _taken(path, kind, dice)
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink()
    return data


def place(data: bytes, folder: Path, stem: str) -> Path:
    """Put an input where the reader finds it; a SQLite bag is a folder of two files."""
    kind, content = data[:1], data[1:]
    if kind in (b"b", b"m"):
        path = folder / f"{stem}.{'bag' if kind == b'b' else 'mcap'}"
        path.write_bytes(content)
        return path
    metadata, _, database = content.partition(b"\x00\xf0DATABASE\xf0\x00")
    path = folder / stem
    path.mkdir()
    (path / "metadata.yaml").write_bytes(metadata)
    (path / "seed.db3").write_bytes(database)
    return path


@functools.cache
def _types(one: bool) -> Typestore:
    return get_typestore(Stores.ROS1_NOETIC if one else Stores.ROS2_HUMBLE)


def _message(types: Typestore, name: str, i: int, one: bool) -> object:
    known = types.types
    stamp = known["builtin_interfaces/msg/Time"](sec=10**9, nanosec=i)
    header = known["std_msgs/msg/Header"](stamp=stamp, frame_id="base", **({"seq": i} if one else {}))
    if name == _POSE:
        point = known["geometry_msgs/msg/Point"](x=1.0, y=2.0, z=float(i))
        turn = known["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
        return known[name](header=header, pose=known["geometry_msgs/msg/Pose"](position=point, orientation=turn))
    two = np.array([0.1 * i, 1.0])
    return known[name](header=header, name=["j1", "j2"], position=two, velocity=two, effort=np.array([]))


def _taken(path: Path, kind: str, dice: random.Random) -> bytes:
    if kind == "bag":
        return b"b" + path.read_bytes()
    if kind == "mcap":
        file = next(p for p in path.iterdir() if p.suffix in (".mcap", ".zstd") or ".mcap" in p.name)
        return b"m" + file.read_bytes()
    database = next(path.glob("*.db3"))
    if dice.random() < 0.1:
        with sqlite3.connect(database) as opened:
            opened.execute("DROP TABLE messages")
            opened.execute(dice.choice(_SCHEMAS))
        opened.close()
    text = (path / "metadata.yaml").read_bytes()
    return b"d" + text + b"\x00\xf0DATABASE\xf0\x00" + database.read_bytes()
