"""Figures that look alike: one palette for all readers, units on every axis, PNG and SVG from one drawing.

The colours are those of Okabe and Ito (2002), which people with any common colour vision can tell apart; lines also
differ in dash or marker, so that a grey print still reads.
"""

from __future__ import annotations

import base64
import contextlib
import io
from collections.abc import Iterator
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
VERMILION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#7F7F7F"
GRID = "#D9D9D9"

SERIES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""In the order in which series take them."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X")
"""One marker to a series, so that colour is never the only difference."""

_STYLE: Any = {
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "figure.facecolor": "white",
    "font.family": ["DejaVu Sans"],
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.labelsize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.6,
    "errorbar.capsize": 3,
    "svg.fonttype": "none",
    "svg.hashsalt": "spacerobot",
}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """The look of all figures, for the time of the block."""
    with matplotlib.rc_context(_STYLE):
        yield


def canvas(width: float = 7.0, height: float = 4.4, *, constrained: bool = True) -> Figure:
    """An empty figure in inches that no window system knows of; draw inside `style()`.

    Args:
        width, height: in inches.
        constrained: whether room is made for its labels, by measuring each; whoever draws has to otherwise.
    """
    figure = Figure(figsize=(width, height), layout="constrained" if constrained else None)
    FigureCanvasAgg(figure)
    return figure


@contextlib.contextmanager
def _laid_out(figure: Figure) -> Iterator[None]:
    """The house's style, the figure laid out once: whatever saves one that has yet to be laid out draws it twice."""
    with style():
        engine = figure.get_layout_engine()
        if engine is not None and figure.axes:
            engine.execute(figure)
            figure.set_layout_engine(None)
        yield


def png(figure: Figure) -> bytes:
    """The figure as PNG."""
    buffer = io.BytesIO()
    with _laid_out(figure):
        figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def svg(figure: Figure, *, transparent: bool = False) -> str:
    """The figure as SVG text, the same for the same drawing; without a ground of its own if `transparent`."""
    buffer = io.StringIO()
    with _laid_out(figure):
        figure.savefig(buffer, format="svg", transparent=transparent, metadata={"Date": None, "Creator": None})
    return buffer.getvalue()


def svg_uri(figure: Figure) -> str:
    """The figure as a data URI for an <img>, so that a page needs no other file."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg(figure).encode()).decode()


def png_uri(drawn: bytes) -> str:
    """The same of a picture that is drawn already."""
    return "data:image/png;base64," + base64.b64encode(drawn).decode()
