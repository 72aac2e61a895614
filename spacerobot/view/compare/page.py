"""The page of a comparison: one file that opens offline, light or dark as its reader has it."""

from __future__ import annotations

import base64
import hashlib
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from spacerobot import __version__
from spacerobot.support.files import write_text
from spacerobot.view.compare.runs import Comparison, compare


def compare_page(first: str | Path, second: str | Path, path: str | Path) -> Path:
    """Write two finished runs side by side as one HTML file, as `spacerobot compare --html` does.

    Args:
        first, second: folders of `spacerobot diagnose --out`, or both of `spacerobot overlay --out`.
        path: the file.

    Raises:
        InputError: a folder holds neither, or one of each.
    """
    write_text(Path(path), page(compare(first, second)))
    return Path(path)


def page(found: Comparison) -> str:
    """The page as HTML text."""
    view = files("spacerobot.view")
    style = Markup(view.joinpath("report/assets/page.css").read_text(encoding="utf-8").strip())  # noqa: S704 - ours
    digest = base64.b64encode(hashlib.sha256(str(style).encode()).digest()).decode()
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(view.joinpath("templates/compare.html").read_text(encoding="utf-8"))
    policy = f"default-src 'none'; style-src 'sha256-{digest}'; img-src data:; base-uri 'none'; form-action 'none'"
    return template.render(c=found, style=style, policy=policy, version=__version__)
