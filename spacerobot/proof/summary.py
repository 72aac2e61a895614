"""What a batch shows: the rates that the page and the JSON state, from its records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from spacerobot.proof.driven.orders import FAMILY
from spacerobot.proof.labs.orders import FAMILY as LABS
from spacerobot.proof.orders import CURVES, FAMILIES, KINDS, MOVING
from spacerobot.proof.rates import (
    Rate,
    Record,
    calibration_error,
    coverage,
    median_interval,
    place,
    power_curve,
    rate,
    relative_errors,
    smallest_found,
)
from spacerobot.proof.whole.orders import FAMILY as WHOLE

MOVES = (*MOVING, FAMILY, WHOLE)
"""Scenes in which more moves than slider and target."""

SCENES = {
    "rig": "air-bed rig, its arm held",
    "spinning": "target that spins, hit off its centre",
    "chaser": "free-floating chaser, its joints locked",
    "servo arm": "seven joints on servo springs",
    FAMILY: "seven joints driven: friction, load, rotors",
    LABS: "other labs' rigs: springs, masses, speeds, instruments, directions",
    WHOLE: "free-floating chaser, its seven joints free or on servos",
}
"""Scene -> in words."""

STRENGTH_EDGES = (0.0, 0.6, 0.9, 1.25, 1.75, 2.5, 4.0, 6.5, 100.0)

TARGETS: dict[str, tuple[str, str, float]] = {
    "nothing_missing": ("naming nothing where nothing is missing", ">=", 0.95),
    "confidently_wrong": ("confidently wrong, of all campaigns", "<=", 0.05),
    "top": ("favourite right from three detection limits on", ">=", 0.85),
    "in_set": ("truth in the set given, from three detection limits on", ">=", 0.95),
    "wrong_parameter": ("wrong believed value recognised as such", ">=", 0.90),
    "abstained": ("abstention outside the catalogue", ">=", 0.90),
    "spoiled": ("named, or said to be spoiled, where recordings are spoiled", ">=", 0.80),
    "learned": ("law of no catalogue learned, at its port", ">=", 0.90),
    "learned_held_out": ("law learned whose held-out error is within 2 % of the noise", ">=", 0.80),
    "coverage": ("truth inside the 95 % interval", "between", 0.90),
    "calibration": ("expected calibration error of the stated confidence", "<=", 0.05),
    "held_out_ratio": ("median held-out error over the oracle's", "<=", 1.05),
}
"""Key -> (what it says, sense, bound); coverage is to lie between 0.90 and WIDEST."""

NEARLY = 1.02
"""Held-out error over the sensors' noise that a learned law is to keep to; the noise is what it was drawn with."""

WIDEST = 0.98
"""Intervals that hold the truth more often are wider than they say."""


def usable(records: Sequence[Record]) -> list[Record]:
    """Records of campaigns that could be made."""
    return [r for r in records if "failed" not in r]


def sealed(records: Sequence[Record]) -> list[Record]:
    """The campaigns whose favourite counts: not those of the power curves, many of which are below the limit."""
    return [r for r in usable(records) if r["kind"] != "power"]


def noticeable(records: Sequence[Record]) -> list[Record]:
    """Effects of the catalogue hidden at three detection limits or more, the right answer being their name."""
    return [r for r in usable(records) if r["expected"] == "named" and r["strength"] >= 3.0]


def missed(records: Sequence[Record]) -> list[Record]:
    """Campaigns whose answer was wrong: it claims to know what is not so, or lacks what is clearly there.

    Those of the power curves count too; withheld effects with a stand-in that predicts as well do not.
    """
    clear = {id(r) for r in noticeable(records)}
    apart, _ = outside(records)
    return [
        r
        for r in usable(records)
        if not r["same"]
        and (r["confidently_wrong"] or (id(r) in clear and not r["in_set"]) or (r in apart and not r["abstained"]))
    ]


def right(record: Record) -> bool:
    """Whether an answer is none of these."""
    return not missed([record])


def outside(records: Sequence[Record]) -> tuple[list[Record], list[Record]]:
    """(what no catalogue holds and no rival predicts as well, withheld effects that a rival stands in for)."""
    every = [r for r in sealed(records) if r["expected"] == "unknown"]
    return [r for r in every if not r["same"]], [r for r in every if r["same"]]


def rates(records: Sequence[Record]) -> dict[str, Rate]:
    """Every rate of the targets by key; claims that are false, and intervals, are counted in power curves too."""
    counted, played = sealed(records), usable(records)
    seen = noticeable(records)
    apart, _ = outside(records)
    return {
        "nothing_missing": rate((r for r in counted if r["expected"] == "nothing_missing"), lambda r: bool(r["top"])),
        "confidently_wrong": rate((r for r in played if not r["same"]), lambda r: bool(r["confidently_wrong"])),
        "top": rate(seen, lambda r: bool(r["top"])),
        "in_set": rate(seen, lambda r: bool(r["in_set"])),
        "wrong_parameter": rate((r for r in counted if r["expected"] == "wrong_parameter"), lambda r: bool(r["top"])),
        "abstained": rate(apart, lambda r: bool(r["abstained"])),
        "learned": rate((r for r in counted if r["expected"] == "learned"), lambda r: bool(r["top"])),
        "learned_held_out": rate(
            (r for r in counted if r["expected"] == "learned"),
            lambda r: bool(r["top"]) and (r["claimed_held_out"] or math.inf) <= NEARLY,
        ),
        "coverage": coverage([r for r in played if r["expected"] != "spoiled"]),
        "spoiled": rate((r for r in counted if r["expected"] == "spoiled"), lambda r: bool(r["top"])),
    }


