"""HDF5 files: datasets by dotted path, fields of compound datasets too."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.arrays import arrays_to_table, as_floats
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.sandbox import sandboxed_arrays
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.support.errors import InputError

SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MOST = 5000
_MOST_ATTRIBUTES = 200


class Hdf5Reader(Reader):
    """Datasets as columns: "group/data" is called "group.data"."""

    name: ClassVar[str] = "hdf5"
    suffixes: ClassVar[tuple[str, ...]] = (".h5", ".hdf5", ".hdf", ".he5")

    def claims(self, path: Path, head: bytes) -> bool:
        """HDF5's signature."""
        return head.startswith(SIGNATURE)

    def read(self, path: Path, options: Options) -> RawTable:
        """The file's datasets as columns; parsed in a child process."""
        arrays, notes = sandboxed_arrays(path, self.name)
        return arrays_to_table(path, arrays, options, notes)


def hdf5_arrays(path: Path, *, transpose: bool = False) -> dict[str, Floats]:
    """Dotted name -> array of an HDF5 file, and its groups' own numbers. Runs in the child process.

    Links to other files and data kept in other files are not followed.

    Args:
        path: the file.
        transpose: swap the axes, as MATLAB writes them.

    Raises:
        InputError: a dataset is larger than the limit.
        whatever h5py raises on a broken file.
    """
    import h5py

    found: dict[str, Floats] = {}
    total = 0

    def visit(name: str, item: Any) -> bool | None:
        nonlocal total
        if isinstance(item, h5py.Group):
            found.update(_numbers(f"{name.strip('/').replace('/', '.')}.", item))
        if not isinstance(item, h5py.Dataset) or item.external or item.is_virtual or "#refs#" in name:
            return None
        if item.dtype.kind not in "biufV" or not item.size:
            return None
        total += item.size
        if total > limits.ARRAY_VALUES:
            raise InputError("the file holds too many numbers", given=f"{total} by {name}")
        label = name.strip("/").replace("/", ".")
        values = np.asarray(item[()])
        parts = {f"{label}.{f}": values[f] for f in values.dtype.names} if values.dtype.names else {label: values}
        for key, part in parts.items():
            numbers = as_floats(part)
            if numbers is not None:
                found[key] = np.ascontiguousarray(numbers.T) if transpose else numbers
        return True if len(found) > _MOST else None

    with h5py.File(path, "r") as file:
        found.update(_numbers("", file))
        file.visititems(visit)
    return found


def _numbers(prefix: str, group: Any) -> dict[str, Floats]:
    """The single numbers that are attributes of a group, as arrays of one: a trial's mass, say."""
    every = ((str(key), np.asarray(value)) for key, value in itertools.islice(group.attrs.items(), _MOST_ATTRIBUTES))
    return {
        f"{prefix}{key}": v.reshape(1).astype(np.float64) for key, v in every if v.size == 1 and v.dtype.kind in "iuf"
    }
