"""Held-out errors beside what others state for the same recordings, in the same measure and unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from spacerobot.view.report.words import number

INTRO = """\
## Beside quick fits

Those who collected these recordings for this project fitted each of them by hand, knowing which physics to look for.
Their figures are quoted from `quick_fits.toml` beside each study, which the diagnosis never reads; ours are the same
measure of predictions of unseen data, without knowing. Ours is called as good where it is no larger. Where the errors
before differ much, the pieces or starts that theirs were taken over are not known, or our baseline's open values were
fitted.
"""


def beside(verdicts: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Lines of the section; none where no study has figures.

    Args:
        verdicts: by study; "figures" holds what, unit, origin, their and our before and after.
    """
    rows = []
    for name, verdict in verdicts.items():
        for figure in verdict.get("figures", ()):
            theirs, ours = figure["theirs"], figure["ours"]
            good = bool(ours["after"]) and max(ours["after"]) <= max(theirs["after"])
            unit = figure["unit"]
            rows.append(
                f"| [{name}](#{name}) | {figure['what']} [{unit}] | {_range(theirs['before'])} → "
                f"{_range(theirs['after'])} | {_range(ours['before'])} → {_range(ours['after'])} | "
                f"{'yes' if good else 'no'}{'' if not figure.get('note') else ': ' + figure['note']} |"
            )
    if not rows:
        return []
    return [
        INTRO,
        "| study | held-out error | quick fit | diagnosis | as good |\n|---|---|---|---|---|\n" + "\n".join(rows),
        "",
    ]


def _range(values: Sequence[float]) -> str:
    if not values:
        return "not measured"
    ends = [number(v) for v in dict.fromkeys((min(values), max(values)))]
    return " to ".join(ends)
