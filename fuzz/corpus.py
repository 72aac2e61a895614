"""Inputs to start from: a target's own seeds, and what is kept in the repository because it once was a defect."""

from __future__ import annotations

from pathlib import Path

from fuzz.target import Target

KEPT = Path(__file__).parent / "kept"


def inputs(target: Target) -> list[bytes]:
    """Seeds first, then the kept inputs by name."""
    folder = KEPT / target.name
    kept = sorted(folder.iterdir()) if folder.is_dir() else []
    return [*target.seeds, *(path.read_bytes() for path in kept)]
