"""The kinds of binary files: how one is made, damaged and put in place."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fuzz.binary import bags, hdf5, mat


def _file(suffix: str) -> Callable[[bytes, Path, str], Path]:
    def place(data: bytes, folder: Path, stem: str) -> Path:
        path = folder / f"{stem}.{suffix}"
        path.write_bytes(data)
        return path

    return place


@dataclass(frozen=True)
class Kind:
    """One kind.

    Attributes:
        format: what the sandbox calls it.
        seed: makes a whole file, in a folder for its own use; the last path is of a file that it may point to and
            that no reader may follow.
        words: of the format, for the mutator.
        place: puts bytes where the reader finds them.
        cases: share of a long run.
        fixed: bytes at the beginning that say what to do with the rest, never damaged.
    """

    format: str
    seed: Callable[[random.Random, Path, Path], bytes]
    words: tuple[bytes, ...]
    place: Callable[[bytes, Path, str], Path]
    cases: int
    fixed: int = 0


KINDS = {
    "hdf5": Kind("hdf5", hdf5.seed, hdf5.WORDS, _file("h5"), 25_000),
    "mat": Kind("mat", mat.seed, mat.WORDS, _file("mat"), 25_000),
    "bag": Kind("bag", bags.seed, bags.WORDS, bags.place, 15_000, fixed=1),
}
