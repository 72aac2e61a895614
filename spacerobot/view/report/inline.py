"""A matplotlib figure as part of a page: its colours are the page's style sheet's, so that they follow dark, light and
print; its text is the page's text; nothing in it is refused by a page that allows no inline styles."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

from markupsafe import Markup
from matplotlib.figure import Figure

from spacerobot.view import plotting

Element = ElementTree.Element

THEME = {
    plotting.BLACK: "--measured",
    plotting.VERMILION: "--before",
    plotting.BLUE: "--after",
    plotting.GREY: "--noise",
    plotting.GREEN: "--within",
    plotting.GRID: "--grid",
}
"""What a figure is drawn in -> the page's name of that colour (assets/page.css)."""

_COLOURS = {colour.lower(): f"var({name})" for colour, name in THEME.items()}
_LONG = re.compile(r"-?\d+\.\d{2,}")


def inline(figure: Figure, says: str, hints: Mapping[str, Sequence[str]] | None = None, name: str = "") -> Markup:
    """The figure as an <svg> element, the same text for the same figure.

    Args:
        figure: drawn in the colours of `THEME`.
        says: its text alternative.
        hints: gid of a scatter -> what each of its points says under the pointer.
        name: told apart from another picture of the page that says the same.
    """
    root = ElementTree.fromstring(plotting.svg(figure, transparent=True))  # noqa: S314 - matplotlib's own text
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    for gid, names in (hints or {}).items():
        points = next(e for e in root.iter("g") if e.get("id") == gid)
        for point, hint in zip(points.iter("use"), names, strict=True):
            ElementTree.SubElement(point, "title").text = hint
    _drop(root, ("metadata", "style"))
    _own_names(root, f"c{hashlib.sha256((name + says).encode()).hexdigest()[:6]}")
    for element in root.iter():
        _plain(element)
    size = root.get("viewBox", "")
    wide = figure.get_figwidth() > 5.0  # whose text would be too small on a telephone
    root.attrib.clear()
    root.attrib.update({"viewBox": size, "role": "img", "aria-label": says, "class": "chart wide" if wide else "chart"})
    title = Element("title")
    title.text = says
    root.insert(0, title)
    return Markup(ElementTree.tostring(root, encoding="unicode"))  # noqa: S704 - a tree, its texts escaped


def _drop(root: Element, tags: Sequence[str]) -> None:
    for parent in [*root.iter()]:
        for child in [c for c in parent if c.tag in tags]:
            parent.remove(child)


def _own_names(root: Element, prefix: str) -> None:
    """Only names that something refers to, and none that another picture of the page has."""
    texts = [v for e in root.iter() for k, v in e.attrib.items() if k != "id"]
    used = {name for text in texts for name in re.findall(r"#([A-Za-z][\w-]*)", text)}
    for element in root.iter():
        name = element.attrib.pop("id", None)
        if name in used:
            element.set("id", f"{prefix}{name}")
        for key, text in [*element.attrib.items()]:
            if key.endswith("}href"):
                del element.attrib[key]
                element.set("href", f"#{prefix}{text[1:]}")
            elif text.startswith("url(#"):
                element.set(key, f"url(#{prefix}{text[5:]}")


def _plain(element: Element) -> None:
    """Styles as attributes, in the page's colours and font; two decimals of a point; no space that draws nothing."""
    for item in element.attrib.pop("style", "").split(";"):
        key, _, value = (part.strip() for part in item.partition(":"))
        if key and key != "font-family":
            element.set(key, _COLOURS.get(value, value))
    for key, text in element.attrib.items():
        if key not in ("id", "href", "clip-path"):
            element.set(key, " ".join(_LONG.sub(_short, text).split()))
    element.text = element.text if element.tag in ("text", "title") else None
    element.tail = None


def _short(found: re.Match[str]) -> str:
    return f"{float(found[0]):.2f}".rstrip("0").rstrip(".")
