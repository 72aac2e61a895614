"""Figures of the proof bench: power curves, reliability of the stated confidence, confusion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from spacerobot.proof.rates import Rate, Record, confusion, reliability
from spacerobot.proof.summary import curves, sealed
from spacerobot.view.plotting import BLUE, GREY, MARKERS, SERIES, canvas, style

SIZES = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Marks of the power curves' axis [detection limits]."""


def _bars(points: Sequence[tuple[float, Rate]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    x = np.array([p[0] for p in points])
    y = np.array([p[1].value for p in points])
    spread = np.array([[p[1].value - p[1].low, p[1].high - p[1].value] for p in points]).T
    return x, y, np.maximum(spread, 0.0)


def power(records: Sequence[Record]) -> Figure | None:
    """Share of campaigns in which the hidden effect is the favourite, against its size in detection limits."""
    found = curves(records)
    if not found:
        return None
    with style():
        figure = canvas(8.6, 1.9 * ((len(found) + 1) // 2) + 0.8)
        axes = figure.subplots((len(found) + 1) // 2, 2, sharex=True, sharey=True, squeeze=False).ravel()
        for i, (name, points) in enumerate(found.items()):
            x, y, spread = _bars(points)
            axes[i].errorbar(x, y, yerr=spread, color=SERIES[i % len(SERIES)], marker=MARKERS[i % len(MARKERS)])
            axes[i].axvline(3.0, color=GREY, linestyle="--", linewidth=1.0)
            axes[i].set_title(name, loc="left")
            axes[i].set_xscale("log")
            axes[i].xaxis.set_major_locator(FixedLocator(SIZES))
            axes[i].xaxis.set_minor_locator(NullLocator())
            axes[i].xaxis.set_major_formatter("{x:g}")
            axes[i].set_ylim(-0.05, 1.05)
        for axis in axes[len(found) :]:
            axis.set_axis_off()
        figure.supxlabel("size of the effect [detection limits of the oracle]")
        figure.supylabel("named, share of campaigns")
    return figure


def reliable(records: Sequence[Record]) -> Figure | None:
    """Share of right answers against the confidence that was stated."""
    points = reliability(sealed(records))
    if not points:
        return None
    with style():
        figure = canvas(4.6, 4.2)
        axis = figure.subplots()
        x, y, spread = _bars(points)
        axis.plot([0, 1], [0, 1], color=GREY, linestyle="--", linewidth=1.0, label="as stated")
        axis.errorbar(x, y, yerr=spread, color=BLUE, marker="o", label="found")
        for (a, r), b in zip(points, y, strict=True):
            axis.annotate(f" {r.total}", (a, b), fontsize=8, color=GREY, va="top")
        axis.set_xlabel("stated confidence")
        axis.set_ylabel("share that was right")
        axis.set_xlim(0, 1.02)
        axis.set_ylim(0, 1.05)
        axis.legend(loc="upper left")
    return figure


def confused(records: Sequence[Record]) -> Figure | None:
    """What was said of each hidden effect."""
    table = confusion(sealed(records))
    if not table:
        return None
    rows = sorted(table)
    columns = sorted({said for row in table.values() for said in row}, key=lambda s: (s not in table, s))
    share = np.array([[table[r].get(c, 0) / sum(table[r].values()) for c in columns] for r in rows])
    with style():
        figure = canvas(3.2 + 0.22 * len(columns), 2.4 + 0.22 * len(rows))
        axis = figure.subplots()
        axis.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
        axis.grid(False)
        axis.set_xticks(range(len(columns)), [c.replace(" + ", "\n+ ") for c in columns], rotation=90, fontsize=7)
        axis.set_yticks(range(len(rows)), rows, fontsize=7)
        for i, row in enumerate(rows):
            for j, column in enumerate(columns):
                if count := table[row].get(column, 0):
                    axis.text(
                        j,
                        i,
                        str(count),
                        ha="center",
                        va="center",
                        fontsize=6,
                        color="white" if share[i, j] > 0.5 else "black",
                    )
        axis.set_xlabel("said")
        axis.set_ylabel("hidden")
    return figure


FIGURES = {"power": power, "reliability": reliable, "confusion": confused}
"""Name -> drawing; None where a batch has nothing for it."""
