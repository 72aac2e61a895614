"""The report's pictures, each with a text alternative that says what it shows in numbers."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from spacerobot.view import plotting
from spacerobot.view.plotting import BLACK, BLUE, GREEN, GREY, VERMILION
from spacerobot.view.report.evidence import Array, Surface, Trace
from spacerobot.view.report.inline import inline
from spacerobot.view.report.words import effects_phrase, finite, number, quantity, unit_text

WIDTH = 7.6
"""Of the widest pictures, in inches."""

POINTS = "points"
"""What a scatter whose points answer the pointer is called."""


@dataclass(frozen=True)
class Chart:
    """A picture in the colours of `inline.THEME`, what it says, and what each point of it says."""

    figure: Figure
    says: str
    hints: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def inline(self, name: str = "") -> Markup:
        """As part of a page, told apart by a name from another that shows the same."""
        return inline(self.figure, self.says, self.hints, name)


def trace_label(trace: Trace) -> str:
    """What a trace shows, in words and numbers."""
    where = f"{trace.channel} in trial {trace.trial}" + (f" ({trace.condition})" if trace.condition else "")
    held = ", not used in the fit" if trace.held_out else ""
    unit = "times the sensor noise" if trace.sigma else unit_text(trace.unit) or "units"
    parts = [
        f"{name} is off by {number(rms, 2)} {unit} (rms)"
        for name, rms in (("the baseline", trace.rms("before")), ("the chosen model", trace.rms("after")))
        if rms is not None
    ]
    return f"{where}{held}: measured" + (f", and predicted; {'; '.join(parts)}." if parts else ".")


@plotting.style()
def traces_chart(traces: Sequence[Trace], height: float = 3.3) -> Chart:
    """Measured and predicted over time above, what is left of it in noise units below; a column for each trial."""
    figure = _paper(WIDTH if len(traces) == 1 else 4.2 * len(traces), height, top=0.1 if len(traces) == 1 else 0.3)
    grid = figure.subplots(2, len(traces), sharex="col", squeeze=False, height_ratios=(1.7, 1))
    figure.subplots_adjust(hspace=0.12)
    for (above, below), trace in zip(grid.T, traces, strict=True):
        _dots(above, trace.time, trace.measured)
        for which, colour, dash in (("before", VERMILION, "--"), ("after", BLUE, "-")):
            if len(getattr(trace, which)):
                above.plot(trace.time, getattr(trace, which), dash, color=colour)
                below.plot(trace.time, trace.residual(which), dash, lw=1.1, color=colour)
        if trace.sigma:
            below.axhspan(-2.0, 2.0, color=GREEN, alpha=0.15, lw=0)
        above.margins(x=0.01)
        below.set_xlabel("time [s]")
        if len(traces) > 1:
            above.set_title(_text(f"trial {trace.trial}" + (f" ({trace.condition})" if trace.condition else "")))
    unit = unit_text(traces[0].unit) or "1"
    grid[0, 0].set_ylabel(_text(f"{traces[0].channel} [{unit}]"))
    grid[1, 0].set_ylabel("off by [σ]" if traces[0].sigma else f"off by [{unit}]")
    for axes in grid[:, 0]:
        axes.yaxis.set_label_coords(-0.62 / axes.bbox.width * figure.dpi, 0.5)
    return Chart(figure, " ".join(map(trace_label, traces)))


@plotting.style()
def surface_chart(surface: Surface) -> Chart:
    """Residual force against what it depends on."""
    unit, of = unit_text(surface.unit), unit_text(surface.y_unit)
    low, high = float(np.nanmin(surface.y)), float(np.nanmax(surface.y))
    says = (
        f"Residual of {surface.balance} against {surface.quantity}: from {number(low)} to {number(high)} {of} over "
        f"{number(np.nanmin(surface.x))} to {number(np.nanmax(surface.x))} {unit}, {len(surface.x)} points with error "
        "bars."
    )
    figure = _paper(4.2, 2.7)
    axes = figure.subplots()
    there = np.isfinite(surface.x) & np.isfinite(surface.y)
    x, y, error = surface.x[there], surface.y[there], np.nan_to_num(surface.error[there], posinf=0.0)
    axes.vlines(x, y - error, y + error, color=BLUE, lw=1.2)
    axes.scatter(x, y, s=14, color=BLUE, gid=POINTS)
    axes.axhline(0.0, color=GREY, lw=0.8, ls="--")
    axes.xaxis.set_major_locator(MaxNLocator(4))  # five of "0.00025" would run into each other
    axes.set_xlabel(_text(f"{surface.quantity} [{unit or '1'}]"))
    axes.set_ylabel(_text(f"residual [{of or '1'}]"))
    hints = [f"{number(a)} {unit}: {number(b)} ± {number(c, 2)} {of}" for a, b, c in zip(x, y, error, strict=True)]
    return Chart(figure, says, {POINTS: hints})


@plotting.style()
def law_chart(law: Mapping[str, Any]) -> Chart:
    """A learned law: the total with the band that holds it everywhere at once, and the curve alone."""
    table = law["table"]
    x, alone, total, low, high = (np.array(table[k], dtype=float) for k in ("x", "law", "total", "low", "high"))
    on, unit, of = law["depends_on"][0], unit_text(table["unit"]), unit_text(table["value_unit"])
    figure = _paper(WIDTH, 3.2)
    axes = figure.subplots()
    traded = " and ".join(name.rpartition(".")[2].replace("_", " ") for name in table["total_with"])
    axes.plot(x, total, color=BLUE, label=_text(f"with {traded}, which it trades with") if traded else "the law")
    if traded:
        axes.plot(x, alone, "--", color=VERMILION, label="the law alone")
    axes.fill_between(x, low, high, color=GREEN, alpha=0.15, lw=0, label="95 %, everywhere at once")
    axes.axhline(0.0, color=GREY, lw=0.8, ls="--")
    axes.legend(frameon=False)
    axes.margins(x=0.0)
    seen = np.concatenate([total, alone, [0.0]])
    margin = 0.06 * float(np.ptp(seen)) or 1.0
    axes.set_ylim(float(seen.min()) - margin, float(seen.max()) + margin)  # a wide band is cut off, not followed
    axes.set_xlabel(_text(f"{on} [{unit or '1'}]"))
    axes.set_ylabel(_text(f"{'stiffness' if law['kind'] == 'memory' else 'force'} [{of}]"))
    said = f"Learned law at {law['where']} against {on}: from {number(float(total.min()))} to "
    return Chart(figure, f"{said}{number(float(total.max()))} {of}, with a band of 95 %.")


@plotting.style()
def improvement_chart(overall: Mapping[str, Any], unit: str = " σ") -> Chart | None:
    """Held-out error before, after and the noise floor, as bars on one scale; None without numbers."""
    rows = [
        ("baseline, refitted", finite(overall.get("rms_before")), VERMILION),
        ("chosen model", finite(overall.get("rms_after")), BLUE),
        ("sensor noise", finite(overall.get("noise_floor")), GREY),
    ]
    shown = [(name, value, colour) for name, value, colour in rows if value is not None and math.isfinite(value)]
    if not shown:
        return None
    said = ", ".join(f"{name} {number(value, 3)}{unit}" for name, value, _ in shown)
    largest = max(value for _, value, _ in shown) or 1.0
    figure, axes = _sheet(0.36 * len(shown) + 0.08)
    for i, (name, value, colour) in enumerate(shown):
        y = 0.2 + 0.36 * i
        axes.text(1.55, y, name, ha="right", va="center")
        length = max(5.0 * value / largest, 0.015)
        axes.barh(y, length, 0.26, left=1.65, color=colour)
        axes.text(1.75 + length, y, f"{number(value, 3)}{unit}", va="center")
    return Chart(figure, f"Error on held-out trials: {said}.")


@plotting.style()
def parameter_chart(name: str, item: Mapping[str, Any]) -> Chart | None:
    """A parameter's interval beside what was believed, in believed sigmas where those are known."""
    value, believed = finite(item.get("value")), finite(item.get("believed"))
    low, high = (finite(v) for v in (item.get("ci95") or (None, None)))
    numbers = [v for v in (value, believed, low, high) if v is not None and math.isfinite(v)]
    if value is None or believed is None or len(numbers) < 2:
        return None
    sigma, unit = finite(item.get("sigma")), item.get("unit")
    figure = _paper(3.2, 0.6, left=0.1, bottom=0.25)
    axes = figure.subplots()
    if sigma is not None and math.isfinite(sigma):
        axes.axvspan(believed - 2.0 * sigma, believed + 2.0 * sigma, color=GREEN, alpha=0.15, lw=0)
    axes.axvline(believed, color=VERMILION, ls="--")
    if low is not None and high is not None and math.isfinite(low) and math.isfinite(high):
        axes.plot([low, high], [0.0, 0.0], color=BLUE, lw=4)
    axes.plot([value], [0.0], "o", color=BLUE)
    axes.margins(x=0.12)
    axes.locator_params(axis="x", nbins=4)
    axes.yaxis.set_visible(False)
    axes.spines["left"].set_visible(False)
    said = f"{name}: believed {quantity(believed, unit)}, fitted {quantity(value, unit, item.get('ci95'))}."
    return Chart(figure, said)


