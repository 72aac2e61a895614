"""NumPy archives and single arrays as recordings."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzz.target import Target
from fuzz.targets.archives import WORDS, packed, raw, spelled
from fuzz.targets.csv import studies

_STREAMS = (
    'time = "t"\nchannels.x = { is = "target.x" }',
    'time = "t"\nvariable = "x"\nchannels.0 = { is = "target.x" }',
    'rate = 10\nvariable = "x"\nreshape = 2\nchannels.1 = { is = "target.x" }',
    'rate = 10\nformat = "npz"\nchannels."x[1]" = { is = "target.x" }',
    'rate = 10\nchannels.data = { is = "target.x" }',
)


def _prepare(folder: Path) -> Callable[[bytes], None]:
    inner = studies(folder, _STREAMS, "npz")

    def read(data: bytes) -> None:
        inner(data[:1] + packed(data[1:]))

    return read


def _npy(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return b"\4\0" + buffer.getvalue()


_ARRAYS = {"t": np.arange(4.0), "x": np.arange(4.0)}
_RECORDS = np.array([(0.0, 1), (1.0, 2)], dtype=[("a", "<f8"), ("b", "<i4")])
TARGET = Target(
    "npz",
    _prepare,
    (
        *(bytes([i]) + spelled(**_ARRAYS) for i in range(3)),
        b"\3" + spelled(x=np.ones((3, 2))),
        b"\3" + spelled(x=_RECORDS),
        b"\0" + raw(**_ARRAYS),
        _npy(np.arange(3.0)),
        _npy(_RECORDS),
    ),
    WORDS,
    cases=120_000,
)
