"""The report's pictures as SVG, each with a text alternative that says what it shows in numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from spacerobot.view.report import svg
from spacerobot.view.report.evidence import Surface, Trace
from spacerobot.view.report.words import effects_phrase, finite, number, quantity, unit_text

WIDTH = 760.0


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


def trace_chart(trace: Trace, height: float = 330.0) -> Markup:
    """Measured and predicted over time above, what is left of it in noise units below."""
    root = svg.drawing(WIDTH, height, trace_label(trace))
    label = f"{trace.channel} [{unit_text(trace.unit) or '1'}]"
    x = svg.span_of(trace.time, pad=0.01)
    y = svg.span_of(trace.measured, trace.before, trace.after)
    upper = svg.Frame(66, 10, WIDTH - 82, 0.56 * (height - 60), x, y)
    svg.axes(root, upper, y_label=label, x_numbers=False)
    svg.dots(root, upper, trace.time, trace.measured, "measured", radius=2.6)
    for values, klass in ((trace.before, "before"), (trace.after, "after")):
        if len(values):
            svg.line(root, upper, trace.time, values, klass)
    residuals = [trace.residual(which) for which in ("before", "after")]
    if any(len(r) for r in residuals):
        top = upper.top + upper.height + 18
        least = np.array([-3.0, 3.0]) if trace.sigma else np.zeros(1)
        lower = svg.Frame(66, top, WIDTH - 82, height - 42 - top, x, svg.span_of(*residuals, least))
        svg.axes(root, lower, "time [s]", "off by [σ]" if trace.sigma else f"off by [{unit_text(trace.unit) or '1'}]")
        if trace.sigma:
            svg.band(root, lower, -2.0, 2.0)
        for values, klass in zip(residuals, ("before", "after"), strict=True):
            if len(values):
                svg.line(root, lower, trace.time, values, f"thin {klass}")
    return svg.markup(root)


def surface_chart(surface: Surface, width: float = 370.0, height: float = 230.0) -> Markup:
    """Residual force against what it depends on."""
    quantity_label = f"{surface.quantity} [{unit_text(surface.unit) or '1'}]"
    force_label = f"residual [{unit_text(surface.y_unit) or '1'}]"
    low, high = float(np.nanmin(surface.y)), float(np.nanmax(surface.y))
    label = (
        f"Residual of {surface.balance} against {surface.quantity}: from {number(low)} to {number(high)} "
        f"{unit_text(surface.y_unit)} over {number(np.nanmin(surface.x))} to {number(np.nanmax(surface.x))} "
        f"{unit_text(surface.unit)}, {len(surface.x)} points with error bars."
    )
    root = svg.drawing(width, height, label)
    y = svg.span_of(surface.y - surface.error, surface.y + surface.error, np.zeros(1))
    frame = svg.Frame(62, 10, width - 74, height - 54, svg.span_of(surface.x), y)
    svg.axes(root, frame, quantity_label, force_label)
    svg.add(root, "line", klass="zero", x1=frame.left, x2=frame.left + frame.width, y1=frame.py(0.0), y2=frame.py(0.0))
    names = [
        f"{number(x)} {unit_text(surface.unit)}: {number(y)} ± {number(e, 2)} {unit_text(surface.y_unit)}"
        for x, y, e in zip(surface.x, surface.y, surface.error, strict=True)
    ]
    svg.error_bars(root, frame, surface.x, surface.y, surface.error, names)
    return svg.markup(root)


def law_chart(law: Mapping[str, Any], width: float = 560.0, height: float = 280.0) -> Markup:
    """A learned law: the total with the band that holds it everywhere at once, and the curve alone."""
    table = law["table"]
    x, alone, total, low, high = (np.array(table[k], dtype=float) for k in ("x", "law", "total", "low", "high"))
    on, unit, of = law["depends_on"][0], unit_text(table["unit"]), unit_text(table["value_unit"])
    said = f"Learned law at {law['where']} against {on}: from {number(float(total.min()))} to "
    root = svg.drawing(width, height, f"{said}{number(float(total.max()))} {of}, with a band of 95 %.")
    frame = svg.Frame(62, 10, width - 74, height - 54, svg.span_of(x, pad=0.0), svg.span_of(total, alone, np.zeros(1)))
    svg.axes(root, frame, f"{on} [{unit or '1'}]", f"{'stiffness' if law['kind'] == 'memory' else 'force'} [{of}]")
    svg.ribbon(root, frame, x, low, high)
    svg.add(root, "line", klass="zero", x1=frame.left, x2=frame.left + frame.width, y1=frame.py(0.0), y2=frame.py(0.0))
    if table["total_with"]:
        svg.line(root, frame, x, alone, "before")
    svg.line(root, frame, x, total, "after")
    return svg.markup(root)


def improvement_chart(overall: Mapping[str, Any], unit: str = " σ") -> Markup | None:
    """Held-out error before, after and the noise floor, as bars on one scale; None without numbers."""
    rows = [
        ("baseline, refitted", finite(overall.get("rms_before")), "before"),
        ("chosen model", finite(overall.get("rms_after")), "after"),
        ("sensor noise", finite(overall.get("noise_floor")), "noise"),
    ]
    shown = [(name, value, klass) for name, value, klass in rows if value is not None and math.isfinite(value)]
    if not shown:
        return None
    largest = max(value for _, value, _ in shown) or 1.0
    said = ", ".join(f"{name} {number(value, 3)}{unit}" for name, value, _ in shown)
    root = svg.drawing(WIDTH, 34.0 * len(shown) + 8, f"Error on held-out trials: {said}.")
    for i, (name, value, klass) in enumerate(shown):
        y = 6.0 + 34.0 * i
        svg.add(root, "text", name, klass="label", x=150, y=y + 17, text_anchor="end")
        width = max(520.0 * value / largest, 1.5)
        svg.add(root, "rect", klass=f"bar {klass}", x=160, y=y, width=width, height=24, rx=4)
        svg.add(root, "text", f"{number(value, 3)}{unit}", klass="value", x=168 + width, y=y + 17)
    return svg.markup(root)


def parameter_chart(name: str, item: Mapping[str, Any]) -> Markup | None:
    """A parameter's interval beside what was believed, in believed sigmas where those are known."""
    value, believed = finite(item.get("value")), finite(item.get("believed"))
    low, high = (finite(v) for v in (item.get("ci95") or (None, None)))
    numbers = [v for v in (value, believed, low, high) if v is not None and math.isfinite(v)]
    if value is None or believed is None or len(numbers) < 2:
        return None
    sigma, unit = finite(item.get("sigma")), item.get("unit")
    half = 2.0 * sigma if sigma is not None and math.isfinite(sigma) else 0.0
    said = f"{name}: believed {quantity(believed, unit)}, fitted {quantity(value, unit, item.get('ci95'))}."
    root = svg.drawing(360, 62, said)
    span = svg.span_of(np.array([*numbers, believed - half, believed + half]), pad=0.12)
    frame = svg.Frame(10, 6, 340, 32, span, (0.0, 1.0))
    svg.axes(root, frame, y_numbers=False)
    if half:
        width = frame.px(believed + half) - frame.px(believed - half)
        svg.add(root, "rect", klass="floor", x=frame.px(believed - half), y=8, width=width, height=28)
    svg.add(root, "line", klass="before line", x1=frame.px(believed), x2=frame.px(believed), y1=8, y2=36)
    if low is not None and high is not None and math.isfinite(low) and math.isfinite(high):
        svg.add(root, "line", klass="after line", x1=frame.px(low), x2=frame.px(high), y1=22, y2=22)
    svg.add(root, "circle", klass="after", cx=frame.px(value), cy=22, r=5)
    return svg.markup(root)


