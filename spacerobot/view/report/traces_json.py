"""The traces as data for the page's interactive plot: few digits, and no more of them than a page should carry."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from spacerobot.view.report.evidence import Array, Trace

BUDGET = 3_000_000
"""Bytes of trace data in one page; the rest of the page is far below the 5 MB it may have."""


def embedded(traces: Sequence[Trace], budget: int = BUDGET) -> tuple[str, int]:
    """JSON for a <script> element, and how many traces it holds.

    Where not all fit, those stay that show most: trial by trial in the order of how much the chosen model gains.
    """
    order = sorted(traces, key=lambda t: (not t.held_out, -t.gain if math.isfinite(t.gain) else 0.0))
    kept: dict[int, str] = {}
    size = 0
    for trace in order:
        text = json.dumps(_item(trace), allow_nan=False, ensure_ascii=True, separators=(",", ":"))
        if size + len(text) > budget:
            break
        kept[id(trace)] = text
        size += len(text) + 1
    body = ",".join(kept[id(t)] for t in traces if id(t) in kept)
    return f"[{body}]".replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"), len(kept)


def _item(trace: Trace) -> dict[str, Any]:
    values = np.concatenate([trace.measured, trace.before, trace.after])
    values = values[np.isfinite(values)]
    span = float(np.ptp(values)) if len(values) else 1.0
    step = min(trace.sigma / 20.0 if trace.sigma else math.inf, span / 2000.0 if span > 0.0 else math.inf)
    return {
        "trial": trace.trial[:200],
        "condition": trace.condition[:200],
        "channel": trace.channel[:200],
        "unit": trace.unit[:40],
        "sigma": trace.sigma if trace.sigma and math.isfinite(trace.sigma) else None,
        "held": trace.held_out,
        "time": _rounded(trace.time, 1e-5),
        "measured": _rounded(trace.measured, step),
        "before": _rounded(trace.before, step),
        "after": _rounded(trace.after, step),
    }


def _rounded(values: Array, step: float) -> list[float | None]:
    places = 6 if not (step > 0.0 and math.isfinite(step)) else max(0, min(12, math.ceil(-math.log10(step))))
    return [round(float(v), places) if math.isfinite(v) else None for v in values]
