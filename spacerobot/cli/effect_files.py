"""Files of effects that a user names with --effects: their code is run, which is said before."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from spacerobot.effects.registry import load_effects
from spacerobot.support.errors import InputError


def read_text(file: str, where: str) -> str:
    """The text of a file that a user named.

    Raises:
        InputError: it cannot be read, or is no UTF-8.
    """
    try:
        return Path(file).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", given=file, where=where) from None
    except ValueError:
        raise InputError("not UTF-8 text", given=file, where=where) from None


def run_effect_files(files: Sequence[str]) -> None:
    """Run the files and add their effects to the catalogue.

    Raises:
        InputError: a file is missing, fails, or defines no effect.
    """
    for file in files:
        print(f"running the code of {file} for its effects", file=sys.stderr, flush=True)
        print(f"effects of {file}: {', '.join(load_effects(file))}", file=sys.stderr)
