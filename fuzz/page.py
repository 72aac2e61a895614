"""The figures of docs/trust.md, from fuzz/results.json and its own tables: python -m fuzz.page docs/trust.md."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).resolve().parent / "results.json"
SHORT = "<!-- in short, by python -m fuzz.page docs/trust.md -->"
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


def short(text: str, found: dict[str, Any]) -> str:
    """The page in six numbers; those that its own tables and lists hold are counted there."""
    rows = {
        "inputs tried on the readers": f"{found['cases']:,}",
        "of these, defects that are left": found["defects"],
        "slowest of them, CPU time": f"{found['slowest case [s]']:.1f} s",
        "most memory over one of them": f"{found['most memory [MB]']:.0f} MB",
        "faults done to commands, all survived": faults(text),
        "defects found in all this, and mended": mended(text),
    }
    return "\n".join(["| | |", "|---|---|", *(f"| {what} | {number} |" for what, number in rows.items())])


def faults(text: str) -> int:
    """The sum of the table of faults."""
    rows = [row.split("|")[2:-1] for row in _section(text, "Faults").splitlines() if row.startswith("|")]
    return sum(int(cell) for row in rows[2:] for cell in row if cell.strip())


def mended(text: str) -> int:
    """The length of the list of defects, whose numbers run through its headings."""
    numbers = [int(n) for n in re.findall(r"^(\d+)\. ", _section(text, "What was found, and mended"), re.MULTILINE)]
    if numbers != list(range(1, len(numbers) + 1)):
        raise ValueError(f"the list of defects is not counted through: {numbers}")
    return len(numbers)


def _section(text: str, title: str) -> str:
    return text.split(f"## {title}\n", 1)[1].split("\n## ", 1)[0]


def filled(text: str, found: dict[str, Any]) -> str:
    """The page with both tables in their places."""
    for mark, content in ((BEGIN, table(found)), (SHORT, short(text, found))):
        before, rest = text.split(mark, 1)
        text = f"{before}{mark}\n\n{content}\n\n{END}{rest.split(END, 1)[1]}"
    return text


if __name__ == "__main__":
    page = Path(sys.argv[1])
    page.write_text(filled(page.read_text(encoding="utf-8"), json.loads(RESULTS.read_text())), encoding="utf-8")
