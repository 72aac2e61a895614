"""Formulas between dollars become MathML: no script, no font, nothing to fetch."""

from __future__ import annotations

import re
from typing import Any

from spacerobot.view.report.formula import mathml

_FENCE = re.compile(r"(^```.*?^```[ \t]*$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
_FORMULA = re.compile(r"\$\$(.+?)\$\$|(?<![\\$\w])\$(?=\S)([^$\n]+?)(?<=\S)\$(?![\w$])", re.DOTALL)
_found: list[tuple[str, bool]] = []


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put a token in the place of each formula, so that Markdown leaves it alone."""
    _found.clear()

    def token(match: re.Match[str]) -> str:
        _found.append((match[1] or match[2], match[1] is not None))
        return f"FORMULA{len(_found) - 1}ALUMROF"

    parts = _FENCE.split(markdown)
    return "".join(part if i % 2 else _FORMULA.sub(token, part) for i, part in enumerate(parts))


def on_page_content(html: str, page: Any, **_: Any) -> str:
    """Put the formulas in."""

    def formula(match: re.Match[str]) -> str:
        latex, block = _found[int(match[1])]
        text = str(mathml(latex.strip()))
        if text.startswith("<code>"):
            raise ValueError(f"{page.file.src_uri}: cannot be typeset: {latex}")
        return text if block else text.replace('display="block"', 'display="inline"')

    return re.sub(r"FORMULA(\d+)ALUMROF", formula, html)
