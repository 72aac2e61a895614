"""What is said of each of several joints or bodies, in one line: of how many it is named, and what of the others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.view.report.words import joined

_REST = {
    "learned": "a law was learned at {}",
    "ambiguous": "candidates are not told apart at {}",
    "unknown": "nothing of the catalogue explains {}",
    "wrong_parameter": "a believed value is wrong at {}",
    "nothing_missing": "nothing is missing at {}",
    "not_trusted": "the fit failed its own checks at {}",
}


def several(verdict: Mapping[str, Any]) -> str:
    """ "Named at 4 of 7 joints; nothing of the catalogue explains 2, 4 and 7"; empty where one thing is said of all."""
    parts = verdict.get("parts") or ()
    told = [p for p in parts if not p.get("not_measured")]
    if len(parts) < 2 or (len({p["verdict"] for p in told}) == 1 and len(told) == len(parts)):
        return ""
    noun = "joints" if all(p["compared"] == "torque balance" for p in parts) else "parts"
    said = []
    named = [p for p in told if p["verdict"] == "named"]
    said.append(f"named at {len(named) or 'none'} of {len(told)} {noun}")
    for kind, text in _REST.items():
        if those := [str(p["part"]) for p in told if p["verdict"] == kind]:
            said.append(text.format(joined(those)))
    if rest := [str(p["part"]) for p in parts if p.get("not_measured")]:
        said.append(f"nothing can be said of {joined(rest)}")
    line = "; ".join(said)
    return line[0].upper() + line[1:]
