"""`spacerobot prove`: hide physics in campaigns of another engine, diagnose them blind, and score."""

from __future__ import annotations

import argparse
from typing import Any

_EPILOG = """\
examples:
  spacerobot prove --quick --out proof-quick
  spacerobot prove --out proof --jobs 4 --docs docs
  spacerobot prove --out proof --minutes 60 --docs docs
  spacerobot prove --out proof --resume docs/proof_records.jsonl --docs docs
  spacerobot prove --out proof --kinds nothing_missing outsider --seed 7 --json
  spacerobot prove --out whole --scenes whole_machine --minutes 60
  spacerobot prove --out again --again docs/proof_records.jsonl --jobs 2
  spacerobot prove --list

Needs the extra `proof` (pip install "spacerobot[proof]"). Seeds are drawn when a batch begins, unless --seed is given,
and printed. Every scored campaign is kept at once: a batch that was interrupted goes on where it stopped, as long as
the code is the same; --resume takes it up on another machine. Writes proof.md with its figures, proof.json and
records.jsonl, the record of every campaign."""


class _List(argparse.Action):
    """Answers and ends, as --help does."""

    def __init__(self, option_strings: list[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, dest, nargs=0, default=argparse.SUPPRESS, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        from spacerobot.proof.proved import as_text

        print(as_text())
        parser.exit()


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("--out", metavar="DIR", required=True, help="folder for page, figures and records")
    parser.add_argument("--list", action=_List, help="which effects the proof hides, and which are not yet proved")
    parser.add_argument("--quick", action="store_true", help="a handful of campaigns, a few minutes")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="only these kinds of concealment")
    parser.add_argument(
        "--scenes", nargs="+", metavar="SCENE", help="only these: rig, spinning, chaser, servo_arm, ..."
    )
    parser.add_argument("--share", metavar="X", default="1", help="this share of each kind's campaigns; default: 1")
    parser.add_argument("--minutes", metavar="M", help="begin no campaign after so long; the next run goes on")
    parser.add_argument("--seed", metavar="N", help="of the batch; drawn from the operating system if absent")
    parser.add_argument("--resume", metavar="FILE", help="go on with the batch whose records these are")
    parser.add_argument(
        "--again", metavar="FILE", help="play the campaigns of these records that went wrong again, with today's code"
    )
    parser.add_argument("--jobs", metavar="N", help="campaigns at a time; default: 1")
    parser.add_argument("--dask", metavar="ADDRESS", help="play them on this Dask scheduler's workers")
    parser.add_argument("--no-rivals", action="store_true", help="leave mujoco.sysid, PySINDy and the bare refit out")
    parser.add_argument("--docs", metavar="DIR", help="write proof.md, its figures and proof_records.jsonl there too")
    parser.add_argument(
        "--page", metavar="NAME", help="call them NAME.md and so on; default: proof; with --again proof_again"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object, that of proof.json")
    parser.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")
    parser.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.prove_run import run as played

    return played(args)
