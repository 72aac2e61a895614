"""MATLAB's MAT files: version 5 through SciPy, version 7.3 (which is HDF5) through h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from spacerobot.recordings.readers.arrays import arrays_to_table, as_floats
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.hdf5 import SIGNATURE, hdf5_arrays
from spacerobot.recordings.readers.sandbox import sandboxed_arrays
from spacerobot.recordings.table import Floats, Options, RawTable

_DEEPEST = 12
_MOST = 5000


class MatReader(Reader):
    """Variables by name, struct fields by dotted path ("data.states_i")."""

    name: ClassVar[str] = "mat"
    suffixes: ClassVar[tuple[str, ...]] = (".mat",)

    def claims(self, path: Path, head: bytes) -> bool:
        """MATLAB's mark, or HDF5's (at byte 512 behind MATLAB's) in a file called .mat."""
        return head.startswith(b"MATLAB") or path.suffix.lower() == ".mat"

    def read(self, path: Path, options: Options) -> RawTable:
        """The file's arrays as columns; parsed in a child process."""
        arrays, notes = sandboxed_arrays(path, self.name)
        return arrays_to_table(path, arrays, options, notes)


def mat_arrays(path: Path) -> dict[str, Floats]:
    """Dotted name -> array of a MAT file. Runs in the child process.

    Raises:
        whatever the parsers raise on a broken file.
    """
    with path.open("rb") as stream:
        head = stream.read(520)
    if SIGNATURE in head:
        return hdf5_arrays(path, transpose=True)
    from scipy.io import loadmat

    found: dict[str, Floats] = {}
    for name, value in loadmat(
        path, struct_as_record=True, squeeze_me=False, verify_compressed_data_integrity=True
    ).items():
        if not name.startswith("__"):
            _walk(name, value, found, 0)
    return found


def _walk(name: str, value: Any, found: dict[str, Floats], depth: int) -> None:
    """Collect the arrays of numbers inside structs and cells."""
    if depth > _DEEPEST or len(found) > _MOST or not isinstance(value, np.ndarray | np.void):
        return
    if value.dtype.names:
        flat = np.asarray(value).reshape(-1)
        for index, record in enumerate(flat[:_MOST]):
            label = name if flat.size == 1 else f"{name}[{index}]"
            for field in value.dtype.names:
                _walk(f"{label}.{field}", record[field], found, depth + 1)
    elif value.dtype == object:
        flat = value.reshape(-1)
        for index, element in enumerate(flat[:_MOST]):
            _walk(name if flat.size == 1 else f"{name}[{index}]", element, found, depth + 1)
    else:
        numbers = as_floats(value)
        if numbers is not None:
            found[name] = numbers