@plotting.style()
def rivals_chart(hypotheses: Sequence[Mapping[str, Any]], limit: int = 12) -> Chart | None:
    """Held-out score below the best, of those that were scored on held-out data."""
    scored = [(finite(h.get("held_out")), effects_phrase(h.get("effects") or ())) for h in hypotheses]
    rows = sorted(((s, n) for s, n in scored if s is not None and math.isfinite(s)), key=lambda p: -p[0])[:limit]
    if len(rows) < 2:
        return None
    worst = max(max(-score for score, _ in rows), 1e-12)
    named = [(score, textwrap.wrap(name, 100) or [""]) for score, name in rows]
    figure, axes = _sheet(sum(0.16 * len(lines) + 0.26 for _, lines in named) + 0.06)
    y = 0.03
    for i, (score, lines) in enumerate(named):
        axes.text(0.03, y, _text("\n".join(lines), 400), va="top")
        y += 0.16 * len(lines) + 0.13
        # A logarithmic length, since scores run from hundredths to hundreds.
        length = max(3.2 * math.log10(1.0 + 99.0 * max(-score, 0.0) / worst), 0.02)
        axes.barh(y, length, 0.17, left=0.03, color=GREY if i else BLUE)
        axes.text(0.12 + length, y, number(score, 3) if i else "best", va="center")
        y += 0.13
    said = "; ".join(f"{name} {number(score, 3)}" for score, name in rows)
    return Chart(figure, f"Held-out log score below the best: {said}.")