def rivals_chart(hypotheses: Sequence[Mapping[str, Any]], limit: int = 12) -> Markup | None:
    """Held-out score below the best, of those that were scored on held-out data."""
    scored = []
    for item in hypotheses:
        score = finite(item.get("held_out"))
        if score is not None and math.isfinite(score):
            scored.append((score, effects_phrase(item.get("effects") or ())))
    if len(scored) < 2:
        return None
    scored.sort(key=lambda pair: -pair[0])
    rows = scored[:limit]
    worst = max(max(-score for score, _ in rows), 1e-12)
    said = "; ".join(f"{name} {number(score, 3)}" for score, name in rows)
    root = svg.drawing(WIDTH, 40.0 * len(rows) + 6, f"Held-out log score below the best: {said}.")
    for i, (score, name) in enumerate(rows):
        y = 4.0 + 40.0 * i
        svg.add(root, "text", name, klass="label", x=4, y=y + 12)
        y += 16.0
        # A logarithmic length, since scores run from hundredths to hundreds.
        length = max(300.0 * math.log10(1.0 + 99.0 * max(-score, 0.0) / worst), 2.0)
        klass, value = ("bar after", "best") if i == 0 else ("bar rival", number(score, 3))
        svg.add(root, "rect", klass=klass, x=4, y=y, width=length, height=18, rx=3)
        svg.add(root, "text", value, klass="value", x=12 + length, y=y + 14)
    return svg.markup(root)
