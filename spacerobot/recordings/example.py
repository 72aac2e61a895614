"""A lab's own folder before anyone has written a study, to try the way on: eight runs as a logger left them."""

from __future__ import annotations

import shutil
from pathlib import Path

from spacerobot.support.errors import InputError
from spacerobot.support.resources import folder

NAME = "semicolons"


def example_recordings(out: str | Path) -> Path:
    """Copy the tutorial's raw recordings, which ship with the package, into a folder of yours.

    Args:
        out: a folder that is not there yet, or empty.

    Returns:
        the folder, for `new_study`.

    Raises:
        InputError: something is there already, or the folder cannot be written.
    """
    path = Path(out)
    if path.exists() and not (path.is_dir() and not any(path.iterdir())):
        raise InputError("something is there already", given=str(path), valid="a folder that is new or empty")
    try:
        shutil.copytree(folder("newcomer") / NAME, path, copy_function=shutil.copyfile, dirs_exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", given=str(path)) from None
    return path
