"""NumPy's own files: .npz archives and single .npy arrays, never pickled objects."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.arrays import arrays_to_table, as_floats
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.support.errors import InputError
from spacerobot.support.npz import BROKEN, read_npz


class NpzReader(Reader):
    """Arrays by name; sizes are checked before anything is unpacked."""

    name: ClassVar[str] = "npz"
    suffixes: ClassVar[tuple[str, ...]] = (".npz", ".npy")

    def claims(self, path: Path, head: bytes) -> bool:
        """A zip archive with the right name, or NumPy's own mark."""
        return head.startswith(b"\x93NUMPY") or (head.startswith(b"PK") and path.suffix.lower() == ".npz")

    def read(self, path: Path, options: Options) -> RawTable:
        """All arrays, or with `options.variable` that one and what the wanted columns name."""
        try:
            with path.open("rb") as stream:
                single = stream.read(6) == b"\x93NUMPY"
            arrays = _single(path) if single else _archive(path, options)
        except BROKEN as error:
            reason = str(error) or type(error).__name__
            raise InputError(f"not a NumPy file that can be read: {reason[:200]}", where=str(path)) from None
        return arrays_to_table(path, arrays, options)


def _single(path: Path) -> dict[str, Floats]:
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    return _fields(path, "data", array)


def _archive(path: Path, options: Options) -> dict[str, Floats]:
    names = {options.variable, *(options.wanted or ())} if options.variable else None

    def wanted(name: str) -> bool:
        return names is None or any(w and (w == name or w.startswith((f"{name}.", f"{name}["))) for w in names)

    found: dict[str, Floats] = {}
    for name, array in read_npz(path, limits.ARRAY_VALUES * 8, wanted=wanted).items():
        if array is None:
            found.setdefault(name, np.empty(0))  # listed, so that a wrong name finds its nearest
        else:
            found.update(_fields(path, name, array))
            limits.check_cells(path, sum(a.size for a in found.values()), 1)
    return {name: a for name, a in found.items() if a.size or names is not None}


def _fields(path: Path, name: str, array: np.ndarray) -> dict[str, Floats]:
    if array.dtype.names:
        limits.check_cells(path, array.size, len(array.dtype.names))  # before bytes become floats, eight times as long
        parts = {f"{name}.{field}": as_floats(array[field]) for field in array.dtype.names}
    else:
        parts = {name: as_floats(array)}
    return {key: values for key, values in parts.items() if values is not None}
