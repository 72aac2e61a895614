"""The overlay's figures: each trial's channels with their residuals, and all residuals at a glance."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from spacerobot.diagnosis.forward.base import ChannelOverlay, TrialOverlay
from spacerobot.diagnosis.forward.residuals import residuals
from spacerobot.view.overlay.thinning import broken, envelope
from spacerobot.view.plotting import BLACK, BLUE, GREY, MARKERS, ORANGE, SERIES, VERMILION, canvas, style

POINTS = 1200
"""Samples drawn of one line."""

ROWS = 8
"""Channels drawn of one trial; those with the largest residuals in sigmas if there are more."""

WIDTH, ROW, GAP, TOP, BOTTOM, LEFT, BETWEEN, RIGHT = 11.0, 1.95, 0.45, 0.35, 0.8, 1.0, 1.0, 0.15
"""Of a trial's figure, in inches: to measure every label would take as long as the drawing itself."""

_MEASURED: dict[str, Any] = {"color": BLACK, "linewidth": 2.4, "alpha": 0.35}
_SIMULATED: dict[str, Any] = {"color": VERMILION, "linewidth": 1.2}
_RESIDUAL: dict[str, Any] = {"color": BLUE, "linewidth": 1.0}


def trial_figure(trial: TrialOverlay) -> Figure:
    """Measured and simulated on the left, predicted minus measured on the right, a row for each channel."""
    shown = shown_channels(trial)
    with style():
        height = TOP + ROW * len(shown) - GAP + BOTTOM
        figure = canvas(WIDTH, height, constrained=False)
        panels = figure.subplots(len(shown), 2, squeeze=False, sharex="row", gridspec_kw=_margins(height))
        for (left, right), channel in zip(panels, shown, strict=True):
            _overlay(left, channel)
            _difference(right, channel, trial.touches)
        for axes in panels[-1]:
            axes.set_xlabel("time [s]")
        panels[0, 0].set_title("measured and simulated", loc="left")
        panels[0, 1].set_title("predicted minus measured", loc="left")
        figure.legend(handles=_key(shown, bool(trial.touches)), loc="lower center", ncols=5)
        return figure


def _margins(height: float) -> dict[str, float]:
    """Around and between two columns of panels, as shares of a figure of such a height."""
    column = 0.5 * (WIDTH - LEFT - BETWEEN - RIGHT)
    return {
        "left": LEFT / WIDTH,
        "right": 1.0 - RIGHT / WIDTH,
        "top": 1.0 - TOP / height,
        "bottom": BOTTOM / height,
        "wspace": BETWEEN / column,
        "hspace": GAP / (ROW - GAP),
    }


def shown_channels(trial: TrialOverlay) -> list[ChannelOverlay]:
    """The channels that a trial's figure draws, in their own order."""
    found = [c for c in trial.channels if c.time.size]
    worst = sorted(found, key=lambda c: -np.nan_to_num(residuals([c]).chi2_per_sample))[:ROWS]
    return [c for c in found if any(c is w for w in worst)]


def glance(trials: list[TrialOverlay]) -> Figure:
    """Every trial's residual, a marker for each channel: in sigmas, or as a share where no noise is stated."""
    shown = [(k, c) for k, trial in enumerate(trials) for c in trial.channels if c.time.size]
    stated = all(c.sigma_stated for _, c in shown)
    names = list(dict.fromkeys(c.channel for _, c in shown))
    with style():
        figure = canvas(11.0, 3.6)
        axes = figure.subplots()
        for i, name in enumerate(names):
            found = [(k, residuals([c])) for k, c in shown if c.channel == name]
            axes.plot(
                [k for k, _ in found],
                [r.rms_sigmas if stated else 100.0 * r.share for _, r in found],
                MARKERS[i % len(MARKERS)],
                color=SERIES[i % len(SERIES)],
                markerfacecolor="none",
                markeredgewidth=1.5,
                label=name,
            )
        if stated:
            axes.axhline(1.0, color=GREY, linewidth=1.2, linestyle=(0, (4, 2)), label="noise alone")
        if _decades(axes) > 1.0:
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        else:
            axes.set_ylim(0.0, None)
        axes.set_ylabel("rms residual [σ]" if stated else "rms residual [% of the spread]")
        axes.set_xlabel("trial")
        step = max(1, len(trials) // 25)
        axes.set_xticks(range(0, len(trials), step), [t.id for t in trials[::step]])
        if max(len(t.id) for t in trials) * len(trials[::step]) > 110:
            axes.tick_params(axis="x", rotation=60)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return figure


def _decades(axes: Axes) -> float:
    """Powers of ten between the smallest and the largest value that a figure shows."""
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    values = values[np.isfinite(values) & (values > 0.0)]
    return float(np.log10(values.max() / values.min())) if values.size else 0.0


def readable(unit: str, size: float) -> tuple[float, str]:
    """Factor and name of the unit that numbers of this size are best read in."""
    if unit not in ("m", "rad", "m/s", "rad/s", "N") or not 0.0 < size < np.inf:
        return 1.0, unit
    for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "µ")):
        if size * factor >= (0.1 if factor > 1.0 or unit == "N" else 0.3):
            return factor, prefix + unit
    return 1e9, "n" + unit


