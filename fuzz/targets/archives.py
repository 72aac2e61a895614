"""Archives from bytes that a mutator can do something with: it would never guess a checksum."""

from __future__ import annotations

import io
import zipfile

import numpy as np

_CUT = b"\xf0MEMBER\xf0"


def packed(data: bytes) -> bytes:
    """The archive that `data` spells out: members, each a name, a line break and content; or raw, after a zero byte."""
    if data[:1] == b"\0":
        return data[1:]
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for member in data[1:].split(_CUT):
            name, _, content = member.partition(b"\n")
            archive.writestr(name.decode("latin-1").replace("\0", "_") or "x.npy", content)
    return buffer.getvalue()


def spelled(**arrays: np.ndarray) -> bytes:
    """An input from which `packed` makes the archive of these arrays."""
    members = []
    for name, array in arrays.items():
        buffer = io.BytesIO()
        np.save(buffer, array)
        members.append(name.encode() + b".npy\n" + buffer.getvalue())
    return b"\1" + _CUT.join(members)


def raw(**arrays: np.ndarray) -> bytes:
    """An input that is the archive itself."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return b"\0" + buffer.getvalue()


WORDS = (_CUT.decode("latin-1"), "\x93NUMPY\x01\x00", "'descr': '<f8'", "'|O'", "'<c16'",
         "'shape': (9999999999,)", "(3,)",
         "('a','<u1')", "True", "PK\x03\x04", "PK\x01\x02", "PK\x05\x06", "\xff\xff\xff\xff", ".npy\n",
         "'|S0'", "((((")  # fmt: skip
