"""Parsing in a child process with limits on memory and time: for formats whose parser is not ours."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.table import Floats
from spacerobot.support.errors import InputError

_ROOT = str(Path(__file__).resolve().parents[3])
_KEPT_VALUES = 4_000_000
_GAVE_UP = "the parser gave up on it: the file is damaged or hostile"


def sandboxed_arrays(path: Path, format: str, variable: str | None = None) -> tuple[dict[str, Floats], tuple[str, ...]]:
    """The arrays of a binary file, parsed in a child process.

    The child may add `limits.CHILD_BYTES` of memory to its own and take `limits.CHILD_SECONDS`; if it
    crashes, only it does. Results of modest size are kept, so that many trials in one file cost one child.

    Args:
        path: the file, or folder for a ROS 2 bag.
        format: "mat", "hdf5", "xlsx" or "bag"; "xlsx:parts" or "bag:parts" for the names of its tables as remarks.
        variable: topic of a bag, sheet of a workbook; None for all arrays.

    Returns:
        Dotted name -> array, and remarks.

    Raises:
        InputError: the file is broken, too large, or takes too long.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    if status.st_size > limits.BINARY_BYTES:
        raise InputError(
            "the file is too long",
            given=f"{status.st_size} bytes",
            valid=f"at most {limits.BINARY_BYTES}",
            where=str(path),
        )
    key = (str(path), format, variable, status.st_mtime_ns, status.st_size)
    if key in _kept:
        return _kept[key]
    found = _ask(path, format, variable)
    if sum(a.size for a in found[0].values()) <= _KEPT_VALUES:
        while len(_kept) >= 4:
            del _kept[next(iter(_kept))]
        _kept[key] = found
    return found


_kept: dict[tuple[str, str, str | None, int, int], tuple[dict[str, Floats], tuple[str, ...]]] = {}


@lru_cache(maxsize=1)
def _environment() -> dict[str, str]:
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("HDF5_PLUGIN", "PYTHON"))}
    return {**kept, "PYTHONPATH": _ROOT, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def _ask(path: Path, format: str, variable: str | None) -> tuple[dict[str, Floats], tuple[str, ...]]:
    command = [sys.executable, "-P", "-m", "spacerobot.recordings.readers.child"]
    request = json.dumps({"path": str(path), "format": format, "variable": variable}).encode()
    try:
        done = subprocess.run(  # noqa: S603 - our own module, and the request goes through a pipe
            command,
            input=request,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,  # a parser may have no end of complaints
            timeout=limits.CHILD_SECONDS,
            env=_environment(),
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError(f"reading took longer than {limits.CHILD_SECONDS:g} s", where=str(path)) from None
    return unpack(done.stdout, path)


def unpack(said: bytes, path: Path) -> tuple[dict[str, Floats], tuple[str, ...]]:
    """The child's standard output as arrays and remarks.

    Raises:
        InputError: what the child says of the file, or that it died over it.
    """
    head, _, body = said.partition(b"\n")
    try:
        answer = json.loads(head)
    except ValueError:
        answer = {"error": _GAVE_UP}
    if "error" in answer:
        raise InputError(str(answer["error"])[:300], where=str(path))
    if sum(8 * math.prod(shape) for _, shape in answer["arrays"]) != len(body):  # it died while it wrote
        raise InputError(_GAVE_UP, where=str(path))
    arrays: dict[str, Floats] = {}
    offset = 0
    for name, shape in answer["arrays"]:
        count = math.prod(shape)
        arrays[name] = np.frombuffer(body, dtype=np.float64, count=count, offset=offset).reshape(shape)
        offset += 8 * count
    return arrays, tuple(answer["notes"])
