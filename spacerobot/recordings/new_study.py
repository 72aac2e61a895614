"""A first study written beside recordings: the front door of `spacerobot study new`."""

from __future__ import annotations

import os
from pathlib import Path

from spacerobot.recordings.draft import Draft, draft
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError
from spacerobot.support.files import may_write, write_text


def new_study(
    folder: str | Path,
    out: str | Path | None = None,
    *,
    robot: str | None = None,
    rig: str = "",
    files: str = "*",
    overwrite: bool = False,
) -> Study:
    """Write a first study.toml for the recordings in `folder`, with what else it needs, as `spacerobot study new` does.

    Args:
        folder: with the recordings, and perhaps a URDF.
        out: the file; study.toml in `folder` if None.
        robot: name of the arm that was logged; the URDF among the files if None.
        rig: kind of rig (wrist, arm, platform, body, axis, pendulum), "" to find out.
        files: pattern of the recordings' names; others are not read.
        overwrite: replace a study that is there.

    Returns:
        the draft as it reads; `path` says where it lies.

    Raises:
        InputError: the folder holds no recordings, or a study is there already.
        NotFoundError: no such kind of rig.
    """
    path = study_path(Path(folder), None if out is None else Path(out), overwrite)
    return written(draft(Path(folder), robot, rig=rig, pattern=files), Path(folder), path)


def study_path(folder: Path, out: Path | None, overwrite: bool) -> Path:
    """Where the study of a folder is to be written.

    Raises:
        InputError: something is there, and `overwrite` does not allow it.
    """
    path = out or folder / "study.toml"
    path = path / "study.toml" if path.is_dir() else path
    may_write(path, "a study", overwrite)
    return path


def written(made: Draft, folder: Path, path: Path) -> Study:
    """The draft written to a file, with what it needs beside it unless that is there; read back.

    Raises:
        InputError: it cannot be written.
    """
    try:
        for name, content in made.files.items():
            if not os.path.lexists(path.parent / name):
                write_text(path.parent / name, content)
        write_text(path, made.text())
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", where=str(path)) from None
    return load_study(path, data=folder)
