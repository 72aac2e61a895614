"""`spacerobot demo`: what the project does, in commands that can be typed again."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot demo
  spacerobot demo --out demo-out --overwrite

A PA10-like arm with a compliant wrist is hit by a floating target; predicted restitution and contact time stand beside
the simulated ones; a bundled study is simulated and laid over its recordings; and what its model lacks is named. Takes
about two minutes."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("--out", metavar="DIR", default="demo-out", help="folder for the results; default: demo-out")
    parser.add_argument("--json", action="store_true", help="print one JSON object with the answer of every step")
    parser.add_argument("--overwrite", action="store_true", help="replace the demo that is in DIR")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.demo_run import run as work

    return work(args)
