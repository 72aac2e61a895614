"""`spacerobot diagnose`: which physics was left out of a study's baseline."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot diagnose guide-friction --out diagnosis
  spacerobot diagnose my_rig/study.toml --data ~/recordings --out diagnosis --jobs 2
  spacerobot diagnose my_rig --effects my_effect.py --json     (--effects runs the file's code)

Writes verdict.json, report.html (one file, opens offline), scene.toml (of machines without a wrist: model.toml, for
overlay --model) and plots into DIR. The verdict is one of named, learned, ambiguous, unknown, nothing_missing,
wrong_parameter, not_trusted. A finished run in DIR is reused."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("study", metavar="STUDY", help="a folder, its study.toml, or the name of a bundled study")
    parser.add_argument("--out", metavar="DIR", help="folder for verdict, report, scene and plots")
    parser.add_argument("--data", metavar="DIR", help="folder that the study's files are relative to")
    parser.add_argument("--json", action="store_true", help="print verdict.json on standard output")
    parser.add_argument("--seed", type=int, default=0, help="kept in the verdict; no answer hangs on it (default 0)")
    parser.add_argument("--jobs", type=int, default=None, help="processes (default: all cores)")
    parser.add_argument(
        "--dask", metavar="ADDRESS", help="fit a wrist rig on this Dask scheduler's workers, which see the same files"
    )
    parser.add_argument(
        "--effects", action="append", default=[], metavar="FILE.py", help="further effects; the file's code is run"
    )
    parser.add_argument(
        "--without", action="append", default=[], metavar="EFFECT", help="leave an effect out of the catalogue"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")
    parser.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.diagnose_run import run as work

    return work(args)
