"""The argument parser of all commands: negative numbers as people type them, and mistakes answered in one line."""

from __future__ import annotations

import argparse
import re
import sys
from typing import Any, NoReturn

from spacerobot.support.errors import InputError, NotFoundError, nearest

_NEGATIVE = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?([, ].*)?$|^-inf$")


class Parser(argparse.ArgumentParser):
    """An `ArgumentParser` that raises InputError instead of printing its usage and leaving.

    Options are written out in full, so that a new one can never change what an old script means; a list of numbers
    may begin with any negative one (argparse itself takes -1e-3 for an option).
    """

    def __init__(self, **options: Any) -> None:
        options.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(allow_abbrev=False, **options)
        self._negative_number_matcher = _NEGATIVE

    def error(self, message: str) -> NoReturn:
        """Refuse what was typed."""
        option = re.match(r"argument (?P<name>[^:]+): (?P<what>.*)", message, re.DOTALL)
        if option:
            raise InputError(option["what"], where=option["name"])
        raise InputError(message, valid=f"see `{self.prog} --help`")

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help or version; argparse itself says nothing of a full disk."""
        (file or sys.stdout).write(message)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            kind = {"command": "command", "action": "action"}.get(action.dest, f"value of {_name(action)}")
            raise NotFoundError(kind, str(value), (str(c) for c in action.choices))

    def options(self) -> list[str]:
        """Every option as it is typed, e.g. "--json"."""
        return [text for action in self._actions for text in action.option_strings]

    def refuse(self, extra: list[str]) -> NoReturn:
        """Refuse arguments that nothing took, with the nearest option.

        Args:
            extra: what was left over, not empty.
        """
        unknown = next((text for text in extra if text.startswith("-") and text != "--"), None)
        if unknown is None:
            raise InputError("more arguments than the command takes", given=" ".join(extra), valid=self._usage())
        name = unknown.split("=", 1)[0]
        if name in self.options():
            raise InputError("an option of the command must follow it", given=name, valid=self._usage())
        near = nearest(name, self.options()) if len(name) > 2 else None
        hint = f"did you mean {near!r}? " if near else ""
        raise InputError("unknown option", given=name, valid=f"{hint}see `{self.prog} --help`")

    def _usage(self) -> str:
        return " ".join(self.format_usage().removeprefix("usage: ").split())


def _name(action: argparse.Action) -> str:
    return action.option_strings[0] if action.option_strings else str(action.metavar or action.dest)
