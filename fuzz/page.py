"""The figures of fuzz/results.json as a table in a page: python -m fuzz.page docs/trust.md."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).resolve().parent / "results.json"
BEGIN, END = "<!-- python -m fuzz.page docs/trust.md -->", "<!-- end -->"


def table(found: dict[str, Any]) -> str:
    """Cases, refusals, the slowest case and the most memory of every reader."""
    rows = [
        "| reader | cases | read | refused | parser died in its child | slowest [s] | most memory [MB] | defects |",
        "|---|---|---|---|---|---|---|---|",
    ]
    keys = ("cases", "read", "refused", "parser died in its child")
    for name, each in found["targets"].items():
        counts = " | ".join(f"{each[key]:,}" for key in keys)
        ends = f"{each['slowest case [s]']} | {each['most memory [MB]']} | {len(each['defects'])}"
        rows.append(f"| `{name}` | {counts} | {ends} |")
    sums = " | ".join(f"{sum(each[key] for each in found['targets'].values()):,}" for key in keys)
    rows.append(f"| all | {sums} | {found['slowest case [s]']} | {found['most memory [MB]']} | {found['defects']} |")
    return "\n".join(rows)


def filled(text: str, found: dict[str, Any]) -> str:
    """The page with the table in its place."""
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    return f"{before}{BEGIN}\n\n{table(found)}\n\n{END}{after}"


if __name__ == "__main__":
    page = Path(sys.argv[1])
    page.write_text(filled(page.read_text(encoding="utf-8"), json.loads(RESULTS.read_text())), encoding="utf-8")
