"""`spacerobot sweep`: Monte-Carlo capture campaigns, written as Parquet."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot sweep sweep.toml --out captures
  spacerobot sweep sweep.toml --out captures --jobs 8
  spacerobot sweep sweep.toml --out /shared/captures --dask tcp://10.0.0.1:8786 -v

Needs the extra `scale` (pip install "spacerobot[scale]"). Poses, grid, scatter and repeats are in SWEEP.toml. What a
killed or interrupted sweep has written stays; the same command goes on from there. Results do not depend on how many
workers there were. With --dask the workers write to DIR themselves, so all must see it."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("sweep", metavar="SWEEP.toml", help="what is varied, and how")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder for the parts and the summary")
    parser.add_argument("--dask", metavar="ADDRESS", help="run on this Dask scheduler's workers")
    parser.add_argument("--jobs", metavar="N", help="processes of this machine; default: 1")
    parser.add_argument("--seed", metavar="N", help="of the scatter, instead of the file's")
    parser.add_argument("--json", action="store_true", help="print one JSON object, that of sweep.json")
    parser.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")
    parser.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.sweep_run import run as work

    return work(args)
