"""What a draft still lacks before it can be diagnosed."""

from __future__ import annotations

import re

from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError

_QUESTION = re.compile(r"(?:^|\s)# \?\s*(.*)$")
"""What `study new` could not answer; it stands until its comment is deleted."""

WRIST = ("wrist.mass", "wrist.stiffness", "contact.stiffness", "target.mass")
"""What a wrist rig's baseline is made of."""


def needed(study: Study) -> tuple[str, ...]:
    """Dotted names of the values that a baseline of this kind is made of."""
    channels = study.channels()
    jointed = any(c.startswith("joint.") for c in channels)
    if any(c.startswith("wrist.") or c == "target.x" or (c == "contact.force" and not jointed) for c in channels):
        return WRIST
    if any(c.startswith("body.") for c in channels):
        return ("body.mass",)
    return ()


def unstated(study: Study) -> tuple[str, ...]:
    """Needed values that some trial has neither as a number nor as "unknown"."""
    said = set(study.baseline.unknown)
    return tuple(n for n in needed(study) if n not in said and any(n not in study.values(t) for t in study.trials))


def questions(study: Study) -> tuple[str, ...]:
    """What the comments marked `# ?` still ask, each with its line."""
    text = study.path.read_text(encoding="utf-8-sig", errors="replace")
    found = ((number, _QUESTION.search(line)) for number, line in enumerate(text.splitlines(), 1))
    return tuple(f"line {number}: {match.group(1).strip()}" for number, match in found if match)


def lacks(study: Study) -> str:
    """One line: what still has to be filled in, and what to do then."""
    values, asked = unstated(study), questions(study)
    parts = []
    if values:
        parts.append(f'to state, or to call "unknown": {", ".join(values)}')
    if needed(study) == WRIST and "target.x" not in study.channels():
        parts.append("to say which column is target.x, where the target is along its travel: without it no hit is told")
    if asked:
        more = f"; and {len(asked) - 4} more" if len(asked) > 4 else ""
        parts.append(f"to answer (then delete the comment): {'; '.join(asked[:4])}{more}")
    parts.append("read it through and delete the line `draft = true`")
    return "; then ".join(parts) if len(parts) > 1 else parts[0]


def refuse_draft(study: Study) -> None:
    """Refuse a study that still says it is a draft.

    Raises:
        InputError: it does; with what has to be filled in.
    """
    if study.draft:
        raise InputError(
            "the study is still a draft, with guesses that nobody has confirmed",
            valid=lacks(study),
            where=study.draft_line,
        )
