"""One line that says what is known of each of several joints."""

from __future__ import annotations

from typing import Any

from spacerobot.view.report.several import several


def verdict(**kinds: str) -> dict[str, Any]:
    parts = [
        {"part": name, "compared": "torque balance", "verdict": kind.removeprefix("silent "), "effects": []}
        | ({"not_measured": "its torque reads nothing"} if kind.startswith("silent ") else {})
        for name, kind in kinds.items()
    ]
    return {"parts": parts}


def test_how_many_joints_are_named_and_what_is_said_of_the_others() -> None:
    kinds = {f"j{n}": "unknown" if n in (2, 4, 7) else "named" for n in range(1, 8)}
    assert several(verdict(**kinds)) == "Named at 4 of 7 joints; nothing of the catalogue explains j2, j4 and j7"


def test_joints_that_are_not_measured_are_listed_and_not_counted() -> None:
    said = several(verdict(a="named", b="named", c="silent not_trusted"))
    assert said == "Named at 2 of 2 joints; nothing can be said of c"


def test_where_one_thing_is_said_of_all_the_verdict_says_it() -> None:
    assert not several(verdict(a="named", b="named"))
    assert not several(verdict(a="unknown"))
    assert not several({})
