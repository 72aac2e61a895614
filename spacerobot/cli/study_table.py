"""The work of `spacerobot study table`."""

from __future__ import annotations

import argparse
import sys

from spacerobot.support.errors import InputError
from spacerobot.support.files import may_write, write_text
from spacerobot.support.progress import Progress
from spacerobot.view.table.of_studies import REAL, by_hand, named_or_real, study_table


def run(args: argparse.Namespace) -> int:
    """Diagnose and write; studies whose recordings are absent are named, and an error only where all are."""
    if args.out is not None:
        may_write(args.out, "a file", args.overwrite)
    names = named_or_real(args.studies)
    read = 0
    with Progress("diagnosing", len(names), unit="study", verbose=args.verbose) as bar:

        def done(name: str, fault: InputError | None) -> None:
            nonlocal read
            read += fault is None
            if fault is not None:
                print(f"{name}: {fault}", file=sys.stderr)
            bar.advance(note=name.removeprefix(REAL))

        text = study_table(args.studies, runs=args.runs, report=done)
    if args.out is None:
        print(text)
    else:
        write_text(args.out, text + by_hand(args.out))
        print(f"{args.out}: {read} studies")
    return 0