def held_out_ratio(records: Sequence[Record]) -> tuple[float, float, float]:
    """Held-out error over the oracle's where effects were named: its median, and the median's 95 % bounds."""
    ratios = [r["held_out_ratio"] for r in sealed(records) if r.get("held_out_ratio") and r["said"] == "named"]
    return (float(np.median(ratios)) if ratios else math.nan, *median_interval(ratios))


def met(key: str, low: float, high: float) -> bool | None:
    """Whether a target is reached, which an interval says, never a bare point.

    Args:
        key: of TARGETS.
        low, high: 95 % bounds of what was found.

    Returns:
        True where all of the interval is on the right side, False where all of it is on the wrong one, None where
        the bound lies inside: nothing is shown then.
    """
    _, sense, bound = TARGETS[key]
    least, most = {"between": (bound, WIDEST), ">=": (bound, math.inf), "<=": (-math.inf, bound)}[sense]
    if least <= low and high <= most:
        return True
    return False if high < least or low > most else None


def by_row(records: Sequence[Record]) -> list[tuple[str, str, list[Record]]]:
    """(kind, group of scenes, records) for each row of the table: the rig's, those where more moves, joint logs."""
    counted = usable(records)
    rows = []
    for kind in KINDS:
        for title, scenes in (("rig", FAMILIES[:1]), ("moving", MOVING), ("joints", (FAMILY,)), ("labs", (LABS,))):
            inside = [r for r in counted if r["kind"] == kind and r["family"] in scenes]
            if inside:
                rows.append((kind, title, inside))
    return rows


def by_scene(records: Sequence[Record]) -> list[tuple[str, list[Record]]]:
    """(scene in words, records), in the order of `SCENES`."""
    groups = [(title, [r for r in usable(records) if r["family"] == name]) for name, title in SCENES.items()]
    return [(title, own) for title, own in groups if own]


def curves(records: Sequence[Record]) -> dict[str, list[tuple[float, Rate]]]:
    """Effect at place -> detection against strength, for those drawn in full."""
    found = {}
    for effect, where in CURVES:
        own = [r for r in usable(records) if r["hidden"] == [[effect, where]] and r["expected"] == "named"]
        if own:
            found[f"{effect} at {where}"] = power_curve(own, STRENGTH_EDGES)
    return found


def smallest(records: Sequence[Record]) -> list[dict[str, Any]]:
    """For each hidden effect: how many campaigns, and the least strength from which on half of them are named."""
    groups: dict[str, list[Record]] = {}
    for r in usable(records):
        if len(r["hidden"]) == 1 and r["expected"] == "named":
            groups.setdefault(place(r["hidden"][0]), []).append(r)
    return [
        {"effect": name, "campaigns": len(own), "limits": smallest_found(own)} for name, own in sorted(groups.items())
    ]


def as_json(records: Sequence[Record], about: dict[str, Any]) -> dict[str, Any]:
    """The batch as one object: what it was, its rates against the targets, its rows."""
    found = rates(records)
    ratio, least, most = held_out_ratio(records)
    error, lower, upper = calibration_error(sealed(records))
    targets = {
        key: {
            "rate": r.value,
            "hits": r.hits,
            "campaigns": r.total,
            "clopper_pearson_95": [r.low, r.high],
            "met": met(key, r.low, r.high) if r.total else None,
        }
        for key, r in found.items()
    }
    errors = relative_errors(usable(records))
    return {
        **about,
        "played": len(records),
        "campaigns": len(sealed(records)),
        "with_moving_joints_or_free_base": sum(r["family"] in MOVES for r in sealed(records)),
        "not_made": [r["name"] for r in records if "failed" in r],
        "diagnosis_failed": [r["name"] for r in usable(records) if r["said"] == "failed"],
        "targets": {
            **targets,
            "calibration": {"error": error, "interval_95": [lower, upper], "met": met("calibration", lower, upper)},
            "held_out_ratio": {
                "median": ratio,
                "interval_95": [least, most],
                "met": met("held_out_ratio", least, most),
            },
        },
        "learned_bands": _band(records),
        "median_parameter_error": float(np.median(errors)) if errors else math.nan,
        "median_seconds": float(np.median([r["seconds"] for r in usable(records)])) if usable(records) else math.nan,
        "smallest_found": smallest(records),
    }


def _band(records: Sequence[Record]) -> dict[str, Any]:
    """How much of the range that was visited the bands of learned laws hold the truth on."""
    shares = [r["band_share"] for r in usable(records) if r.get("band_share") is not None]
    return {"laws": len(shares), "mean_share": float(np.mean(shares)) if shares else math.nan}