def _paper(
    width: float, height: float, *, left: float = 0.8, right: float = 0.15, bottom: float = 0.5, top: float = 0.1
) -> Figure:
    """An empty figure with margins in inches: laying out by what the labels need takes twice the time to draw."""
    figure = plotting.canvas(width, height)
    figure.set_layout_engine(None)
    sides = {"left": left / width, "right": 1.0 - right / width}
    figure.subplots_adjust(**sides, bottom=bottom / height, top=1.0 - top / height)
    return figure


def _sheet(height: float) -> tuple[Figure, Axes]:
    """An empty sheet whose coordinates are inches from the upper left corner."""
    figure = _paper(WIDTH, height, left=0.0, right=0.0, bottom=0.0, top=0.0)
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set(xlim=(0.0, WIDTH), ylim=(height, 0.0))
    return figure, axes


def _dots(axes: Axes, x: Array, y: Array) -> None:
    """Samples as one path of round caps: a marker each would take ten times the text."""
    there = np.isfinite(x) & np.isfinite(y)
    at = np.repeat(np.column_stack([x[there], y[there]]), 2, axis=0)
    codes = np.tile([Path.MOVETO, Path.LINETO], len(at) // 2)
    if len(at):
        path = Path(at, codes)
        path.should_simplify = False  # lines of no length are what is drawn here
        axes.add_patch(PathPatch(path, fill=False, ec=BLACK, lw=3.6, alpha=0.55, capstyle="round"))
        axes.update_datalim(at)
        axes.autoscale_view()


def _text(text: str, limit: int = 60) -> str:
    """Plain text for a figure: dollar signs are no mathematics here."""
    return (text if len(text) <= limit else text[: limit - 1] + "…").replace("$", r"\$")
