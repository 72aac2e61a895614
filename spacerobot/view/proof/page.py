"""The page of the proof bench, as Markdown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spacerobot.proof.judge import NOTICEABLE
from spacerobot.proof.orders import KINDS
from spacerobot.proof.rates import Record, calibration_error, coverage, rate, relative_errors
from spacerobot.proof.summary import (
    MOVES,
    TARGETS,
    by_row,
    by_scene,
    held_out_ratio,
    met,
    noticeable,
    outside,
    rates,
    sealed,
    smallest,
    usable,
)
from spacerobot.view.proof.cells import favoured_in, hidden_in, strength_of, table
from spacerobot.view.proof.rivals import rivals

_INTRODUCTION = """\
# Proof: concealed physics, found blind

This page is written by `spacerobot prove`. Campaigns come from MuJoCo, an engine that shares no code with this
project's simulator: slider, joints, springs, dampers, dry friction and stops are MuJoCo's own, the contact is an
explicit force, and effects that MuJoCo has no element for are forces added to its own. Sensors sample, filter, delay,
round and drop readings; springs scatter between conditions, speeds are set by hand, noise is partly coloured, believed
values are a little wrong. What is hidden is on no disk while the diagnosis is at work, which runs as a process of its
own on the study's folder alone; the seal is broken afterwards. Every campaign's record is in `proof_records.jsonl`.

A **detection limit** is the size at which a likelihood-ratio test that knows which effect may be there finds it in
95 % of repetitions at the 5 % level. Strengths are sizes in detection limits. Intervals are Clopper and Pearson's at
95 %. The **oracle** is told what is hidden and fits just that. A withheld effect with a stand-in in the catalogue that
predicts conditions not seen within 5 % of the oracle cannot be told from it and is scored apart.
"""

_REACHED = """\
Reached: all of the 95 % interval is on the right side of what was asked; no: all of it is on the wrong one; open: the
bound lies inside, and so many campaigns do not show it. False claims and intervals are counted in the power curves too.
"""

_ROW_NOTES = """\
`weak` gives the residual variance after the baseline's refit over the noise variance. `masked`: one constant of the
baseline was tuned on one trial, as the paper's c_eq is. `rare`: shows in one trial of the campaign. `imitated`: a
sensor does what looks like damping or delay. `withheld`: an effect of the catalogue which the diagnosis had to do
without. `law`: a law of no catalogue at one port, to be learned there (`proof/engine/laws.py`). `moving`: a spinning
target hit off its centre, a free-floating chaser, or a seven-joint arm on servos. That arm has seven modes and the
law that stands for it one: its stiffness is scored against the arm's static one; its mass and damping, which imitate
seven, against those of the tip, and count like all others. `joints`: the same arm driven along paths of its own, its
joints logged; each joint's torque balance is diagnosed, and dry, viscous or quadratic friction, a load on the last
link, a heavier rotor or (in no catalogue) a torque that ripples with the angle is hidden.
`labs`: the air bed's scene with another lab's rig in it: springs of 150 to 12,000 N/m, sliders of 0.25 to 3 kg, tips,
speeds, directions and sampling rates that are drawn, half of the instruments with no noise stated, a quarter of the
labs without a force sensor. `power`: for the power curves, many of them below the limit.
"""

_MISSES = """\
## What went wrong

