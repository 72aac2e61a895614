"""The `spacerobot` command: a table of subcommands, each loaded only when it is called."""

from __future__ import annotations

import argparse
import importlib
import re
import sys
from collections.abc import Sequence

from spacerobot import __version__
from spacerobot.support.errors import SpacerobotError

COMMANDS: dict[str, tuple[str, str]] = {
    "robots": ("robots", "list the robots that can be loaded, or show one"),
    "mass": ("mass", "effective mass of a robot at one pose, frame and direction"),
    "paper": ("paper", "Table 1, Figs. 5 and 6 and the equations of the paper, checked"),
    "study": ("study", "write a first study file from a folder of recordings, or check one"),
}
"""Name -> (module under spacerobot.cli with `configure(parser)` and `run(args) -> int | None`, its help)."""

_NEGATIVE = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?([, ].*)?$|^-inf$")


def build_parser(name: str | None = None) -> argparse.ArgumentParser:
    """The parser; only the subcommand `name` has its arguments filled in."""
    parser = argparse.ArgumentParser(
        prog="spacerobot",
        description="Contact between a space robot's compliant wrist and a free-flying body, "
        "and why the recording does not look like the simulation.",
        epilog="`spacerobot COMMAND --help` shows arguments and examples.",
    )
    parser.add_argument("--version", action="version", version=f"spacerobot {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for command, (module, text) in COMMANDS.items():
        sub = commands.add_parser(
            command, help=text, description=text, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        sub._negative_number_matcher = _NEGATIVE  # argparse itself takes -1e-3 for an option
        if command == name:
            importlib.import_module(f"spacerobot.cli.{module}").configure(sub)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0 an answer, 2 bad input, 130 interrupted."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    name = next((a for a in arguments if not a.startswith("-")), None)
    parser = build_parser(name)
    args = parser.parse_args(arguments)
    module = importlib.import_module(f"spacerobot.cli.{COMMANDS[args.command][0]}")
    try:
        return int(module.run(args) or 0)
    except SpacerobotError as error:
        print(f"spacerobot {args.command}: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print(f"spacerobot {args.command}: interrupted", file=sys.stderr)
        return 130


def entry() -> None:
    """Console entry point."""
    sys.exit(main())
