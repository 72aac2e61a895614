"""One campaign of joint logs from order to score: made, sealed, diagnosed blind, the seal broken, scored."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from spacerobot.proof.blind import COMMAND
from spacerobot.proof.driven.bench import ArmBench, Fitted
from spacerobot.proof.driven.campaign import write_study
from spacerobot.proof.driven.conceal import conceal
from spacerobot.proof.judge import Judgement, labels
from spacerobot.proof.oracle import starts_of
from spacerobot.proof.orders import Order
from spacerobot.proof.record import EQUAL, Ready, blind, not_made
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.support.jsonio import dumps


def play_arm(order: Order, folder: Path, *, command: Sequence[str] = COMMAND) -> dict[str, Any]:
    """Make, seal, diagnose and score one campaign; the record has the keys of the other campaigns'.

    Args:
        order: what to play.
        folder: scratch; the study's folder in it is all that the diagnosis is given. The seal is on no disk.
        command: the diagnosis.
    """
    began = time.monotonic()
    try:
        made = conceal(order)
    except SimulationError as error:
        return not_made(order, str(error))
    ready = Ready(
        write=partial(write_study, campaign=made.campaign, logs=made.logs),
        sealed=dumps(made.truth()),
        trials=len(made.logs),
        withheld=None,
        scored=_compared,
    )
    return blind(order, folder, ready, began, command)


def _compared(
    study: Path, truth: Mapping[str, Any], judged: Judgement, verdict: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Costs and held-out errors of baseline, oracle and favourite on one bench, keys as of the other campaigns."""
    out: dict[str, Any] = {"same": False, "equal": False}
    hidden = labels(truth["effects"])
    try:
        bench = ArmBench(study)
        baseline = bench.fitted((), {})
        out["baseline"], out["samples"] = _numbers(baseline), round(baseline.readings)
        if truth["expected"] != "unknown":
            oracle = bench.fitted(hidden, starts_of(truth["effects"]))
            out["oracle"] = _numbers(oracle)
        if verdict is None:
            return out
        named = list(verdict["effects"])
        found = bench.fitted(labels(named), starts_of(named))
        out["favoured"], out["channels"] = _numbers(found), dict(found.channels)
        if "oracle" in out:
            out["held_out_ratio"] = found.held_out / oracle.held_out
            fewer = sum(len(e["parameters"]) for e in named) <= sum(len(e) - 2 for e in truth["effects"])
            out["equal"] = bool(
                hidden and named and labels(named) != hidden and fewer and found.cost <= oracle.cost + EQUAL
            )
    except (SimulationError, InputError) as error:
        out["bench_error"] = str(error)
    return out


def _numbers(found: Fitted) -> dict[str, float]:
    return {"cost": found.cost, "chi2": found.cost, "held_out": found.held_out}
