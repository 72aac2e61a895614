"""The `spacerobot` command: a table of subcommands, each loaded only when it is called."""

from __future__ import annotations

import argparse
import contextlib
import errno
import importlib
import os
import sys
from collections.abc import Sequence
from typing import TextIO, cast

from spacerobot import __version__
from spacerobot.cli.arguments import Parser
from spacerobot.cli.output import Fitted, open_streams, width
from spacerobot.support.errors import NotFoundError, SpacerobotError
from spacerobot.support.workers import THREAD_VARIABLES

COMMANDS: dict[str, tuple[str, str]] = {
    "demo": ("demo", "a collision, a simulation over recordings, and what the difference is made of"),
    "robots": ("robots", "list the robots that can be loaded, or show one"),
    "mass": ("mass", "effective mass of a robot at one pose, frame and direction"),
    "simulate": ("simulate", "a wrist meets a free-flying body: predicted beside simulated"),
    "paper": ("paper", "Table 1, Figs. 5 and 6 and the equations of the paper, checked"),
    "overlay": ("overlay", "a study's trials simulated and laid over their recordings"),
    "diagnose": ("diagnose", "which physics was left out of a study's baseline, named, fitted and shown"),
    "compare": ("compare", "two diagnoses or overlays side by side, as one page"),
    "effects": ("effects", "the catalogue: which physics a model may lack, with parameters and places"),
    "view": ("view", "a robot, a capture or a recorded trial as a scene in one file"),
    "prove": ("prove", "hide physics in another engine's recordings, diagnose them blind, score"),
    "sweep": ("sweep", "captures by the million: poses, speeds, masses, springs and scatter, as Parquet"),
    "study": ("study", "write a first study file from a folder of recordings, or check one"),
}
"""Name -> (module under spacerobot.cli with `configure(parser)` and `run(args) -> int | None`, its help).

The module loads nothing heavy before `run`, so that help is there at once."""

_PATH_ERRORS = {errno.ENOENT, errno.EACCES, errno.EPERM, errno.EISDIR, errno.ENOTDIR, errno.ENAMETOOLONG, errno.ELOOP}
"""What a wrong path leads to; any other trouble with a file is the machine's (disk full, for instance)."""

DEBUG = "SPACEROBOT_DEBUG"
"""Environment variable; when it is set, an error that nobody foresaw shows its traceback."""

_EPILOG = """\
examples:
  spacerobot mass pa10_wrist --q 0 45 0 90 0 -45 0 --deg --direction 1 0 0
  spacerobot COMMAND --help        arguments and examples of a command
"""


def build_parser(name: str | None = None) -> Parser:
    """The parser; only the subcommand `name` has its arguments filled in."""
    parser = Parser(
        prog="spacerobot",
        description="Contact between a space robot's compliant wrist and a free-flying body,\n"
        "and why the recording does not look like the simulation.",
        epilog=_EPILOG,
    )
    parser.add_argument("--version", action="version", version=f"spacerobot {__version__}")
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND", required=True)
    for command, (module, text) in COMMANDS.items():
        sub = commands.add_parser(command, help=text, description=text)
        if command == name:
            importlib.import_module(f"spacerobot.cli.{module}").configure(sub)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0 an answer, 1 a failure, 2 bad input, 130 interrupted."""
    open_streams()
    arguments = list(sys.argv[1:] if argv is None else argv)
    columns = None if "--json" in arguments else width()
    stream = sys.stdout if columns is None else cast(TextIO, Fitted(sys.stdout, columns))
    with contextlib.redirect_stdout(stream):
        return _main(arguments)


def _main(arguments: list[str]) -> int:
    name = next((a for a in arguments if not a.startswith("-")), None)
    label = f"spacerobot {name}" if name in COMMANDS else "spacerobot"
    # before NumPy is loaded: the matrices are small, so that a second thread of linear algebra only waits, at the
    # price of a core that the workers need
    for variable in THREAD_VARIABLES:
        os.environ.setdefault(variable, "1")
    try:
        if name is not None and name not in COMMANDS:
            raise NotFoundError("command", name, COMMANDS)
        try:
            args = _parse(build_parser(name), arguments)
        except SystemExit:  # of --help and --version
            sys.stdout.flush()
            raise
        module = importlib.import_module(f"spacerobot.cli.{COMMANDS[args.command][0]}")
        code = int(module.run(args) or 0)
        sys.stdout.flush()
        return code
    except SpacerobotError as error:
        return _say(label, str(error), error.exit_code)
    except KeyboardInterrupt:
        return _say(label, "interrupted", 130)
    except BrokenPipeError:  # whoever reads our output has read enough
        _close_output()
        return 0
    except OSError as error:
        if error.errno is None:
            return _unforeseen(label, error)
        wrong_path = error.errno in _PATH_ERRORS
        place = f"{error.filename}: " if error.filename is not None else ""
        if error.filename is None and not wrong_path:
            _close_output()
        return _say(label, f"{place}{error.strerror or error}", 2 if wrong_path else 1)
    except MemoryError:
        return _say(label, "not enough memory for this input", 1)
    except Exception as error:
        return _unforeseen(label, error)


def _parse(parser: Parser, arguments: list[str]) -> argparse.Namespace:
    args, extra = parser.parse_known_args(arguments)
    if extra:
        commands = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
        commands.choices[args.command].refuse(extra)
    return args


def _say(label: str, text: str, code: int) -> int:
    with contextlib.suppress(OSError):
        print(f"{label}: {' '.join(text.splitlines())}", file=sys.stderr)
    return code


def _unforeseen(label: str, error: Exception) -> int:
    if os.environ.get(DEBUG):
        raise error
    text = f"internal error, please report it: {type(error).__name__}: {error} ({DEBUG}=1 shows where)"
    return _say(label, text, 1)


def _close_output() -> None:
    """Let Python's own flush at exit find nothing to complain about."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def entry() -> None:
    """Console entry point."""
    try:
        code = main()
    except KeyboardInterrupt:  # a second one, while the first was being answered
        code = 130
    sys.exit(code)