Every answer that was not right, from three detection limits on; **bold** where it claims to know. A favourite that
costs more than the oracle is a fit that was not found; one that costs no more is what any reader of these recordings
would prefer.
"""


def page(records: Sequence[Record], about: Mapping[str, Any], figures: Mapping[str, str]) -> str:
    """The page.

    Args:
        records: of the batch.
        about: seeds (with their dates), version, code, command.
        figures: name -> path relative to the page.
    """
    counted = sealed(records)
    moving = sum(r["family"] in MOVES for r in counted)
    parts = [
        _INTRODUCTION,
        f"{len(counted)} sealed campaigns ({moving} of them with moving joints, a free base or a spinning target) and "
        f"{len(usable(records)) - len(counted)} more for the power curves; seed {about['seeds']}, "
        f"version {about['version']}, code {about['code']}. `{about['command']}`{_part(records, about)}\n",
        "## Against what was asked\n",
        _targets(records),
        "## By kind of concealment\n",
        _rows(records),
        _ROW_NOTES,
        "## By scene\n",
        _scenes(records),
        _apart(records),
        _misses(records),
        "## Sizes\n",
        _figure(figures, "power", "Power curves: share of campaigns in which the effect is the favourite."),
        _smallest(records),
        "## Confidence and confusion\n",
        _figure(figures, "reliability", "Stated confidence against the share that was right, with counts."),
        _figure(figures, "confusion", "What was said of each hidden effect."),
        "## Rivals on the same files\n",
        rivals(records),
        _failures(records),
    ]
    return "\n".join(p for p in parts if p).rstrip() + "\n"


def _part(records: Sequence[Record], about: Mapping[str, Any]) -> str:
    planned = int(about.get("planned", len(records)))
    if planned <= len(records):
        return ""
    return (
        f"\n\nThis is a part of the batch: {len(records)} of {planned} campaigns have been played "
        "so far. `spacerobot prove --resume docs/proof_records.jsonl --out DIR --docs docs` goes on with the others."
    )


def _targets(records: Sequence[Record]) -> str:
    rows = []
    for key, found in rates(records).items():
        title, sense, bound = TARGETS[key]
        asked = "90 to 98 %" if sense == "between" else f"{sense} {100 * bound:g} %"
        rows.append([title, asked, str(found), _tick(met(key, found.low, found.high)) if found.total else "-"])
    for key, (value, low, high) in (
        ("calibration", calibration_error(sealed(records))),
        ("held_out_ratio", held_out_ratio(records)),
    ):
        title, sense, bound = TARGETS[key]
        said = "-" if math.isnan(value) else f"{value:.3f} ({low:.3f} to {high:.3f})"
        tick = "-" if math.isnan(value) else _tick(met(key, low, high))
        rows.append([title, f"{sense} {bound:g}", said, tick])
    return f"{table(['', 'asked', 'found', 'reached'], rows)}\n{_REACHED}"


def _tick(reached: bool | None) -> str:
    return {True: "yes", False: "no", None: "open"}[reached]


def _share(records: Sequence[Record], key: str) -> str:
    found = rate(records, lambda r: bool(r[key]))
    return "-" if not found.total else f"{100 * found.value:.0f} %"


def _rows(records: Sequence[Record]) -> str:
    rows = []
    for kind, family, own in by_row(records):
        errors, inside = relative_errors(own), coverage(own)
        ratios = [r["held_out_ratio"] for r in own if r.get("held_out_ratio")]
        rows.append(
            [
                kind,
                family,
                str(len(own)),
                _share(own, "top"),
                _share(own, "in_set"),
                _share(own, "abstained"),
                _share(own, "confidently_wrong"),
                f"{100 * float(np.median(errors)):.1f} %" if errors else "-",
                f"{100 * inside.value:.0f} % of {inside.total}" if inside.total else "-",
                f"{float(np.median(ratios)):.3f}" if ratios else "-",
                f"{float(np.median([r['seconds'] for r in own])):.0f} s",
            ]
        )
    head = ["hidden", "scene", "n", "favourite right", "in the set", "abstained", "confidently wrong"]
    return table([*head, "parameter error", "coverage", "held-out / oracle", "time"], rows)


def _scenes(records: Sequence[Record]) -> str:
    head = ["scene", "n", "nothing missing", "wrong value", "named, from three limits on", "abstained outside"]
    rows = []
    for title, own in by_scene(records):
        found = rates(own)
        shares = [found[key] for key in ("nothing_missing", "wrong_parameter", "top", "abstained", "confidently_wrong")]
        rows.append([title, str(len(own)), *(f"{r.hits} of {r.total}" if r.total else "-" for r in shares)])
    return table([*head, "confidently wrong"], rows)


def _apart(records: Sequence[Record]) -> str:
    _, same = outside(records)
    alike = [r for r in noticeable(records) if r["equal"] and not r["top"]]
    lines = []
    if same:
        lines.append(
            f"{len(same)} withheld effects had a stand-in that predicts within 5 % of the oracle: abstained in "
            f"{rate(same, lambda r: bool(r['abstained']))}. They count in no rate above."
        )
    if alike:
        lines.append(
            f"In {len(alike)} campaigns the set that was preferred has no more parameters than the hidden one and fits "
            "the readings as well; they count as misses all the same."
        )
    return "\n".join(lines) + "\n" if lines else ""


def _misses(records: Sequence[Record]) -> str:
    """Every campaign that counts and whose answer was not right; what lies below the limits apart."""
    counted = [r for r in usable(records) if not r["same"] and (not r["top"] or r["confidently_wrong"])]
    counted = [r for r in counted if r["confidently_wrong"] or (r["strength"] or math.inf) >= NOTICEABLE]
    if not counted:
        return ""
    rows = []
    for r in sorted(counted, key=lambda r: (not r["confidently_wrong"], KINDS.index(r["kind"]), r["name"])):
        gap = r["favoured"]["cost"] - r["oracle"]["cost"] if "favoured" in r and "oracle" in r else None
        rows.append(
            [
                r["name"],
                hidden_in(r) + (" (withheld)" if r["withheld"] else ""),
                strength_of(r),
                f"**{r['said']}**" if r["confidently_wrong"] else r["said"],
                favoured_in(r),
                "-" if gap is None else f"{gap:+.0f}",
            ]
        )
    head = ["campaign", "hidden", "strength", "said", "favourite, or values moved", "chi-squared over the oracle's"]
    return f"{_MISSES}\n{table(head, rows)}"


def _figure(figures: Mapping[str, str], name: str, caption: str) -> str:
    return f"![{caption}]({figures[name]})\n\n*{caption}*\n" if name in figures else ""


def _smallest(records: Sequence[Record]) -> str:
    found = smallest(records)
    if not found:
        return ""
    rows = [[s["effect"], str(s["campaigns"]), "-" if s["limits"] is None else f"{s['limits']:.2g}"] for s in found]
    return "Strength from which on an effect is named in at least half of its campaigns:\n\n" + table(
        ["effect", "campaigns", "detection limits"], rows
    )


def _failures(records: Sequence[Record]) -> str:
    lines = []
    broken = [r for r in records if "failed" in r]
    silent = [r for r in usable(records) if r["said"] == "failed"]
    if broken:
        lines.append(f"{len(broken)} campaigns could not be made and are in no table.")
    if silent:
        lines.append(f"{len(silent)} diagnoses gave no answer and count as abstentions that are not right.")
    return "\n".join(lines)
