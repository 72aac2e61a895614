"""One campaign from order to score: made, sealed, diagnosed blind, the seal broken, scored."""

from __future__ import annotations

import hashlib
import json
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from spacerobot.proof.blind import COMMAND, diagnose
from spacerobot.proof.campaign import seal, write_study
from spacerobot.proof.conceal import conceal
from spacerobot.proof.judge import Judgement, band_share, judge, labels, outside
from spacerobot.proof.oracle import Bench, Fitted, fitted_labels, only_of, starts_of
from spacerobot.proof.orders import Order
from spacerobot.proof.whole.orders import FAMILY
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.support.jsonio import plain

TRIES = 4
"""An order that cannot be played (a size that no rig stands) is drawn anew so often."""

SAME = 1.05
"""A stand-in for a withheld effect that predicts conditions not seen within this factor of the oracle is as good."""

EQUAL = 3.84
"""Another set that costs at most so much more than the hidden one (5 % of a chi-squared) fits as well."""


def play(order: Order, folder: Path, *, rivals: bool = False, command: Sequence[str] = COMMAND) -> dict[str, Any]:
    """Make, seal, diagnose and score one campaign.

    Args:
        order: what to play.
        folder: scratch; the study's folder in it is all that the diagnosis is given. The seal is on no disk.
        rivals: whether rivals are tried on the same files.
        command: the diagnosis.

    Returns:
        the record, ready for JSON; "failed" in it where no campaign could be made.
    """
    began = time.monotonic()
    made = None
    for attempt in range(TRIES):
        try:
            made = conceal(replace(order, seed=order.seed + attempt))
            break
        except (SimulationError, InputError) as error:
            reason = str(error)
    if made is None:
        return not_made(order, reason)
    ready = Ready(
        write=partial(write_study, campaign=made.campaign, readings=made.readings),
        sealed=seal(made.campaign, made.about()),
        trials=len(made.campaign.trials),
        withheld=made.withheld,
        scored=partial(_scored, family=order.family, rivals=rivals),
    )
    return blind(order, folder, ready, began, command)


@dataclass(frozen=True)
class Ready:
    """A campaign that is made, whatever moves in it.

    Attributes:
        write: writes its study into a folder.
        sealed: what is hidden, as JSON.
        trials: how many.
        withheld: effect that the diagnosis must do without.
        scored: what the record says beside the judgement: of the study's folder, the truth, the judgement, the verdict.
    """

    write: Callable[[Path], object]
    sealed: str
    trials: int
    withheld: str | None
    scored: Callable[[Path, dict[str, Any], Judgement, dict[str, Any] | None], dict[str, Any]]


def not_made(order: Order, reason: str) -> dict[str, Any]:
    """The record of an order that cannot be played."""
    return {"name": order.name, **asdict(order), "failed": reason}


def blind(order: Order, folder: Path, ready: Ready, began: float, command: Sequence[str]) -> dict[str, Any]:
    """Write, diagnose blind, break the seal, score; `began` [s, monotonic] is when it was begun to be made."""
    code = hashlib.sha256(f"{order.name} {order.seed}".encode()).hexdigest()[:12]
    study = folder / code
    try:
        ready.write(study)
        prepared = time.monotonic() - began
        answer = diagnose(study, without=ready.withheld, command=command)
        truth = json.loads(ready.sealed)
        judged = judge(truth, answer.verdict, answer.error)
        record = {
            "name": order.name,
            **asdict(order),
            "hidden": labels(truth["effects"]),
            **{k: v for k, v in truth.items() if k not in ("parameters", "rig_as_built")},
            "wrong_values": truth["parameters"],
            **asdict(judged),
            "seconds": answer.seconds,
            "seconds_to_make": prepared,
            "error": answer.error,
            "trials": ready.trials,
            "moved": sorted((answer.verdict or {}).get("parameters", {})),
            **ready.scored(study, truth, judged, answer.verdict),
        }
        found = plain(record)
        assert isinstance(found, dict)
        return found
    finally:
        shutil.rmtree(study, ignore_errors=True)


