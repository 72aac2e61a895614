"""The folder of a run: reused when finished, resumed when interrupted, never mixed with anything else."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import io
import json
import os
import re
import shutil
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any, Self

from spacerobot import __version__
from spacerobot.support.errors import InputError
from spacerobot.support.files import atomic, write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.sources import package_hash

if TYPE_CHECKING:
    from numpy.typing import NDArray

MARKER = "run.json"
"""File that says whose the folder is and whether the run is "running" or "finished"."""

_PARTIAL = "partial"
_LOCK = ".lock"


def combined_hash(*parts: object) -> str:
    """SHA-256 over the text of `parts`: an input hash together with seed and settings."""
    digest = hashlib.sha256()
    for part in parts:
        text = dumps(part, indent=None)
        digest.update(f"{len(text)}:{text}".encode())
    return digest.hexdigest()


def _a_path(name: str) -> bool:
    """Whether the system takes it for a path at all; a marker of somebody else's may hold anything."""
    try:
        return b"\0" not in os.fsencode(name)
    except UnicodeEncodeError:
        return False


class RunFolder:
    """One run's output folder. A context manager; leaving it without `finish` leaves an interrupted run.

    * a finished run of the same command, input hash, version and code is there: `finished` is true, its files
      stand;
    * an interrupted one: `resumed` is true, and what it had saved comes back from `load` and `load_arrays`;
    * nothing, or an empty folder: a new run;
    * anything else: refused, unless `overwrite`, which removes the files of the run that was there (and no
      others).

    Every file is written whole or not at all, the marker last: a kill at any point leaves one of them.

    Args:
        folder: where the results go.
        command: the command's name.
        input_hash: of everything that decides the results (see `combined_hash`).
        overwrite: replace what is there.
        code: hash of the sources that decide the results; of the whole package if absent.

    Attributes:
        folder: absolute path.
        finished: whether there is nothing left to do.
        resumed: whether an interrupted run is being continued.

    Raises:
        InputError: something else is there, another process is writing there, or it cannot be written.
    """

    def __init__(
        self, folder: str | Path, command: str, input_hash: str, *, overwrite: bool = False, code: str | None = None
    ) -> None:
        self.folder = Path(folder).expanduser().resolve()
        self._key = {
            "command": command,
            "input_hash": input_hash,
            "version": __version__,
            "code": package_hash() if code is None else code,
        }
        self.finished = self.resumed = False
        self._made: list[Path] = []
        self._outputs: dict[str, int] = {}
        self._lock: IO[bytes] | None = None
        try:
            self._make()
            self._lock = self._locked()
            self._open(overwrite)
        except OSError as error:
            self.close()
            raise InputError(f"the folder cannot be used: {error.strerror}", given=str(folder), where="--out") from None
        except BaseException:
            self._withdraw()
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None:
            self._withdraw()
        self.close()

    def close(self) -> None:
        """Let go of the folder; what was saved stays."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def path(self, name: str) -> Path:
        """Where the output called `name` goes, noted as this run's; a path inside the folder."""
        return self.paths([name])[0]

    def paths(self, names: Iterable[str]) -> list[Path]:
        """As `path` for many at once, noted together: a run of a thousand files writes its marker once."""
        found = [(self.folder / name).resolve() for name in names]
        for path in found:
            if not path.is_relative_to(self.folder) or path == self.folder:
                raise InputError("an output must stay inside the run's folder", given=str(path), where=str(self.folder))
        new = [n for n in (str(path.relative_to(self.folder)) for path in found) if n not in self._outputs]
        if new:
            self._outputs.update(dict.fromkeys(new, -1))
            self._mark("running")
        return found

    def write(self, name: str, content: str | bytes) -> Path:
        """Write an output, whole or not at all, and note it as this run's."""
        path = self.path(name)
        if isinstance(content, str):
            write_text(path, content)
        else:
            with atomic(path, "wb") as stream:
                stream.write(content)
        return path

    def save(self, name: str, value: Any) -> None:
        """Keep a partial result under `name`, for a run that resumes; JSON, so NaN becomes None."""
        write_text(self._partial(name, "json"), dumps({"name": name, "value": value}))

    def load(self, name: str) -> Any | None:
        """The partial result called `name`, None where there is none (or it is damaged)."""
        try:
            found = json.loads(self._partial(name, "json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found.get("value") if isinstance(found, dict) and found.get("name") == name else None

    def save_arrays(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Keep arrays under `name`, for a run that resumes; NaN stays NaN."""
        import numpy as np

        buffer = io.BytesIO()
        np.savez(buffer, **arrays)  # type: ignore[arg-type]
        with atomic(self._partial(name, "npz"), "wb") as stream:
            stream.write(buffer.getvalue())

    def load_arrays(self, name: str) -> dict[str, NDArray[Any]] | None:
        """The arrays called `name`, None where there are none (or they are damaged)."""
        import numpy as np

        try:
            with np.load(self._partial(name, "npz"), allow_pickle=False) as archive:
                return {key: archive[key] for key in archive.files}
        except (OSError, ValueError, KeyError, EOFError, RuntimeError, zipfile.BadZipFile):
            return None

    def finish(self) -> None:
        """Mark the run finished, once all outputs are there; partial results go."""
        self._mark("finished")
        self.finished = True
        shutil.rmtree(self.folder / _PARTIAL, ignore_errors=True)

    def _make(self) -> None:
        """Make the folder, and remember which folders were not there before."""
        missing = [p for p in (self.folder, *self.folder.parents) if not p.exists()]
        self.folder.mkdir(parents=True, exist_ok=True)
        self._made = missing

    def _withdraw(self) -> None:
        """Leave no trace in a new folder if there is nothing yet that a later run could take up."""
        if not self._made or any(p.name not in (MARKER, _LOCK) for p in self.folder.iterdir()):
            return
        for name in (MARKER, _LOCK):
            (self.folder / name).unlink(missing_ok=True)
        for folder in self._made:
            with contextlib.suppress(OSError):  # something else came to lie in it
                folder.rmdir()

    def _open(self, overwrite: bool) -> None:
        for left in self.folder.rglob(".*.part"):  # what a killed process was writing
            left.unlink(missing_ok=True)
        marker = self._read_marker()
        others = [p.name for p in self.folder.iterdir() if p.name != _LOCK]
        if marker is not None and self._is_mine(marker) and not overwrite:
            self._outputs = dict(marker["outputs"])
            whole = all(self._size(name) == size for name, size in self._outputs.items())
            if marker["state"] == "finished" and whole:
                self.finished = True
                return
            self.resumed = True
        elif others and not overwrite:
            raise InputError(
                self._stranger(marker, others), given=str(self.folder), valid="another --out, or --overwrite"
            )
        elif marker is not None:
            for name in marker["outputs"]:
                path = (self.folder / name).resolve()
                if path.is_relative_to(self.folder) and path.is_file():
                    path.unlink()
        if overwrite:
            shutil.rmtree(self.folder / _PARTIAL, ignore_errors=True)
        self._outputs = dict.fromkeys(self._outputs, -1)
        self._mark("running")

    def _read_marker(self) -> dict[str, Any] | None:
        try:
            found = json.loads((self.folder / MARKER).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        if not isinstance(found, dict) or not isinstance(found.get("outputs"), dict) or "state" not in found:
            return None
        return found if all(map(_a_path, found["outputs"])) else None

    def _is_mine(self, marker: Mapping[str, Any]) -> bool:
        return all(marker.get(key) == value for key, value in self._key.items())

    def _stranger(self, marker: Mapping[str, Any] | None, others: list[str]) -> str:
        if marker is None:
            return f"the folder holds other files ({', '.join(sorted(others)[:3])})"
        if marker.get("command") != self._key["command"]:
            return f"the folder holds a run of {str(marker.get('command'))[:40]!r}"
        if marker.get("version") != __version__:
            return f"the folder holds a run of version {str(marker.get('version'))[:20]}"
        if marker.get("input_hash") != self._key["input_hash"]:
            return "the folder holds a run on other inputs"
        return "the folder holds a run of other code: the sources have changed since"

    def _mark(self, state: str) -> None:
        if state == "finished":
            self._outputs = {name: size for name in self._outputs if (size := self._size(name)) >= 0}
        content = {"state": state, **self._key, "outputs": self._outputs}
        write_text(self.folder / MARKER, dumps(content))

    def _size(self, name: str) -> int:
        try:
            return (self.folder / name).stat().st_size
        except OSError:
            return -1

    def _partial(self, name: str, suffix: str) -> Path:
        """A file name that is safe, readable and different for every `name`."""
        readable = re.sub(r"[^\w.+-]+", "_", name)[:60]
        return self.folder / _PARTIAL / f"{readable}-{hashlib.sha256(name.encode()).hexdigest()[:12]}.{suffix}"

    def _locked(self) -> IO[bytes]:
        stream = (self.folder / _LOCK).open("ab")
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            stream.close()
            raise InputError(
                "another process is writing to this folder", given=str(self.folder), where="--out"
            ) from None
        return stream
