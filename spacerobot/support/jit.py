"""Numba's decorator as the house uses it, with a disk cache that a changed source cannot leave stale.

Numba looks only at the file of the compiled function, not at those it calls; so the cache folder carries a hash of
every source that compiles anything (its text says so). It lies in the user's cache folder, which also serves
read-only installations.
"""

from __future__ import annotations

import functools
import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent.parent
_COMPILED = ("effects", "simulation", "dynamics", "support")


def cache_folder() -> Path:
    """Where compiled code of these very sources is kept; SPACEROBOT_CACHE moves it."""
    digest = hashlib.sha256()
    for layer in _COMPILED:
        for path in sorted((_PACKAGE / layer).rglob("*.py")):
            text = path.read_bytes()
            if b"jit" in text or b"ompiled" in text:
                digest.update(text)
    root = os.environ.get("SPACEROBOT_CACHE") or os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = Path(root).expanduser() / "spacerobot" / f"numba-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"spacerobot-numba-{os.getuid()}-{digest.hexdigest()[:16]}"
        folder.mkdir(mode=0o700, exist_ok=True)
    return folder


@functools.cache
def numba() -> Any:
    """The numba module, its cache pointed at `cache_folder`."""
    import numba as module

    setattr(module.config, "CACHE_DIR", str(cache_folder()))  # noqa: B010 - numba's own stubs do not know it
    return module


def inlined(function: Any) -> Any:
    """As `jit`, but merged into every compiled caller, which keeps a hot loop whole."""
    return numba().njit(function, cache=True, nogil=True, inline="always")


def jit(function: Any) -> Any:
    """Compile on first call, keep on disk, release the GIL, IEEE arithmetic (no fast-math)."""
    return numba().njit(function, cache=True, nogil=True)
