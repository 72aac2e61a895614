"""The project's exceptions: one root, each saying what was given, what is valid, and where."""

from __future__ import annotations

from collections.abc import Iterable


class SpacerobotError(Exception):
    """Root of every error the project raises on purpose."""

    exit_code = 1


class InputError(SpacerobotError):
    """Something the user gave cannot be used.

    Attributes:
        what: what was wrong, in one sentence.
        given: the offending value as text, or None.
        valid: what would have been accepted, or None.
        where: file, line or key, or None.
    """

    exit_code = 2

    def __init__(self, what: str, *, given: object = None, valid: str | None = None, where: str | None = None) -> None:
        # Any of them may carry names out of a stranger's file, and ends up on a terminal.
        self.what = _short(what, 800)
        self.given = None if given is None else _short(given)
        self.valid = valid and _short(valid, 1500)
        self.where = where and _short(where, 500)
        parts = [self.what]
        if self.given is not None:
            parts.append(f"given: {self.given}")
        if self.valid:
            parts.append(f"valid: {self.valid}")
        text = "; ".join(parts)
        super().__init__(f"{self.where}: {text}" if self.where else text)


class NotFoundError(InputError):
    """A name that is not known; the message suggests the nearest known one."""

    def __init__(self, kind: str, name: str, known: Iterable[str], *, where: str | None = None) -> None:
        self.kind, self.name, self.known = kind, name, tuple(known)
        near = nearest(name, self.known)
        hint = f"did you mean {near!r}? " if near else ""
        listed = ", ".join(self.known[:24]) + (", ..." if len(self.known) > 24 else "")
        super().__init__(f"unknown {kind}", given=name, valid=f"{hint}known: {listed}", where=where)


class SimulationError(SpacerobotError):
    """A simulation that could not be carried to its end."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like `name`, or None if nothing is alike."""
    import difflib  # only who mistypes waits for it

    lowered = {k.lower(): k for k in known}
    hits = difflib.get_close_matches(name.lower(), list(lowered), n=1, cutoff=0.5)
    return lowered[hits[0]] if hits else None


def _short(value: object, limit: int = 120) -> str:
    """Text of `value` in one line, with nothing in it that a terminal would obey."""
    text = value if isinstance(value, str) else repr(value)
    shown = "".join(c if c.isprintable() else " " if c == "\n" else "?" for c in text[:limit])
    return shown if len(text) <= limit else shown[: limit - 3] + "..."