def _overlay(axes: Axes, channel: ChannelOverlay) -> None:
    factor, unit = readable(channel.unit, float(np.ptp(channel.measured)))
    low = float(np.median(channel.measured)) if factor > 1.0 and _offset(channel) else 0.0
    time, value = envelope(channel.time, (channel.measured - low) * factor, POINTS)
    axes.plot(time, value, **_MEASURED)
    time, value = channel.time, channel.simulated
    if channel.restarts is not None:
        time, value = broken(time, value, channel.restarts)
    axes.plot(*envelope(time, (value - low) * factor, POINTS), **_SIMULATED)
    axes.set_ylabel(f"{channel.channel}\n[{unit}{'' if low == 0.0 else f', from {low:.4g} {channel.unit}'}]")
    if channel.focus is not None:
        axes.set_xlim(max(channel.focus[0], channel.time[0]), min(channel.focus[1], channel.time[-1]))


def _offset(channel: ChannelOverlay) -> bool:
    return bool(abs(np.median(channel.measured)) > 3.0 * np.ptp(channel.measured))


def _difference(axes: Axes, channel: ChannelOverlay, touches: tuple[float, ...]) -> None:
    factor, unit = readable(channel.unit, float(np.abs(channel.residual).max(initial=0.0)))
    time, value = channel.time, channel.residual * factor
    if channel.restarts is not None:
        time, value = broken(time, value, channel.restarts)
    if channel.sigma > 0.0:
        axes.axhspan(-2 * channel.sigma * factor, 2 * channel.sigma * factor, color=ORANGE, alpha=0.3, linewidth=0)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(*envelope(time, value, POINTS), **_RESIDUAL)
    for touch in touches[:1]:
        axes.axvline(touch, color=GREY, linewidth=1.0, linestyle=":")
    axes.set_ylabel(f"[{unit}]")
    axes.set_title(_said(channel, factor, unit), loc="right", fontsize=9)


def _said(channel: ChannelOverlay, factor: float, unit: str) -> str:
    """The rms, against the noise where it is stated, else against what was recorded."""
    found = residuals([channel])
    text = f"rms {found.rms * factor:.3g} {unit}"
    if found.sigma_stated and np.isfinite(found.rms_sigmas):
        return f"{text} = {found.rms_sigmas:.3g} σ"
    return f"{text} = {100 * found.share:.3g} % of the spread" if np.isfinite(found.share) else text


def _key(channels: list[ChannelOverlay], touches: bool) -> list[Line2D | Patch]:
    band = "±2σ of the noise" if any(c.sigma_stated for c in channels) else "±2σ of the noise (estimated)"
    key: list[Line2D | Patch] = [
        Line2D([], [], label="measured", **_MEASURED),
        Line2D([], [], label="simulated", **_SIMULATED),
        Line2D([], [], label="residual", **_RESIDUAL),
        Patch(facecolor=ORANGE, alpha=0.3, label=band),
    ]
    if touches:
        key.append(Line2D([], [], color=GREY, linewidth=1.0, linestyle=":", label="first touch, simulated"))
    return key
