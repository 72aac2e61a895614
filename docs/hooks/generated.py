"""What pages take from the code: `<!-- generated: NAME -->` is replaced when the site is built."""

from __future__ import annotations

import argparse
import os
import re
from typing import Any
from unittest.mock import patch

from spacerobot.cli.main import COMMANDS, build_parser
from spacerobot.view.docs import GENERATED

_MARK = re.compile(r"^<!-- generated: (\w+) -->$", re.MULTILINE)


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
