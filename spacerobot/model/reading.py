"""Reading URDF text from anyone: size, encoding and entities are settled before a parser sees it."""

from __future__ import annotations

import math
import re

from lxml import etree

from spacerobot.support.errors import InputError

MAX_BYTES = 5_000_000
"""Largest URDF accepted [bytes]; the largest among example-robot-data has 211 kB."""

_FORBIDDEN = re.compile(r"<!\s*(doctype|entity|element|attlist|notation)", re.IGNORECASE)
_ENCODING = re.compile(r"""^\s*<\?xml[^>]*encoding\s*=\s*["']([^"']*)["']""", re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
_LARGEST = 1e9


def parse(text: str | bytes, where: str = "URDF text") -> etree._Element:
    """Parse URDF text into its `<robot>` element, trusting nothing.

    Document types and entities are refused before parsing: some URDF readers drop external entities without
    a word, others follow them.

    Args:
        text: the URDF; bytes must be UTF-8.
        where: what to call it in errors, a path for instance.

    Raises:
        InputError: too large, not UTF-8, has a document type or entities, is not well-formed, or is no URDF.
    """
    if len(text) > MAX_BYTES:
        raise InputError("URDF is too large", given=f"{len(text)} bytes", valid=f"at most {MAX_BYTES}", where=where)
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"URDF is not UTF-8 ({error.reason} at byte {error.start})", where=where) from None
    text = text.lstrip("\ufeff")
    if "\0" in text:
        raise InputError("URDF holds a NUL character", where=where)
    found = _FORBIDDEN.search(text)
    if found:
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(
            "URDF declares a document type or an entity",
            given=found.group(0),
            valid="plain XML without DOCTYPE and entities",
            where=f"{where}, line {line}",
        )
    encoding = _ENCODING.match(text)
    if encoding and encoding.group(1).lower() not in {"utf-8", "utf8", "ascii", "us-ascii"}:
        raise InputError("URDF encoding is not supported", given=encoding.group(1), valid="utf-8", where=where)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(text.strip().encode("utf-8"), parser)
    except etree.XMLSyntaxError as error:
        line = error.position[0] if error.position else 0
        message = (error.msg or "syntax error").split(", line")[0]
        raise InputError(f"URDF is not well-formed XML ({message})", where=f"{where}, line {line}") from None
    if root.tag != "robot":
        hint = "; run xacro first" if "xacro" in str(root.tag) else ""
        raise InputError(f"not a URDF{hint}", given=f"<{root.tag}>", valid="a <robot> element at the top", where=where)
    return root


def at(where: str, element: etree._Element) -> str:
    """`where` with the element's line, if it has one."""
    return f"{where}, line {element.sourceline}" if element.sourceline else where


def number(text: str | None, what: str, where: str) -> float:
    """One finite number of sane size, as URDF writes it.

    Raises:
        InputError: missing, not a number, NaN, infinite, or larger than 1e9.
    """
    if text is None:
        raise InputError(f"{what} is missing", where=where)
    if not _NUMBER.match(text.strip()):
        raise InputError(f"{what} is not a finite number", given=text, valid="a finite number", where=where)
    value = float(text)
    if not math.isfinite(value) or abs(value) > _LARGEST:
        raise InputError(f"{what} is out of range", given=text, valid="a magnitude up to 1e9", where=where)
    return value


def numbers(text: str, count: int, what: str, where: str) -> tuple[float, ...]:
    """Exactly `count` numbers separated by blanks; see `number`."""
    parts = text.split()
    if len(parts) != count:
        raise InputError(f"{what} needs {count} numbers", given=text, where=where)
    return tuple(number(p, what, where) for p in parts)
