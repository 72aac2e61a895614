"""Kinds of verdict, and what a fold leads to, in the words in which they are written."""

from __future__ import annotations

from typing import Final, Literal, TypeAlias

Kind: TypeAlias = Literal[
    "named", "learned", "ambiguous", "unknown", "nothing_missing", "wrong_parameter", "not_trusted"
]

NAMED: Final = "named"
LEARNED: Final = "learned"
AMBIGUOUS: Final = "ambiguous"
UNKNOWN: Final = "unknown"
NOTHING_MISSING: Final = "nothing_missing"
WRONG_PARAMETER: Final = "wrong_parameter"
NOT_TRUSTED: Final = "not_trusted"

SETTLED: Final = (NAMED, LEARNED, WRONG_PARAMETER, NOTHING_MISSING)
"""Verdicts that settle the physics. A value fitted in any other model is no measurement and states no interval."""

LeadsTo: TypeAlias = Literal["the same set", "not told apart from it", "a part of it", "another set"]
"""What a fold leads to by itself. Fewer trials may show less than all of them; they should show nothing else."""

SAME: Final = "the same set"
OPEN: Final = "not told apart from it"
PART: Final = "a part of it"
OTHER: Final = "another set"
"""The same sets, one by one."""

Told: TypeAlias = Literal["before", "after", "selected"]
"""Whose errors are reported: the baseline's, the chosen set's, and those of what each fold would itself have chosen."""

TOLD: Final[tuple[Told, ...]] = ("before", "after", "selected")
