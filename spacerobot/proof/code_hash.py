"""Which code a batch was run with: a hash of every source file that a campaign or its verdict depends on."""

from __future__ import annotations

from spacerobot.support.sources import ROOT, hash_of

LAYERS = ("support", "theory", "model", "dynamics", "effects", "simulation", "recordings", "diagnosis", "proof")

AFTERWARDS = ("rates.py", "batch.py", "summary.py", "published.py", "code_hash.py")
"""Files of this layer that only choose what is played next, and count what was scored."""


def code_hash() -> str:
    """SHA-256 over the layers below the pages and commands, 16 hexadecimal digits."""
    files = (path for layer in LAYERS for path in sorted((ROOT / layer).rglob("*.py")))
    return hash_of(p for p in files if not (p.parent.name == "proof" and p.name in AFTERWARDS))
