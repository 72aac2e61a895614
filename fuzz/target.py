"""A target: one reader, and what bytes become before it reads them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Target:
    """One reader under test.

    Attributes:
        name: of the target, and of its folder in the corpus.
        prepare: makes in a folder what the reader finds beside the input; returns what reads one input there.
            That raises InputError or nothing.
        seeds: inputs to start from, beside those in the corpus.
        words: tokens of the language, for the mutator.
        longest: input, in bytes.
        text: whether edits of words and lines make sense.
        cases: share of a long run.
    """

    name: str
    prepare: Callable[[Path], Callable[[bytes], None]]
    seeds: tuple[bytes, ...]
    words: tuple[str, ...] = field(default=())
    longest: int = 4000
    text: bool = True
    cases: int = 100_000


def as_bytes(words: tuple[str, ...]) -> tuple[bytes, ...]:
    """The words; a word's characters are bytes, unless one of them has no room in a byte."""
    return tuple(w.encode("latin-1" if max(map(ord, w)) < 256 else "utf-8") for w in words if w)


def dictionary(words: tuple[str, ...]) -> str:
    """The words as libFuzzer reads them."""
    return "".join('"' + "".join(f"\\x{byte:02x}" for byte in word) + '"\n' for word in as_bytes(words))
