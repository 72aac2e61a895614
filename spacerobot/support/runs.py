"""The folder of a run: reused when finished, resumed when interrupted, never mixed with anything else."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import io
import json
import os
import re
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from spacerobot import __version__
from spacerobot.support.errors import InputError
from spacerobot.support.files import atomic, left_over, plain_file, write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.run_record import MARKER, Record, finished, half_marker, read_record
from spacerobot.support.sources import package_hash

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MARKER", "RunFolder", "combined_hash"]

_PARTIAL = "partial"
_LOCK = ".lock"
"""Of file systems that cannot lock a folder itself (network ones); there alone it is made."""

_NO_FOLDER_LOCKS = {errno.EBADF, errno.EINVAL, errno.ENOLCK, errno.ENOTSUP, errno.EISDIR}


def combined_hash(*parts: object) -> str:
    """SHA-256 over the text of `parts`: an input hash together with seed and settings."""
    digest = hashlib.sha256()
    for part in parts:
        text = dumps(part, indent=None)
        digest.update(f"{len(text)}:{text}".encode())
    return digest.hexdigest()


_SAVED = re.compile(r"\.?[\w.+-]{0,60}-[0-9a-f]{12}\.(json|npz)(\.[a-z0-9_]{8}\.part)?")
"""Names of partial results, and of what a killed process was writing of one."""


class RunFolder:
    """One run's output folder. A context manager; leaving it without `finish` leaves an interrupted run.

    * a finished run of the same command, input hash, version and code is there, and its files are what it wrote, by
      their hashes: `finished` is true, its files stand;
    * an interrupted one: `resumed` is true, and what it had saved comes back from `load` and `load_arrays`;
    * nothing, or an empty folder: a new run;
    * anything else: refused, unless `overwrite`, which removes the files of the run that was there (and no
      others).

    What no run has written is never touched: a folder is read before anything is made in it, no link is followed out
    of it, and an output is not written over a file of the same name that is somebody else's. Every file is written
    whole or not at all, the marker last: a kill at any point leaves one of the four.

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
        self._overwrite = overwrite
        self._made: list[Path] = []
        self._outputs: dict[str, int] = {}
        self._theirs: set[Path] = set()
        self._lock: int | None = None
        try:
            self._make()
            self._begin(*self._locked())
        except OSError as error:
            self._withdraw()
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
            os.close(self._lock)
            self._lock = None

    def path(self, name: str) -> Path:
        """Where the output called `name` goes, noted as this run's; a path inside the folder."""
        return self.paths([name])[0]

    def paths(self, names: Iterable[str]) -> list[Path]:
        """As `path` for many at once, noted together: a run of a thousand files writes its marker once."""
        found = [self._inside(name) for name in names]
        new = [(n, path) for n, path in ((str(p.relative_to(self.folder)), p) for p in found) if n not in self._outputs]
        if new:
            foreign = next((p for _, p in new if os.path.lexists(p)), None) if not self._overwrite else None
            if foreign is not None:
                raise InputError(
                    "a file is there that this run has not written",
                    given=str(foreign),
                    valid="another --out, or --overwrite",
                )
            self._theirs.update(left_over(p for _, p in new))
            self._outputs.update((n, -1) for n, _ in new)
            self._mark()
        return found

    def _inside(self, name: str) -> Path:
        """Where an output goes; links of folders are followed, and may not lead out. The file itself is no link's."""
        path = self.folder / name
        path = path.parent.resolve() / path.name
        if not path.is_relative_to(self.folder) or path == self.folder or not path.name.strip("."):
            raise InputError("an output must stay inside the run's folder", given=str(path), where=str(self.folder))
        return path

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
        Record("running", self._key, self._outputs).tidy(self.folder, but=self._theirs)
        record = finished(self.folder, self._key, self._outputs)
        record.write(self.folder)
        self._outputs = dict(record.outputs)
        self.finished = True
        self._clear_partial()

    def _make(self) -> None:
        """Make the folder, and remember which folders were not there before."""
        self._made = [p for p in (self.folder, *self.folder.parents) if not p.exists()]
        self.folder.mkdir(parents=True, exist_ok=True)

    def _withdraw(self) -> None:
        """Leave no trace in a new folder if there is nothing yet that a later run could take up."""
        if not self._made or (
            self.folder.is_dir() and any(p.name not in (MARKER, _LOCK) for p in self.folder.iterdir())
        ):
            return
        for name in (MARKER, _LOCK):
            (self.folder / name).unlink(missing_ok=True)
        for folder in self._made:
            with contextlib.suppress(OSError):  # something else came to lie in it
                folder.rmdir()

    def _look(self) -> tuple[Record | None, list[str]]:
        """The record of the run that is there, and the names of whatever is; nothing is changed.

        Raises:
            InputError: what is there is not this run's.
        """
        record = read_record(self.folder)
        others = [p.name for p in self.folder.iterdir() if p.name != _LOCK and not half_marker(p)]
        if self._overwrite:
            return record, others
        if record is not None and self._is_mine(record):
            altered = record.altered(self.folder) if record.state == "finished" else []
            if altered:
                raise InputError(
                    f"a file of the run has been changed since: {altered[0]}",
                    given=str(self.folder),
                    valid="another --out, or --overwrite",
                )
        elif others:
            raise InputError(
                self._stranger(record, others), given=str(self.folder), valid="another --out, or --overwrite"
            )
        return record, others

    def _begin(self, record: Record | None, others: list[str]) -> None:
        """Take up what `_look` found, or clear it away."""
        if record is not None and not self._overwrite:
            self._outputs = dict(record.outputs)
            if record.state == "finished" and not record.missing(self.folder):
                self.finished = True
                self._clear_partial()
                return
            record.tidy(self.folder)
            self._clear_partial(".part")
            self.resumed = True
        elif record is not None:
            record.remove(self.folder)
        elif not others:
            for half in left_over([self.folder / MARKER]):
                half.unlink()
        if self._overwrite:
            self._clear_partial()
        self._theirs.update(left_over([self.folder / MARKER]))
        self._outputs = dict.fromkeys(self._outputs, -1)
        self._mark()

    def _is_mine(self, record: Record) -> bool:
        return all(record.key.get(key) == value for key, value in self._key.items())

    def _stranger(self, record: Record | None, others: list[str]) -> str:
        if record is None:
            return f"the folder holds other files ({', '.join(sorted(others)[:3])})"
        if record.key.get("command") != self._key["command"]:
            return f"the folder holds a run of {str(record.key.get('command'))[:40]!r}"
        if record.key.get("version") != __version__:
            return f"the folder holds a run of version {str(record.key.get('version'))[:20]}"
        if record.key.get("input_hash") != self._key["input_hash"]:
            return "the folder holds a run on other inputs"
        return "the folder holds a run of other code: the sources have changed since"

    def _mark(self) -> None:
        Record("running", self._key, self._outputs).write(self.folder)

    def _partial(self, name: str, suffix: str) -> Path:
        """A file name that is safe, readable and different for every `name`."""
        folder = self.folder / _PARTIAL
        if folder.is_symlink():
            raise InputError("partial results would go through a link", given=str(folder), valid="another --out")
        readable = re.sub(r"[^\w.+-]+", "_", name)[:60]
        return folder / f"{readable}-{hashlib.sha256(name.encode()).hexdigest()[:12]}.{suffix}"

    def _clear_partial(self, ending: str = "") -> None:
        """Remove partial results of this ending, and their folder if nothing else lies in it."""
        folder = self.folder / _PARTIAL
        if folder.is_symlink() or not folder.is_dir():
            return
        with contextlib.suppress(OSError):
            for path in [p for p in folder.iterdir() if self._saved(p, ending)]:
                path.unlink()
            folder.rmdir()

    def _saved(self, path: Path, ending: str) -> bool:
        return bool(_SAVED.fullmatch(path.name)) and path.name.endswith(ending) and plain_file(path)

    def _locked(self) -> tuple[Record | None, list[str]]:
        """Lock the folder and look what is there; a folder is locked as it is, so that nothing is made in it."""
        self._lock = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        if self._flock():
            return self._look()
        self._look()  # before a file is made
        os.close(self._lock)
        self._lock = os.open(self.folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
        self._flock()
        return self._look()

    def _flock(self) -> bool:
        """Lock what is open; False where the file system cannot lock it."""
        assert self._lock is not None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                "another process is writing to this folder", given=str(self.folder), where="--out"
            ) from None
        except OSError as error:
            if error.errno in _NO_FOLDER_LOCKS:
                return False
            raise
        return True
