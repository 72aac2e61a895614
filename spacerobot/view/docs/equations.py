"""The paper's equations and assumptions, from spacerobot.theory."""

from __future__ import annotations

from spacerobot.theory.assumptions import ASSUMPTIONS
from spacerobot.theory.equations import EQUATIONS


def equations() -> str:
    """Eqs. 1 to 19 with the name of the code that holds each."""
    rows = [f"| {e.number} | {_cell(e.says)} | `spacerobot.theory.{e.where}` | {e.status} |" for e in EQUATIONS]
    return "\n".join(["| Eq. | says | where | number |", "|---|---|---|---|", *rows])


def assumptions() -> str:
    """The eight assumptions of the closed forms."""
    rows = [f"| {a.number} | {_cell(a.says)} | {_cell(a.broken_by)} | {_cell(a.measure)} |" for a in ASSUMPTIONS]
    return "\n".join(["| | what is assumed | broken by | measure |", "|---|---|---|---|", *rows])


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("*", "\\*")
