"""Small SVG charts: built as a tree, so that no text can become markup; coloured by the page's style sheet, so that
they follow dark, light and print. Coordinates in CSS pixels of the view box."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from spacerobot.view.report.words import number

Element = ElementTree.Element
Array = NDArray[np.float64]


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """About `count` round numbers (1, 2 or 5 times a power of ten) within [low, high]."""
    span = high - low
    if not (span > 0.0 and math.isfinite(span)):
        return [low]
    raw = span / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * m for m in (1.0, 2.0, 5.0, 10.0) if power * m >= raw * 0.999)
    first = math.ceil(low / step - 1e-9)
    found = []
    while first * step <= high + 1e-9 * span:
        found.append(first * step)
        first += 1
    return found


def span_of(*arrays: Array, pad: float = 0.06) -> tuple[float, float]:
    """Least and greatest finite value with a margin; (0, 1) where there is none, a unit span around one value."""
    values = np.concatenate([np.asarray(a, dtype=float).ravel() for a in arrays]) if arrays else np.zeros(0)
    values = values[np.isfinite(values)]
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    margin = pad * (high - low) if high > low else max(abs(low) * 0.5, 0.5)
    return low - margin, high + margin


@dataclass(frozen=True)
class Frame:
    """A rectangle of the drawing with a linear scale on both axes."""

    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]

    def px(self, value: float) -> float:
        """Horizontal pixel of a value."""
        return self.left + self.width * (value - self.x[0]) / (self.x[1] - self.x[0])

    def py(self, value: float) -> float:
        """Vertical pixel of a value, growing downwards."""
        return self.top + self.height * (1.0 - (value - self.y[0]) / (self.y[1] - self.y[0]))


def drawing(width: float, height: float, label: str) -> Element:
    """An empty picture with its text alternative."""
    box = f"0 0 {width:g} {height:g}"
    root = Element("svg", {"viewBox": box, "role": "img", "aria-label": label, "class": "chart"})
    ElementTree.SubElement(root, "title").text = label
    return root


def add(parent: Element, tag: str, text: str | None = None, **attributes: object) -> Element:
    """A child element; underscores in names become hyphens, `klass` is class."""
    named = {k.replace("klass", "class").replace("_", "-"): _attribute(v) for k, v in attributes.items()}
    element = ElementTree.SubElement(parent, tag, named)
    element.text = text
    return element


def axes(
    parent: Element,
    frame: Frame,
    x_label: str = "",
    y_label: str = "",
    *,
    x_numbers: bool = True,
    y_numbers: bool = True,
) -> None:
    """Grid, ticks and labels; an axis without numbers has its grid (x) or nothing (y)."""
    bottom, right = frame.top + frame.height, frame.left + frame.width
    for value in ticks(*frame.y, count=max(3, int(frame.height / 34))) if y_numbers else ():
        y = frame.py(value)
        add(parent, "line", klass="grid", x1=frame.left, x2=right, y1=y, y2=y)
        label = number(_clean(value, frame.y), 4)
        add(parent, "text", label, klass="tick", x=frame.left - 6, y=y + 3.5, text_anchor="end")
    for value in ticks(*frame.x, count=max(2, int(frame.width / 90))):
        x = frame.px(value)
        add(parent, "line", klass="grid", x1=x, x2=x, y1=frame.top, y2=bottom)
        if x_numbers:
            label = number(_clean(value, frame.x), 4)
            add(parent, "text", label, klass="tick", x=x, y=bottom + 15, text_anchor="middle")
    add(parent, "line", klass="axis", x1=frame.left, x2=right, y1=bottom, y2=bottom)
    if y_numbers:
        add(parent, "line", klass="axis", x1=frame.left, x2=frame.left, y1=frame.top, y2=bottom)
    if x_label and x_numbers:
        add(parent, "text", x_label, klass="label", x=frame.left + frame.width / 2, y=bottom + 32, text_anchor="middle")
    if y_label:
        x, y = 13.0, frame.top + frame.height / 2
        turn = f"rotate(-90 {x:g} {y:g})"
        add(parent, "text", y_label, klass="label", x=x, y=y, text_anchor="middle", transform=turn)


def ribbon(parent: Element, frame: Frame, x: Array, low: Array, high: Array, klass: str = "floor") -> None:
    """What lies between two curves, cut off at the frame."""
    there = np.concatenate([x, x[::-1]])
    edge = np.clip(np.concatenate([low, high[::-1]]), *frame.y)
    points = " ".join(f"{frame.px(a):.1f},{frame.py(b):.1f}" for a, b in zip(there, edge, strict=True))
    add(parent, "polygon", klass=klass, points=points)


def line(parent: Element, frame: Frame, x: Array, y: Array, klass: str) -> None:
    """A line, broken where a value is missing, cut off at the frame."""
    commands, pen_up = [], True
    for xi, yi in zip(x, y, strict=True):
        if not (math.isfinite(xi) and math.isfinite(yi)):
            pen_up = True
            continue
        yi = min(max(yi, frame.y[0]), frame.y[1])
        commands.append(f"{'M' if pen_up else 'L'}{frame.px(xi):.1f} {frame.py(yi):.1f}")
        pen_up = False
    if commands:
        add(parent, "path", klass=f"line {klass}", d="".join(commands))


def dots(parent: Element, frame: Frame, x: Array, y: Array, klass: str, radius: float = 1.6) -> None:
    """Points as one path of round caps."""
    commands = [
        f"M{frame.px(xi):.1f} {frame.py(yi):.1f}h0"
        for xi, yi in zip(x, y, strict=True)
        if math.isfinite(xi) and math.isfinite(yi) and frame.y[0] <= yi <= frame.y[1]
    ]
    if commands:
        add(parent, "path", klass=f"dots {klass}", d="".join(commands), stroke_width=2.0 * radius)


def band(parent: Element, frame: Frame, low: float, high: float, klass: str = "floor") -> None:
    """A horizontal band between two values."""
    top, bottom = frame.py(min(high, frame.y[1])), frame.py(max(low, frame.y[0]))
    add(parent, "rect", klass=klass, x=frame.left, width=frame.width, y=top, height=max(bottom - top, 0.5))


def error_bars(parent: Element, frame: Frame, x: Array, y: Array, error: Array, names: Sequence[str]) -> None:
    """Points with bars of plus and minus one error, each with its own words on hover."""
    for xi, yi, ei, name in zip(x, y, error, names, strict=True):
        if not (math.isfinite(xi) and math.isfinite(yi)):
            continue
        group = add(parent, "g", klass="point")
        add(group, "title", name)
        if ei > 0.0 and math.isfinite(ei):
            top, low = min(yi + ei, frame.y[1]), max(yi - ei, frame.y[0])
            add(group, "line", klass="bar", x1=frame.px(xi), x2=frame.px(xi), y1=frame.py(top), y2=frame.py(low))
        add(group, "circle", cx=frame.px(xi), cy=frame.py(min(max(yi, frame.y[0]), frame.y[1])), r=3.2)


def markup(root: Element) -> Markup:
    """The picture as text for the page."""
    return Markup(ElementTree.tostring(root, encoding="unicode"))  # noqa: S704 - a tree of ours, texts escaped by it


def _attribute(value: object) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)


def _clean(value: float, axis: tuple[float, float]) -> float:
    """Zero where rounding has left a crumb of it."""
    return 0.0 if abs(value) < 1e-9 * (axis[1] - axis[0]) else value
