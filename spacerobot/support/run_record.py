"""What a run's folder says of itself: whose it is, how far it came, which files it has written and what is in them."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spacerobot.support.files import left_over, plain_file, sha256_of, write_text
from spacerobot.support.jsonio import dumps

MARKER = "run.json"
"""File that says whose the folder is and whether the run is "running" or "finished"."""

KEY = ("command", "input_hash", "version", "code")
"""What a run is known by; a file of this name that does not say all of it is somebody else's."""


@dataclass(frozen=True)
class Record:
    """The content of MARKER.

    Attributes:
        state: "running" or "finished".
        key: command, input_hash, version and code.
        outputs: path inside the folder -> size [B]; -1 as long as the run goes on.
        sha256: path inside the folder -> hash of the content; of a finished run.
    """

    state: str
    key: Mapping[str, Any]
    outputs: Mapping[str, int]
    sha256: Mapping[str, str] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """Write it, whole or not at all."""
        content = {"state": self.state, **self.key, "outputs": self.outputs}
        write_text(folder / MARKER, dumps({**content, "sha256": self.sha256} if self.sha256 else content))

    def altered(self, folder: Path) -> list[str]:
        """Outputs of a finished run that are there, and are not what it wrote."""
        return [n for n in self.outputs if os.path.lexists(folder / n) and not self._wrote(folder, n)]

    def missing(self, folder: Path) -> list[str]:
        """Outputs of a finished run that are not there."""
        return [n for n in self.outputs if not os.path.lexists(folder / n)]

    def remove(self, folder: Path) -> None:
        """Take the run away: its outputs, and what writing them has left. A file that was changed since stays."""
        ours = [folder / n for n in self.outputs if self.state != "finished" or self._wrote(folder, n)]
        inside = [
            p for p in (*ours, *self._left(folder)) if p.parent.resolve().is_relative_to(folder) and plain_file(p)
        ]
        for path in inside:
            path.unlink()

    def tidy(self, folder: Path, but: Collection[Path] = ()) -> None:
        """Remove what a killed process was writing of this run; `but` what lay there before its name was the run's."""
        for path in self._left(folder):
            if path not in but and path.parent.resolve().is_relative_to(folder):
                path.unlink(missing_ok=True)

    def _left(self, folder: Path) -> list[Path]:
        return left_over([folder / MARKER, *(folder / name for name in self.outputs)])

    def _wrote(self, folder: Path, name: str) -> bool:
        path = folder / name
        with contextlib.suppress(OSError):
            return plain_file(path) and path.stat().st_size == self.outputs[name] and self._hash(path, name)
        return False

    def _hash(self, path: Path, name: str) -> bool:
        return name in self.sha256 and sha256_of(path) == self.sha256[name]


def finished(folder: Path, key: Mapping[str, Any], names: Mapping[str, Any]) -> Record:
    """The record of a run that has written what it will, of all `names` that came to be."""
    there = [n for n in names if plain_file(folder / n)]
    sizes = {n: (folder / n).stat().st_size for n in there}
    return Record("finished", key, sizes, {n: sha256_of(folder / n) for n in there})


def read_record(folder: Path) -> Record | None:
    """The folder's record; None where there is none, or none that a run has written."""
    path = folder / MARKER
    try:
        found = json.loads(path.read_text(encoding="utf-8")) if plain_file(path) else None
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("state") not in ("running", "finished"):
        return None
    outputs, hashes = found.get("outputs"), found.get("sha256", {})
    if not isinstance(outputs, dict) or not isinstance(hashes, dict) or not all(map(_inside, outputs)):
        return None
    key = {k: found.get(k) for k in KEY}
    if not all(isinstance(v, str) for v in key.values()):
        return None
    return Record(found["state"], key, outputs, hashes)


def half_marker(path: Path) -> bool:
    """Whether this is a first record that was being written when its process was killed."""
    begun = b'{\n "state": "running"'
    try:
        with path.open("rb") as stream:
            content = stream.read(len(begun))
    except OSError:
        return False
    return content == begun[: len(content)] and path in left_over([path.parent / MARKER])


def _inside(name: str) -> bool:
    """Whether it can be the path of an output; a stranger's file of this name may hold anything."""
    try:
        plain = b"\0" not in os.fsencode(name)
    except UnicodeEncodeError:
        return False
    path = Path(name)
    return plain and bool(path.name) and not path.is_absolute() and ".." not in path.parts and name != MARKER
