"""MAT files of version 5, and of 7.3, which are HDF5."""

from __future__ import annotations

import io
import random
import zlib
from pathlib import Path

import numpy as np
from scipy.io import savemat
from scipy.sparse import csc_array

from fuzz.binary import hdf5
from fuzz.binary.mutate import damaged

WORDS = (*(bytes([n, 0, 0, 0]) for n in (1, 2, 5, 6, 9, 14, 15, 16)), b"MI", b"IM", b"\xff" * 4, b"x\x9c")


def seed(dice: random.Random, folder: Path, canary: Path) -> bytes:
    """A small file; of compressed elements the content may be damaged and packed again, checksum and all."""
    if dice.random() < 0.1:
        return hdf5.seed(dice, folder, canary)
    buffer = io.BytesIO()
    content = {f"v{i}": _value(dice, 0) for i in range(dice.randint(1, 3))}
    squeezed = dice.random() < 0.5
    savemat(buffer, content, do_compression=squeezed, long_field_names=True)
    return _repacked(buffer.getvalue(), dice) if squeezed else buffer.getvalue()


def _value(dice: random.Random, depth: int) -> object:
    kinds = ["numbers", "integers", "text", "sparse", "complex", "empty", "flags"]
    kind = dice.choice(kinds + (["struct", "cell", "struct"] if depth < 3 else []))
    if kind == "struct":
        return {f"f{i}": _value(dice, depth + 1) for i in range(dice.randint(1, 3))}
    if kind == "cell":
        cells = np.empty(2, dtype=object)
        cells[:] = [_value(dice, depth + 1) for _ in range(2)]
        return cells
    shape = dice.choice(((3, 1), (2, 3), (1, 1), (2, 2, 2)))
    return {
        "numbers": np.ones(shape),
        "integers": np.ones(shape, dtype=dice.choice(("i1", "u2", "i4", "u8"))),
        "text": "abc",
        "sparse": csc_array(np.eye(3)),
        "complex": np.ones(shape) * 1j,
        "empty": np.zeros((0, 0)),
        "flags": np.ones(shape, dtype=bool),
    }[kind]


def _repacked(data: bytes, dice: random.Random) -> bytes:
    """Each compressed element unpacked, damaged now and then, and packed anew; now and then into a bomb."""
    found, at = data[:128], 128
    while at + 8 <= len(data):
        kind, size = int.from_bytes(data[at : at + 4], "little"), int.from_bytes(data[at + 4 : at + 8], "little")
        content = data[at + 8 : at + 8 + size]
        at += 8 + size
        if kind == 15:
            plain = zlib.decompress(content)
            if dice.random() < 0.8:
                plain = damaged(plain, dice, WORDS)
            if dice.random() < 0.01:
                plain = plain[:40] + bytes(dice.choice((10**7, 10**8)))
            content = zlib.compress(plain)
        found += kind.to_bytes(4, "little") + len(content).to_bytes(4, "little") + content
    return found
