"""Where a study's files are, and the promise that none outside that folder is opened."""

from __future__ import annotations

import contextlib
import os
import stat
from pathlib import Path

from spacerobot.support.errors import InputError

VARIABLE = "SPACEROBOT_DATA"
"""The one environment variable that a study's `data` may name."""

_MARK = "${" + VARIABLE + "}"


_BESIDE = Path(__file__).resolve().parents[3] / "shared" / "recordings"


def recordings_folder() -> Path | None:
    """The folder named by SPACEROBOT_DATA; without it the one beside a checkout, None where there is none."""
    value = os.environ.get(VARIABLE, "").strip()
    if value:
        return Path(value).expanduser().resolve()
    return _BESIDE if _BESIDE.is_dir() else None


def data_root(study: Path, stated: str | None, given: Path | None, *, where: str | None = None) -> Path:
    """The folder that a study's stream files are relative to.

    Args:
        study: the study file.
        stated: the study's `data` key: `${SPACEROBOT_DATA}/...`, or a folder beneath the study's own.
        given: what the command line says with --data; wins over `stated`.
        where: file and line of the key.

    Raises:
        InputError: no such folder, another variable, or a path that leaves its root.
    """
    if given is not None:
        root = Path(given).expanduser().resolve()
        if not root.is_dir():
            raise InputError("the data folder does not exist", given=str(given), where="--data")
        return root
    home = study.parent.resolve()
    if stated is None:
        return home
    top, rest = home, stated
    if stated.startswith(_MARK):
        named = recordings_folder()
        if named is None:
            raise InputError(
                f"the study's data are under {VARIABLE}, which is not set",
                given=stated,
                valid=f"set {VARIABLE}, or give --data DIR",
                where=where,
            )
        top, rest = named, stated.removeprefix(_MARK).lstrip("/")
    if "$" in rest or "\0" in rest:
        raise InputError(f"data may name no variable but {VARIABLE}", given=stated, where=where)
    return inside(top, rest or ".", where=where, folder=True)


def inside(root: Path, relative: str, *, where: str | None = None, folder: bool | None = False) -> Path:
    """The existing file (or folder; either for None) `relative` to `root`, links resolved.

    Raises:
        InputError: it is outside `root`, or does not exist.
    """
    top, path, within, kind = str(root), "", True, 0
    with contextlib.suppress(OSError, ValueError):  # no such thing; a zero byte
        top = os.path.realpath(root)
        path = os.path.realpath(os.path.join(top, relative))
        within = path == top or path.startswith(os.path.join(top, ""))
        kind = os.stat(path).st_mode if within else 0
    exists = (folder is not True and stat.S_ISREG(kind)) or (folder is not False and stat.S_ISDIR(kind))
    if not within:
        raise InputError("the path leaves the data folder", given=relative, valid=f"inside {top}", where=where)
    if not exists:
        raise InputError(
            f"no such {'folder' if folder else 'file'}", given=relative, valid=f"inside {top}", where=where
        )
    return Path(path)
