"""The contract of a reader."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from spacerobot.recordings.table import Options, RawTable


class Reader(ABC):
    """Turns one kind of file into columns of raw numbers.

    Duties of an implementation:

    * `read` returns every column it can, as float64 with NaN for "no reading", and the line of each row
      where the file has lines. It converts no units and drops nothing but what `options.rows` leaves out.
    * Whatever is wrong with the file raises `InputError` with file, line and reason; no other exception
      leaves it.
    * It reads no more than the limits of `readers.limits`, whatever the file says about itself, and runs no
      code that the file brings (no pickle).
    """

    name: ClassVar[str]
    """What a study writes as `format`."""

    suffixes: ClassVar[tuple[str, ...]] = ()
    """File name endings, lower case, that suggest this reader."""

    def parts(self, path: Path) -> tuple[str, ...]:
        """The tables among which `Options.variable` chooses where the file holds several that `read` does not join.

        Empty for a file that is one table.

        Raises:
            InputError: the file cannot be read as this kind.
        """
        return ()

    @abstractmethod
    def claims(self, path: Path, head: bytes) -> bool:
        """Whether the first bytes (decompressed) say that the file is of this kind."""

    @abstractmethod
    def read(self, path: Path, options: Options) -> RawTable:
        """The file's columns.

        Raises:
            InputError: the file cannot be read as this kind.
        """
