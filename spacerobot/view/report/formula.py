"""Formulas from LaTeX to MathML, which browsers render without any library or font to fetch.

Formulas come from effects, and users may bring their own effects: only elements and attributes known to be inert pass,
and what cannot be converted is shown as it was written.
"""

from __future__ import annotations

from xml.etree import ElementTree

from markupsafe import Markup

_ELEMENTS = frozenset({
    "math", "mrow", "mi", "mo", "mn", "mtext", "mspace", "msub", "msup", "msubsup", "munder", "mover", "munderover",
    "mfrac", "msqrt", "mroot", "mfenced", "mtable", "mtr", "mtd", "mstyle", "mpadded", "mphantom", "menclose",
})  # fmt: skip
_ATTRIBUTES = frozenset({
    "display", "stretchy", "fence", "form", "lspace", "rspace", "width", "height", "depth", "mathvariant", "accent",
    "accentunder", "displaystyle", "scriptlevel", "linethickness", "columnalign", "rowspacing", "columnspacing",
    "separator", "minsize", "maxsize", "movablelimits", "notation",
})  # fmt: skip
_NAMESPACE = "{http://www.w3.org/1998/Math/MathML}"


def mathml(latex: str) -> Markup:
    """A formula as MathML for a page; as escaped text in <code> if it cannot be converted or is not harmless."""
    from latex2mathml.converter import convert

    try:
        # The text has passed no DTD: the converter builds it from its own tree.
        root = ElementTree.fromstring(convert(latex, display="block"))  # noqa: S314
    except Exception:  # whatever the converter makes of a user's LaTeX, the report is still written
        return Markup("<code>{}</code>").format(latex)
    if not all(_harmless(element) for element in root.iter()):
        return Markup("<code>{}</code>").format(latex)
    for element in root.iter():
        element.tag = element.tag.removeprefix(_NAMESPACE)
    _merge_upright(root)
    root.set("aria-label", latex)
    return Markup(ElementTree.tostring(root, encoding="unicode"))  # noqa: S704 - elements and attributes are listed above


def _harmless(element: ElementTree.Element) -> bool:
    tag = element.tag if isinstance(element.tag, str) else ""
    return tag.removeprefix(_NAMESPACE) in _ELEMENTS and set(element.keys()) <= _ATTRIBUTES


def _merge_upright(root: ElementTree.Element) -> None:
    """Words such as "ref" as one upright identifier; letter by letter they are spaced and read out as a product."""
    for parent in root.iter("mrow"):
        children = list(parent)
        if len(children) > 1 and all(c.tag == "mi" and c.get("mathvariant") == "normal" for c in children):
            children[0].text = "".join(c.text or "" for c in children)
            for child in children[1:]:
                parent.remove(child)
