"""Which code campaigns were played with: a hash of every source file that they or their verdicts depend on."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from spacerobot.proof.driven.orders import FAMILY
from spacerobot.support.sources import ROOT, hash_of

LAYERS = ("support", "theory", "model", "dynamics", "effects", "simulation", "recordings", "diagnosis", "proof")

AFTERWARDS = ("batch.py", "code_hash.py", "proved.py", "published.py", "rates.py", "summary.py")
"""Files of `proof` that only choose what is played next, and count what was scored."""

_OTHERS = {
    "diagnosis": "forward diagnose_parts overlay study_check",
    "diagnosis/machines": "axis body choose grid impacts joint_torques platform prescribed simulated "
    "stated_noise test_functions tossed",
    "diagnosis/locate": "of_model series velocity_jump",
    "diagnosis/selection": "forward_selection part_fold part_limits",
    "diagnosis/answer": "alternatives events mended_model part_verdict",
}
ELSEWHERE = tuple(
    f"{k}/{n}" if (ROOT / k / n).is_dir() else f"{k}/{n}.py" for k, v in _OTHERS.items() for n in v.split()
)
"""What a diagnosis of a wrist that meets a target never loads; a test sees to it."""

WRIST = "wrist"


def group(family: str) -> str:
    """Campaigns of which groups of scenes depend on the same code: those with a wrist, or joint logs."""
    return FAMILY if family == FAMILY else WRIST


def code_hashes() -> dict[str, str]:
    """Group -> SHA-256 over its sources, 16 hexadecimal digits."""
    every = [p for p in _sources() if not (p.parent.name == "proof" and p.name in AFTERWARDS)]
    left_out = [ROOT / name for name in (*ELSEWHERE, "proof/driven")]
    wrist = [p for p in every if not any(p.is_relative_to(q) for q in left_out)]
    return {WRIST: hash_of(wrist), FAMILY: hash_of(every)}


def _sources() -> Iterator[Path]:
    for layer in LAYERS:
        yield from sorted((ROOT / layer).rglob("*.py"))
