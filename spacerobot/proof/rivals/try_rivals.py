"""Rivals on the same files, each used as its own documentation advises: what they predict, and what they say."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from spacerobot.proof.rivals.opinion import Rival
from spacerobot.proof.rivals.tracks import tracks_of
from spacerobot.recordings.study import load_study


def try_rivals(folder: Path) -> dict[str, Any]:
    """Every rival that is installed, on one study: its opinion and its time, or how it failed."""
    from spacerobot.proof.rivals.bare import bare
    from spacerobot.proof.rivals.sindy import sindy
    from spacerobot.proof.rivals.sysid import sysid

    study = load_study(folder)
    tracks = tracks_of(study)
    rivals: dict[str, Rival] = {"baseline refit": bare, "mujoco.sysid": sysid, "PySINDy": sindy}
    found: dict[str, Any] = {}
    for name, rival in rivals.items():
        began = time.monotonic()
        try:
            opinion = rival(study, tracks)
            found[name] = {"held_out": opinion.held_out, "says": opinion.says, "flagged": opinion.flagged}
        except Exception as error:  # a rival's failure is a result too
            found[name] = {"failed": f"{type(error).__name__}: {error}"[:300]}
        found[name]["seconds"] = time.monotonic() - began
    return found
