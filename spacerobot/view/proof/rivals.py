"""The rivals of the proof bench on the same files, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.proof.rates import Record
from spacerobot.proof.summary import usable
from spacerobot.view.proof.cells import hidden_in, strength_of, table


def rivals(records: Sequence[Record]) -> str:
    """What the rivals predict and say, beside the diagnosis; a sentence where none was tried."""
    own = [r for r in usable(records) if r.get("rivals")]
    if not own:
        return "No rivals were tried in this batch.\n"
    names = list(own[0]["rivals"])
    rows = []
    for name in names:
        tried = [(r, r["rivals"][name]) for r in own]
        good = [(r, o) for r, o in tried if "failed" not in o]
        rows.append(
            [
                name,
                str(len(good)),
                *(_median_mm([o["held_out"].get(c) for _, o in good]) for c in ("target.x", "wrist.x")),
                _flagged([(r, o["flagged"]) for r, o in good], missing=True),
                _flagged([(r, o["flagged"]) for r, o in good], missing=False),
                f"{float(np.median([o['seconds'] for _, o in tried])):.0f} s",
            ]
        )
    rows.append(
        [
            "spacerobot diagnose",
            str(len(own)),
            *(_median_mm([(r.get("channels") or {}).get(c) for r in own]) for c in ("target.x", "wrist.x")),
            _flagged([(r, r["said"] != "nothing_missing") for r in own], missing=True),
            _flagged([(r, r["said"] != "nothing_missing") for r in own], missing=False),
            f"{float(np.median([r['seconds'] for r in own])):.0f} s",
        ]
    )
    head = ["", "n", "held out, target [mm]", "held out, slider [mm]", "speaks up, physics missing"]
    found = table([*head, "speaks up, nothing missing", "time"], rows)
    samples = "\n".join(_quotes(own))
    return (
        "Median rms over conditions left out in turn. PySINDy is driven by the recorded force, so it predicts the "
        "slider alone. No rival names an effect of physics: `mujoco.sysid` reports values and their bounds, PySINDy "
        f"terms of a library, the refit which values moved.\n\n{found}\n{samples}\n"
    )


def _median_mm(values: Sequence[float | None]) -> str:
    known = [v for v in values if v is not None]
    return f"{1e3 * float(np.median(known)):.3f}" if known else "-"


def _flagged(found: Sequence[tuple[Record, bool]], *, missing: bool) -> str:
    own = [flag for r, flag in found if (r["expected"] != "nothing_missing") == missing]
    return f"{sum(own)} of {len(own)}" if own else "-"


def _quotes(records: Sequence[Record], most: int = 3) -> list[str]:
    lines = ["What they said, in the first campaigns with something missing:\n"]
    for record in [r for r in records if r["hidden"]][:most]:
        lines.append(f"- **{hidden_in(record)}**, strength {strength_of(record)}")
        for name, opinion in record["rivals"].items():
            lines.append(f"    - {name}: {opinion.get('says', opinion.get('failed'))}")
        favourite = " + ".join(" at ".join(f) for f in record["favourite"]) or "no effect"
        lines.append(f"    - spacerobot: {record['said']}, {favourite}")
    return lines if len(lines) > 1 else []
