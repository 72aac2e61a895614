"""`spacerobot compare`: two finished diagnoses, or two overlays, side by side."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spacerobot.view.compare.runs import Comparison

_EPILOG = """\
examples:
  spacerobot compare monday tuesday                     two folders of `diagnose --out`, in the terminal
  spacerobot compare monday tuesday --html both.html    the same as one page, with the pictures of both
  spacerobot compare overlay-a overlay-b --json

A row is marked where the two differ: other words, or 95 % intervals that do not meet."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.epilog = _EPILOG
    parser.add_argument("first", metavar="DIR", help="folder of a finished diagnose or overlay")
    parser.add_argument("second", metavar="DIR", help="another of the same command")
    parser.add_argument("--html", metavar="FILE", help="write the page there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it is there")


def run(args: argparse.Namespace) -> int:
    """Compare, print, and write the page that is asked for."""
    from pathlib import Path

    from spacerobot.support.files import may_write, write_text
    from spacerobot.support.jsonio import dumps
    from spacerobot.view.compare.page import page
    from spacerobot.view.compare.runs import compare

    if args.html is not None:
        may_write(Path(args.html), "a file", args.overwrite)
    found = compare(args.first, args.second)
    if args.html is not None:
        write_text(Path(args.html), page(found))
    print(dumps(found.as_json()) if args.json else _text(found, args.html))
    return 0


def _text(found: Comparison, html: str | None) -> str:
    rows = [r for section in found.sections.values() for r in section]
    widths = [max(len(text) for text in column) for column in zip(*((r.what, r.first) for r in rows), strict=True)]
    wide = max(widths[1], len(found.names[0]))
    lines = [f"{'':{widths[0] + 4}}{found.names[0]:{wide}}  {found.names[1]}"]
    for name, section in found.sections.items():
        lines += ["", name]
        lines += [f"{'* ' if r.differ else '  '}{r.what:{widths[0] + 2}}{r.first:{wide}}  {r.second}" for r in section]
    lines += ["", "* differ: other words, or 95 % intervals that do not meet"]
    return "\n".join([*lines, f"page: {html}"] if html else lines)