def _scored(
    study: Path, truth: dict[str, Any], judged: Judgement, verdict: dict[str, Any] | None, *, family: str, rivals: bool
) -> dict[str, Any]:
    if family == FAMILY:  # the bench has no machine of its own for it
        return {"claimed_held_out": _claimed(verdict), "same": False, "equal": False}
    band = None if verdict is None else band_share(truth, verdict)
    out = {
        "claimed_held_out": _claimed(verdict),
        "band_share": band,
        **_compared(study, truth, judged.favourite, verdict),
    }
    if rivals:
        from spacerobot.proof.rivals.try_rivals import try_rivals

        out["rivals"] = try_rivals(study)
    return out


def _claimed(verdict: dict[str, Any] | None) -> float | None:
    overall = ((verdict or {}).get("held_out") or {}).get("overall") or {}
    value = overall.get("rms_after")
    return value if isinstance(value, int | float) else None


def _compared(
    study: Path, truth: dict[str, Any], favourite: tuple[tuple[str, str], ...], verdict: dict[str, Any] | None
) -> dict[str, Any]:
    """Costs and held-out errors of baseline, favourite and oracle on one bench.

    "same": a withheld effect has a stand-in that predicts as well. "equal": another set than the hidden one, with no
    more parameters, costs no more than it does; whoever sees the readings alone cannot know better.
    """
    hidden = labels(truth["effects"])
    known = not outside(truth["effects"])
    out: dict[str, Any] = {"same": False, "equal": False}
    try:
        bench = Bench(study)
        baseline = bench.fitted(())
        out["baseline"] = _numbers(baseline)
        out["samples"] = baseline.fit.samples
        out["channels"] = dict(baseline.channels)
        told = {n: v for n, v in truth["rig_as_built"].items() if isinstance(v, int | float)}
        ids = [t.id for t in bench.trials]
        starts = {**told, **starts_of(truth["effects"])}
        oracle = (
            bench.fitted(fitted_labels(truth["effects"]), starts, only_of(truth["effects"], ids)) if known else None
        )
        if oracle is not None:
            out["oracle"] = _numbers(oracle)
        rival = _rival(favourite, verdict)
        if rival is None:
            return out
        found = bench.fitted(fitted_labels(rival), starts_of(rival), only_of(rival, ids))
        out["favoured"], out["channels"] = _numbers(found), dict(found.channels)
        if oracle is None or labels(rival) == hidden:
            return out
        out["same"] = truth["withheld"] is not None and found.held_out <= SAME * oracle.held_out
        fewer = len(found.fit.hypothesis.free) <= len(oracle.fit.hypothesis.free)
        out["equal"] = bool(hidden and rival and fewer and found.fit.cost <= oracle.fit.cost + EQUAL)
    except (SimulationError, InputError) as error:
        out["bench_error"] = str(error)
    finally:
        if "oracle" in out and "favoured" in out:
            out["held_out_ratio"] = out["favoured"]["held_out"] / out["oracle"]["held_out"]
    return out


def _numbers(found: Fitted) -> dict[str, float]:
    return {"cost": found.fit.cost, "chi2": found.fit.chi2, "held_out": found.held_out}


def _rival(
    favourite: tuple[tuple[str, str], ...], verdict: dict[str, Any] | None
) -> Sequence[Mapping[str, Any]] | None:
    """The set that the bench fits beside the oracle's: the favourite, else the best alternative, else no effect."""
    if verdict is None:
        return None
    if verdict["verdict"] == "named":
        return list(verdict["effects"])
    if verdict["verdict"] in ("wrong_parameter", "nothing_missing"):
        return []
    best = verdict.get("alternatives", [])[:1]
    return list(best[0]["effects"]) if best else []
