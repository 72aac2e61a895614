"""What a process of the fuzzer has done so far, in a file that outlives it however it ends."""

from __future__ import annotations

import hashlib
import json
import mmap
import struct
from dataclasses import dataclass, field
from pathlib import Path

_FORM = struct.Struct("<QQQQddd")  # the last three: seconds of the slowest, seconds in all, bytes at most


@dataclass
class Tally:
    """Counts of one target, written through to `folder/tally`, and its findings, a file each.

    Attributes:
        folder: of this target's run.
        tried, read, refused, contained: cases; contained are those in which a parser died in its child process.
        slowest, seconds: CPU time of the slowest case and of all.
        memory: most that a process took [bytes].
        defects: words -> name of the first input that brought them about.
    """

    folder: Path
    tried: int = 0
    read: int = 0
    refused: int = 0
    contained: int = 0
    slowest: float = 0.0
    seconds: float = 0.0
    memory: float = 0.0
    defects: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / "tally"
        if not path.exists():
            path.write_bytes(bytes(_FORM.size))
        with path.open("r+b") as stream:
            self._map = mmap.mmap(stream.fileno(), _FORM.size)
        values = _FORM.unpack(self._map[:])
        self.tried, self.read, self.refused, self.contained, self.slowest, self.seconds, self.memory = values
        for found in sorted(self.folder.glob("defect-*.json")):
            self.defects[json.loads(found.read_text())["words"]] = found.stem

    def add(self, outcome: str, words: str, seconds: float, data: bytes) -> None:
        """Note one case; a defect's first input is kept."""
        self.tried += 1
        self.read += outcome == "read"
        self.refused += outcome == "refused"
        self.contained += outcome == "contained"
        self.seconds += seconds
        if seconds > self.slowest:
            self.slowest = seconds
            (self.folder / "slowest").write_bytes(data)
        if outcome == "defect" and words not in self.defects and len(self.defects) < 200:
            name = f"defect-{hashlib.sha256(data).hexdigest()[:12]}"
            (self.folder / name).write_bytes(data)
            (self.folder / f"{name}.json").write_text(json.dumps({"words": words, "seconds": seconds}))
            self.defects[words] = name
        self.write()

    def write(self) -> None:
        """Put the counts where another process sees them."""
        values = (self.tried, self.read, self.refused, self.contained, self.slowest, self.seconds, self.memory)
        self._map[:] = _FORM.pack(*values)

    def report(self) -> dict[str, object]:
        """The counts, for a results file."""
        return {
            "cases": self.tried,
            "read": self.read,
            "refused": self.refused,
            "parser died in its child": self.contained,
            "slowest case [s]": round(self.slowest, 3),
            "cpu [s]": round(self.seconds, 1),
            "most memory [MB]": round(self.memory / 1e6, 1),
            "defects": sorted(self.defects),
        }
