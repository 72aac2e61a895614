"""Which code a result was made with: a hash of source files."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import spacerobot

ROOT = Path(spacerobot.__file__).parent
"""Folder of the package."""


def hash_of(files: Iterable[Path]) -> str:
    """SHA-256 over names and contents of files of the package, 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(f"\0{path.relative_to(ROOT)}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def package_hash() -> str:
    """Of every source file of the package: it changes with a formula, also where the version does not."""
    return hash_of(sorted(ROOT.rglob("*.py")))
