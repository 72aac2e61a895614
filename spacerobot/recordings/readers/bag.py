"""ROS 1 and ROS 2 bags and MCAP files: one topic, the fields of its messages as columns."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.arrays import arrays_to_table
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.sandbox import sandboxed_arrays
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.support.errors import InputError, NotFoundError

_WIDEST = 64
_MARKS = (b"#ROSBAG", b"\x89MCAP", b"SQLite format 3")


class BagReader(Reader):
    """A topic's messages: "time" is when each was recorded, "header.stamp" when it was made, both in s.

    Fields go by dotted path ("pose.position.x"), elements of arrays by index ("position[0]") or, where the
    message names its joints, by name ("position[joint1]").
    """

    name: ClassVar[str] = "bag"
    suffixes: ClassVar[tuple[str, ...]] = (".bag", ".mcap", ".db3")

    def claims(self, path: Path, head: bytes) -> bool:
        """The marks of the three containers, or a ROS 2 bag's folder."""
        return head.startswith(_MARKS) or (path.is_dir() and (path / "metadata.yaml").is_file())

    def parts(self, path: Path) -> tuple[str, ...]:
        """The topics."""
        return sandboxed_arrays(_whole(path), "bag:parts")[1]

    def read(self, path: Path, options: Options) -> RawTable:
        """The fields of topic `options.variable`, or of the only topic; parsed in a child process."""
        arrays, notes = sandboxed_arrays(_whole(path), self.name, options.variable)
        return arrays_to_table(path, arrays, dataclasses.replace(options, variable=None), notes)


def _whole(path: Path) -> Path:
    """The folder of a ROS 2 bag for a file in it."""
    inside = path.is_file() and path.suffix == ".db3" and (path.parent / "metadata.yaml").is_file()
    return path.parent if inside else path


def topics(path: Path) -> list[str]:
    """The bag's topics. Runs in the child process."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
        return sorted(reader.topics)


def bag_arrays(path: Path, topic: str | None) -> tuple[dict[str, Floats], list[str]]:
    """Field -> values of one topic, and remarks. Runs in the child process.

    Raises:
        InputError: no such topic, or no message of numbers.
        whatever rosbags raises on a broken file.
    """
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
        topics = sorted(reader.topics)
        if topic is None:
            if len(topics) != 1:
                what = f"the bag has {len(topics)} topics"
                raise InputError(f'{what}: choose one with variable = "/topic"; it has {topics[:20]}')
            topic = topics[0]
        if topic not in reader.topics:
            raise NotFoundError("topic", topic, topics)
        connections = [c for c in reader.connections if c.topic == topic]
        columns: dict[str, list[float]] = {}
        cells = row = 0
        for connection, stamp, data in reader.messages(connections=connections):
            message = reader.deserialize(data, connection.msgtype)
            for key, value in (("time", stamp * 1e-9), *fields(message)):
                column = columns.setdefault(key, [])
                column.extend([math.nan] * (row - len(column)))
                column.append(value)
                cells += 1
            row += 1
            if cells > limits.ARRAY_VALUES // 4:
                raise InputError("the topic holds too many numbers", valid=f"at most {limits.ARRAY_VALUES // 4}")
    if len(columns) < 2:
        raise InputError(f"the topic {topic} has no messages of numbers")
    for column in columns.values():
        column.extend([math.nan] * (row - len(column)))
    return {key: np.asarray(column, dtype=np.float64) for key, column in columns.items()}, []


def fields(message: Any, prefix: str = "", depth: int = 0) -> Iterator[tuple[str, float]]:
    """(dotted path, number) of every number in a message; long arrays are left out."""
    if depth > 8:
        return
    labels = getattr(message, "name", None)
    for field in dataclasses.fields(message):
        if field.name.startswith("__"):
            continue
        value, key = getattr(message, field.name), f"{prefix}{field.name}"
        if isinstance(value, bool | int | float | np.number):
            yield key, float(value)
        elif hasattr(value, "sec") and hasattr(value, "nanosec"):
            yield key, value.sec + 1e-9 * value.nanosec
        elif dataclasses.is_dataclass(value):
            yield from fields(value, f"{key}.", depth + 1)
        elif isinstance(value, np.ndarray | list) and len(value) <= _WIDEST:
            names = labels if isinstance(labels, list) and len(labels) == len(value) else range(len(value))
            for label, element in zip(names, value, strict=True):
                if isinstance(element, bool | int | float | np.number):
                    yield f"{key}[{label}]", float(element)
                elif dataclasses.is_dataclass(element):
                    yield from fields(element, f"{key}[{label}].", depth + 1)
