"""NumPy's archives from anyone: sizes are settled before anything is unpacked, and nothing pickled is read."""

from __future__ import annotations

import io
import tokenize
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spacerobot.support.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_BYTES = 160_000_000
"""Most that an archive may unpack to (20 million numbers)."""

_DIRECTORY_BYTES = 1_000_000
_END, _END_64 = b"PK\x05\x06", b"PK\x06\x07"

BROKEN = (
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


def read_npz(
    path: Path, most: int = MOST_BYTES, *, wanted: Callable[[str], bool] | None = None
) -> dict[str, NDArray[Any] | None]:
    """Arrays of a .npz file by name; None for those that are not wanted.

    Args:
        path: the file.
        most: bytes that all wanted arrays may have together.
        wanted: whether to unpack the array of a name; all if None.

    Raises:
        InputError: no regular file, damaged, or too large.
    """
    if not path.is_file():  # a pipe would wait for ever
        raise InputError("no such file", where=str(path))
    try:
        with path.open("rb") as stream:
            _check_directory(stream, path)
            with zipfile.ZipFile(stream) as archive:
                return _unpacked(archive, path, most, wanted)
    except BROKEN as error:
        reason = str(error) or type(error).__name__
        raise InputError(f"not a NumPy file that can be read: {reason[:200]}", where=str(path)) from None


def npy_array(data: bytes) -> NDArray[Any]:
    """A whole .npy file in memory, whose header may claim no more values than there are bytes for.

    Raises:
        ValueError, or another of BROKEN: it is none.
    """
    import numpy as np

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


def _unpacked(
    archive: zipfile.ZipFile, path: Path, most: int, wanted: Callable[[str], bool] | None
) -> dict[str, NDArray[Any] | None]:
    found: dict[str, NDArray[Any] | None] = {}
    total = 0
    for member in archive.infolist():
        if not member.filename.endswith(".npy"):
            continue
        name = member.filename.removesuffix(".npy")
        if wanted is not None and not wanted(name):
            found.setdefault(name, None)
            continue
        total += member.file_size
        if total > most:
            raise InputError(
                "the archive unpacks to too much",
                given=f"{total} bytes or more",
                valid=f"at most {most}",
                where=str(path),
            )
        with archive.open(member) as content:
            found[name] = npy_array(content.read(member.file_size + 1))
    return found


def _check_directory(stream: Any, path: Path) -> None:
    """Refuse an archive whose table of contents is itself a flood; zipfile reads it whole, whatever its size."""
    size = stream.seek(0, 2)
    stream.seek(max(0, size - 66_000))
    tail = stream.read()
    stream.seek(0)
    start = tail.find(_END)
    while start >= 0:
        if int.from_bytes(tail[start + 12 : start + 16], "little") > _DIRECTORY_BYTES:
            raise InputError("the archive has too many members", where=str(path))
        start = tail.find(_END, start + 1)
    if _END_64 in tail and size < 4_000_000_000:  # NumPy writes that record from 4 GB on alone
        raise InputError("the archive has too many members", where=str(path))
