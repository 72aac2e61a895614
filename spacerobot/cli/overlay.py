"""`spacerobot overlay`: a study's trials simulated and laid over their recordings."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot overlay guide-friction --out overlay-out
  spacerobot overlay my_rig/study.toml --data ~/recordings --trials 01 02 --json
  SPACEROBOT_DATA=~/recordings spacerobot overlay real/emps --out emps-overlay
  spacerobot overlay my_axis --model diagnosis/model.toml --out found-overlay       what a diagnosis found, run again

Every trial starts from its own initial state; the baseline is simulated as it is believed, or as found with
--model. Writes overlay.html (one
file, opens offline), overlay.json and a PNG of each trial. Without --out only the residuals are printed."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("study", metavar="STUDY", help="a folder, its study.toml, or the name of a bundled study")
    parser.add_argument("--trials", nargs="+", metavar="ID", help="only these; separated by spaces or commas")
    parser.add_argument("--model", metavar="FILE", help="model.toml of a diagnosis, instead of the baseline")
    parser.add_argument("--dask", metavar="ADDRESS", help="simulate on a Dask scheduler's workers, with the same files")
    parser.add_argument("--data", metavar="DIR", help="folder that the study's files are relative to")
    parser.add_argument("--json", action="store_true", help="print one JSON object, that of overlay.json")
    parser.add_argument("--out", metavar="DIR", help="folder for page, figures and data")
    parser.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")
    parser.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.overlay_run import run as work

    return work(args)
