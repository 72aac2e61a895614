"""What pages, and the schemas of verdict.json and study.toml, take from the code.

What follows `<!-- generated: NAME -->` is replaced when the site is built. Pages that are read in the checkout hold it
too, up to `<!-- end of NAME -->`: `python docs/hooks/generated.py` writes it anew, with `--check` it only says whether
it is current.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

from spacerobot.cli.main import COMMANDS, build_parser
from spacerobot.diagnosis.answer import record
from spacerobot.diagnosis.answer.schema import schema
from spacerobot.recordings import study
from spacerobot.recordings.study_schema import study_schema
from spacerobot.support.jsonio import dumps
from spacerobot.view.docs import GENERATED

_MARK = re.compile(r"^<!-- generated: (\w+) -->$(?:.*?^<!-- end of \1 -->$)?", re.MULTILINE | re.DOTALL)

_IN_CHECKOUT = ("effects.md", "commands.md")
"""Pages that hold what is generated, to be read without building the site."""

SCHEMAS = {
    Path(record.__file__).with_name("verdict.schema.json"): schema,
    Path(study.__file__).with_name("study.schema.json"): study_schema,
}
"""Shipped beside what they are made from, for whoever reads or writes these files without this package's code."""


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Fill the marks; an unknown name fails the build."""
    known = {**GENERATED, "commands": commands}
    return _MARK.sub(lambda m: known[m[1]](), markdown)


def commands() -> str:
    """Every command's help text."""
    lines = []
    with patch.dict(os.environ, {"COLUMNS": "110", "NO_COLOR": "1"}):
        for name, (_, what) in COMMANDS.items():
            actions = build_parser(name)._actions
            found = next(a for a in actions if isinstance(a, argparse._SubParsersAction))
            text = found.choices[name].format_help().rstrip()
            lines += [f"## `spacerobot {name}`", "", f"{what[0].upper()}{what[1:]}.", "", "```text", text, "```", ""]
    return "\n".join(lines)


def held(markdown: str) -> str:
    """The page with its marks kept, and what they stand for between them."""
    known = {**GENERATED, "commands": commands}

    def text(m: re.Match[str]) -> str:
        return f"<!-- generated: {m[1]} -->\n\n{known[m[1]]().strip()}\n\n<!-- end of {m[1]} -->"

    return _MARK.sub(text, markdown)


def main(arguments: list[str]) -> int:
    """Write the pages of the checkout and the schemas, or with --check name those that are not current."""
    stale = []
    for name in _IN_CHECKOUT:
        path = Path(__file__).resolve().parents[1] / name
        text = path.read_text(encoding="utf-8")
        if held(text) != text:
            stale.append(name)
            if "--check" not in arguments:
                path.write_text(held(text), encoding="utf-8")
    for file, made in SCHEMAS.items():
        shipped = dumps(made()) + "\n"
        if not file.is_file() or file.read_text(encoding="utf-8") != shipped:
            stale.append(file.name)
            if "--check" not in arguments:
                file.write_text(shipped, encoding="utf-8")
    if "--check" in arguments and stale:
        print(f"not current: {', '.join(stale)}; run python docs/hooks/generated.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
