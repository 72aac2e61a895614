"""Readers, one kind of file each, and the choice among them."""

from __future__ import annotations

from pathlib import Path

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.bag import BagReader
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.delimited import DelimitedReader, TextReader
from spacerobot.recordings.readers.garbage import refuse_garbage
from spacerobot.recordings.readers.hdf5 import Hdf5Reader
from spacerobot.recordings.readers.mat import MatReader
from spacerobot.recordings.readers.motive import MotiveReader
from spacerobot.recordings.readers.nexus import NexusReader
from spacerobot.recordings.readers.npz import NpzReader
from spacerobot.recordings.readers.stamps import with_stamps
from spacerobot.recordings.readers.xlsx import XlsxReader
from spacerobot.recordings.table import Options, RawTable
from spacerobot.support.errors import InputError, NotFoundError

READERS: tuple[Reader, ...] = (
    BagReader(),
    XlsxReader(),
    NpzReader(),
    MatReader(),
    Hdf5Reader(),
    MotiveReader(),
    NexusReader(),
    TextReader(),
    DelimitedReader(),
)
"""All readers, those that know their files by a mark before those that take any text."""


def reader_for(path: Path, format: str | None = None) -> Reader:
    """The reader of the stated format, else of what the file's first bytes and name say it is.

    Raises:
        NotFoundError: no such format.
        InputError: the file cannot be opened.
    """
    if format is not None:
        for reader in READERS:
            if reader.name == format:
                return reader
        raise NotFoundError("format", format, (r.name for r in READERS), where=str(path))
    head = b"" if path.is_dir() else limits.read_head(path)
    claiming = [r for r in READERS if r.claims(path, head)]
    name = path.name.lower().removesuffix(".gz").removesuffix(".bz2").removesuffix(".xz")
    claimed = next((r for r in claiming if not isinstance(r, DelimitedReader)), None)
    if claimed is not None:
        return claimed
    for reader in claiming:
        if name.endswith(reader.suffixes):
            return reader
    if not claiming:
        raise InputError(
            "not a kind of file that can be read",
            given=path.name,
            valid=", ".join(r.name for r in READERS),
            where=str(path),
        )
    return claiming[-1]


def read_table(path: Path, options: Options | None = None, format: str | None = None) -> RawTable:
    """The columns of the file at `path`.

    Raises:
        InputError: it cannot be read; with file, line and reason.
    """
    options = options or Options()
    table = with_stamps(reader_for(path, format).read(path, options))
    refuse_garbage(table, options)
    return table
