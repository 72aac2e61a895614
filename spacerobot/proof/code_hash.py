"""Which code a batch was run with: a hash of every source file that a campaign or its verdict depends on."""

from __future__ import annotations

import hashlib
from pathlib import Path

import spacerobot

LAYERS = ("support", "theory", "model", "dynamics", "effects", "simulation", "recordings", "diagnosis", "proof")

AFTERWARDS = ("rates.py", "batch.py", "code_hash.py")
"""Files of this layer that only count what was scored."""


def code_hash() -> str:
    """SHA-256 over the layers below the pages and commands, 16 hexadecimal digits."""
    root = Path(spacerobot.__file__).parent
    digest = hashlib.sha256()
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*.py")):
            if layer == "proof" and path.name in AFTERWARDS:
                continue
            digest.update(f"\0{path.relative_to(root)}\0".encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
