"""The report's pictures as figures, to be written as PNG and SVG into DIR/plots."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.view import plotting
from spacerobot.view.report.evidence import Evidence, Surface, Trace, read_evidence
from spacerobot.view.report.words import effects_phrase, finite, unit_text


def figures(verdict: Mapping[str, Any], evidence: Evidence) -> dict[str, Figure]:
    """Name of the file, without its ending -> figure; only those for which there is something to show."""
    drawn = {name: draw() for name, draw in drawings(verdict, evidence).items()}
    return {name: figure for name, figure in drawn.items() if figure is not None}


def report_figures(diagnosis: Diagnosis) -> dict[str, Figure]:
    """The pictures of a diagnosis's report: held-out data, located residuals, rivals.

    Returns:
        name -> figure; only those for which there is something to show.
    """
    return figures(dict(diagnosis.verdict), read_evidence(dict(diagnosis.evidence)))


def drawings(verdict: Mapping[str, Any], evidence: Evidence) -> dict[str, Callable[[], Figure | None]]:
    """Name of the file, without its ending -> what draws its figure, None where there is nothing to show."""
    found: dict[str, Callable[[], Figure | None]] = {}
    for channel in dict.fromkeys(t.channel for t in evidence.shown):
        traces = [t for t in evidence.shown if t.channel == channel]
        found[f"held_out_{_file(channel)}"] = partial(_channel, traces)
    for i, surface in enumerate(evidence.surfaces):
        found[f"residual_{i + 1:02d}_{_file(surface.balance)}_{_file(surface.quantity)}"] = partial(_surface, surface)
    found["rivals"] = partial(_rivals, evidence)
    found["held_out_error"] = partial(_error, verdict.get("held_out") or {})
    return {name: plotting.style()(draw) for name, draw in found.items()}


def _file(name: str) -> str:
    """A name that is safe as part of a file's name."""
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name)[:60] or "x"


def _text(text: str, limit: int = 60) -> str:
    """Plain text for a figure: dollar signs are no mathematics here."""
    return (text if len(text) <= limit else text[: limit - 1] + "…").replace("$", r"\$")


def _channel(traces: list[Trace], limit: int = 4) -> Figure:
    """The trials of a channel in which the models differ most, with the residuals below each."""
    shown = sorted(traces, key=lambda t: -t.gain if math.isfinite(t.gain) else 0.0)[:limit]
    figure = plotting.canvas(4.2 * len(shown) if len(shown) > 1 else 7.0, 5.0)
    grid = figure.subplots(2, len(shown), sharex="col", squeeze=False, height_ratios=(2, 1))
    for i, trace in enumerate(shown):
        above, below = grid[0, i], grid[1, i]
        above.plot(trace.time, trace.measured, ".", ms=3, color=plotting.BLACK, label="measured")
        for which, colour, dash, label in (
            ("before", plotting.VERMILION, "--", "baseline, refitted"),
            ("after", plotting.BLUE, "-", "chosen model"),
        ):
            if len(getattr(trace, which)):
                above.plot(trace.time, getattr(trace, which), dash, color=colour, label=label)
                below.plot(trace.time, trace.residual(which), dash, lw=1.1, color=colour)
        if trace.sigma:
            below.axhspan(-2.0, 2.0, color=plotting.GREEN, alpha=0.15, lw=0)
        above.set_title(_text(f"trial {trace.trial}" + (f" ({trace.condition})" if trace.condition else "")))
        below.set_xlabel("time [s]")
    unit = unit_text(shown[0].unit) or "1"
    grid[0, 0].set_ylabel(_text(f"{shown[0].channel} [{unit}]"))
    grid[1, 0].set_ylabel("off by [σ]" if shown[0].sigma else f"off by [{unit}]")
    grid[0, 0].legend()
    return figure


def _surface(surface: Surface) -> Figure:
    figure = plotting.canvas(6.0, 4.0)
    axes = figure.subplots()
    axes.errorbar(surface.x, surface.y, surface.error, fmt="o", ms=4, color=plotting.BLUE)
    axes.axhline(0.0, color=plotting.GREY, lw=0.8, ls="--")
    axes.set_xlabel(_text(f"{surface.quantity} [{unit_text(surface.unit) or '1'}]"))
    axes.set_ylabel(_text(f"residual of {surface.balance} [{unit_text(surface.y_unit) or '1'}]"))
    return figure


def _rivals(evidence: Evidence, limit: int = 15) -> Figure | None:
    scored = [(finite(h.get("held_out")), effects_phrase(h.get("effects") or ())) for h in evidence.hypotheses]
    known = sorted(((s, n) for s, n in scored if s is not None and math.isfinite(s)), key=lambda p: -p[0])[:limit]
    if len(known) < 2:
        return None
    figure = plotting.canvas(7.5, 1.0 + 0.32 * len(known))
    axes = figure.subplots()
    scores = np.array([max(-s, 0.0) for s, _ in known])
    axes.barh(range(len(known)), scores, color=[plotting.BLUE, *[plotting.GREY] * (len(known) - 1)])
    axes.set_yticks(range(len(known)), [_text(n, 70) for _, n in known])
    axes.invert_yaxis()
    axes.set_xscale("symlog", linthresh=0.1)
    axes.set_xlabel("held-out log score below the best (mean)")
    return figure


def _error(held_out: Mapping[str, Any]) -> Figure | None:
    overall = held_out.get("overall") or {}
    sigma = held_out.get("unit", "sigma") == "sigma"
    rows = [
        ("baseline, refitted", finite(overall.get("rms_before")), plotting.VERMILION),
        ("chosen model", finite(overall.get("rms_after")), plotting.BLUE),
        ("sensor noise", finite(overall.get("noise_floor")), plotting.GREY),
    ]
    known = [(name, value, colour) for name, value, colour in rows if value is not None and math.isfinite(value)]
    if not known:
        return None
    figure = plotting.canvas(6.5, 2.2)
    axes = figure.subplots()
    bars = axes.barh([n for n, _, _ in known], [v for _, v, _ in known], color=[c for _, _, c in known])
    axes.bar_label(bars, fmt="%.3g σ" if sigma else "%.3g", padding=3)
    axes.invert_yaxis()
    axes.set_xlabel(f"rms error on held-out data, {'in sensor σ' if sigma else 'share of spread'}")
    return figure
