"""Which code a result was made with: a hash of source files, and of what else ships with the package."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import spacerobot
from spacerobot.support.resources import folder

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
    """Of every file of the package: it changes with a formula, a template or a bundled robot, not the version alone.

    Compiled code beside the sources does not count, nor do bundled studies: a run's input hash has the one it reads.
    """
    digest = hashlib.sha256()
    for root in (ROOT, folder("urdf")):
        for path in sorted(p for p in root.rglob("*") if p.is_file() and _decides(p.relative_to(root))):
            digest.update(f"\0{path.relative_to(root)}\0".encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _decides(path: Path) -> bool:
    return "__pycache__" not in path.parts and path.parts[0] != "_data"
