"""The report's pictures as figures, to be written as PNG and SVG into DIR/plots."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from matplotlib.figure import Figure

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.view.report import charts
from spacerobot.view.report.evidence import Evidence, Trace, read_evidence


def figures(verdict: Mapping[str, Any], evidence: Evidence) -> dict[str, Figure]:
    """Name of the file, without its ending -> figure; only those for which there is something to show."""
    drawn = {name: draw() for name, draw in drawings(verdict, evidence).items()}
    return {name: chart.figure for name, chart in drawn.items() if chart is not None}


def report_figures(diagnosis: Diagnosis) -> dict[str, Figure]:
    """The pictures of a diagnosis's report: held-out data, located residuals, learned laws, rivals.

    Returns:
        name -> figure; only those for which there is something to show.
    """
    return figures(dict(diagnosis.verdict), read_evidence(dict(diagnosis.evidence)))


def drawings(verdict: Mapping[str, Any], evidence: Evidence) -> dict[str, Callable[[], charts.Chart | None]]:
    """Name of the file, without its ending -> what draws it, None where there is nothing to show."""
    found: dict[str, Callable[[], charts.Chart | None]] = {}
    for channel in dict.fromkeys(t.channel for t in evidence.shown):
        traces = [t for t in evidence.shown if t.channel == channel]
        found[f"held_out_{_file(channel)}"] = partial(charts.traces_chart, _apart(traces), 5.0)
    for i, surface in enumerate(evidence.surfaces):
        name = f"residual_{i + 1:02d}_{_file(surface.balance)}_{_file(surface.quantity)}"
        found[name] = partial(charts.surface_chart, surface)
    for i, law in enumerate(verdict.get("learned", ())):
        found[f"learned_{i + 1:02d}_{_file(law['where'])}"] = partial(charts.law_chart, law)
    found["rivals"] = partial(charts.rivals_chart, evidence.hypotheses)
    held_out = verdict.get("held_out") or {}
    unit = " σ" if held_out.get("unit", "sigma") == "sigma" else ""
    found["held_out_error"] = partial(charts.improvement_chart, held_out.get("overall") or {}, unit)
    return found


def _apart(traces: Sequence[Trace], limit: int = 4) -> list[Trace]:
    """The trials of a channel in which the models differ most."""
    return sorted(traces, key=lambda t: -t.gain if math.isfinite(t.gain) else 0.0)[:limit]


def _file(name: str) -> str:
    """A name that is safe as part of a file's name."""
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name)[:60] or "x"
