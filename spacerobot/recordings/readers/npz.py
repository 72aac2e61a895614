"""NumPy's own files: .npz archives and single .npy arrays, never pickled objects."""

from __future__ import annotations

import io
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.arrays import arrays_to_table, as_floats
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.support.errors import InputError

_BROKEN = (
    ValueError,
    LookupError,
    ArithmeticError,
    OSError,
    EOFError,
    TypeError,
    AttributeError,
    SyntaxError,
    RuntimeError,
    MemoryError,
    zipfile.BadZipFile,
    zlib.error,
    tokenize.TokenError,
)
"""What the standard library and NumPy raise on archives and headers that are not what they claim to be."""


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
        except _BROKEN as error:
            reason = str(error) or type(error).__name__
            raise InputError(f"not a NumPy file that can be read: {reason[:200]}", where=str(path)) from None
        return arrays_to_table(path, arrays, options)


def _single(path: Path) -> dict[str, Floats]:
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    return _fields("data", array)


def _archive(path: Path, options: Options) -> dict[str, Floats]:
    found: dict[str, Floats] = {}
    total = 0
    with zipfile.ZipFile(path) as archive:
        members = [m for m in archive.infolist() if m.filename.endswith(".npy")]
        wanted = {options.variable, *(options.wanted or ())} if options.variable else None
        for member in members:
            name = member.filename.removesuffix(".npy")
            if wanted is not None and not any(
                w and (w == name or w.startswith((f"{name}.", f"{name}["))) for w in wanted
            ):
                found.setdefault(name, np.empty(0))  # listed, so that a wrong name finds its nearest
                continue
            total += member.file_size
            if total > limits.ARRAY_VALUES * 8:
                raise InputError(
                    "the archive unpacks to too much",
                    given=f"{total} bytes or more",
                    valid=f"at most {limits.ARRAY_VALUES * 8}",
                    where=str(path),
                )
            with archive.open(member) as stream:
                found.update(_fields(name, _load(stream.read(member.file_size + 1))))
            limits.check_cells(path, sum(a.size for a in found.values()), 1)
    return {name: a for name, a in found.items() if a.size or wanted is not None}


def _load(data: bytes) -> np.ndarray:
    """A whole .npy file in memory, whose header may claim no more values than there are bytes for."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, dtype = reader(stream)
    if dtype.hasobject:
        raise ValueError("pickled objects are not read")
    count = 1
    for size in shape:
        count *= size
    if count < 0 or count * dtype.itemsize > len(data) - stream.tell():
        raise ValueError(f"the header claims {shape} values, more than the file holds")
    array = np.frombuffer(data, dtype=dtype, count=count, offset=stream.tell())
    return array.reshape(shape, order="F" if fortran else "C")


def _fields(name: str, array: np.ndarray) -> dict[str, Floats]:
    if array.dtype.names:
        parts = {f"{name}.{field}": as_floats(array[field]) for field in array.dtype.names}
    else:
        parts = {name: as_floats(array)}
    return {key: values for key, values in parts.items() if values is not None}
