"""`spacerobot study`: write a first study file, or check one."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from spacerobot.support.errors import InputError
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps

_EPILOG = """examples:
  spacerobot study new my_recordings        writes my_recordings/study.toml, to be completed by you
  spacerobot study check my_recordings      trials, channels, rates, gaps and what is odd
  spacerobot study check guide-friction     the bundled study
  spacerobot study check emps/study.toml --data ~/emps --json
  spacerobot study table --runs runs --out table.md       verdicts of all bundled real studies
"""


_KINDS = {
    "wrist": "a wrist rig",
    "arm": "an arm with joint logs",
    "platform": "a floating platform with an arm",
    "body": "a free body",
    "axis": "one driven axis",
    "": "a rig of which no column was recognised",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.epilog = _EPILOG
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    new = actions.add_parser("new", help="write a first study.toml from a folder of recordings")
    new.add_argument("folder", type=Path, metavar="FOLDER", help="folder that holds the recordings")
    new.add_argument("--out", type=Path, metavar="FILE", help="where to write it (default: FOLDER/study.toml)")
    new.add_argument("--overwrite", action="store_true", help="replace a study that is there")
    new.add_argument("--json", action="store_true", help="one JSON object on stdout")
    check = actions.add_parser("check", help="read a study and all its files, and say what they hold")
    check.add_argument("study", metavar="STUDY", help="a folder, its study.toml, or the name of a bundled study")
    check.add_argument("--data", type=Path, metavar="DIR", help="folder that the study's files are relative to")
    check.add_argument("--json", action="store_true", help="one JSON object on stdout")
    table = actions.add_parser("table", help="diagnose several studies and write their verdicts as one page")
    table.add_argument("studies", nargs="*", metavar="STUDY", help="studies (default: the bundled real ones)")
    table.add_argument("--out", type=Path, metavar="FILE", help="Markdown file to write (default: standard output)")
    table.add_argument("--runs", type=Path, metavar="DIR", help="folder that keeps verdicts; finished ones are reused")
    table.add_argument("--overwrite", action="store_true", help="replace FILE")
    table.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Write or check a study; 2 where a file of it cannot be read."""
    if args.action == "table":
        from spacerobot.cli.study_table import run as table

        return table(args)
    return _new(args) if args.action == "new" else _check(args)


def _new(args: argparse.Namespace) -> int:
    from spacerobot.recordings.draft import draft
    from spacerobot.recordings.lacking import lacks
    from spacerobot.recordings.study import load_study

    path: Path = args.out or args.folder / "study.toml"
    if path.is_dir():
        path = path / "study.toml"
    if path.exists() and not args.overwrite:
        raise InputError("a study is there already", given=str(path), valid="another --out, or --overwrite")
    made = draft(args.folder)
    try:
        for name, content in made.files.items():
            if not (path.parent / name).exists():
                write_text(path.parent / name, content)
        write_text(path, made.text())
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", where=str(path)) from None
    study = load_study(path, data=args.folder)
    names = [t.id for t in study.trials]
    answer: dict[str, Any] = {
        "study": str(path),
        "kind": made.kind or None,
        "trials": names,
        "streams": list(study.streams),
    }
    answer |= {"channels": study.channels(), "lacks": lacks(study), "not_read": made.remarks}
    if args.json:
        print(dumps(answer))
        return 0
    print(f"{path}: {_KINDS[made.kind]}; {len(names)} trial{'s' if len(names) > 1 else ''}")
    for name, lines in made.lines.items():
        print(f"  {name}: {', '.join(line.channel for line in lines[:8])}{', ...' if len(lines) > 8 else ''}")
    for remark in made.remarks[:5]:
        print(f"  not read: {remark}")
    if len(made.remarks) > 5:
        print(f"  and {len(made.remarks) - 5} more, listed at the end of the file")
    print(f"Next: {lacks(study)}.\nThen run `spacerobot study check {args.folder}`.")
    if path.resolve().parent != args.folder.resolve():
        print(f"The recordings are elsewhere: give --data {args.folder} with the study.")
    return 0


def _check(args: argparse.Namespace) -> int:
    from spacerobot.model.library import load
    from spacerobot.recordings.check import check_study
    from spacerobot.recordings.study import load_study

    study = load_study(args.study, args.data)
    report = check_study(study)
    source = study.robot_source
    if source is not None:
        try:
            load(source)
        except InputError as error:
            report["errors"].append(f"robot: {error}")
    print(dumps(report) if args.json else _text(report))
    if args.json and report["errors"]:
        print("\n".join(report["errors"]), file=sys.stderr)
    return 2 if report["errors"] else 0


def _text(report: dict[str, Any]) -> str:
    lines = [report["title"], f"  study {report['study']}", f"  data  {report['data']}", ""]
    for trial in report["trials"]:
        lines.append(f"trial {trial['id']}  ({trial['condition']})")
        for c in trial["channels"][:40]:
            sigma = (
                "" if c["sigma"] is None else f"  sigma {c['sigma']:.2g} {'' if c['sigma_stated'] else '(estimated)'}"
            )
            missing = f"  {c['missing']} missing" if c["missing"] else ""
            span = f"{c['samples']:7d} samples {c['start_s']:9.3f} to {c['end_s']:.3f} s"
            lines.append(f"  {c['name']:32s}{span}  {c['rate_hz']:8.4g} Hz  {c['unit']:5s}{sigma}{missing}".rstrip())
        if len(trial["channels"]) > 40:
            lines.append(f"  and {len(trial['channels']) - 40} channels more")
        lines += [f"  note: {note}" for note in trial["notes"]]
    lines += ["", f"{len(report['trials'])} trials in {len(report['conditions'])} conditions"]
    lines += [f"warning: {w}" for w in report["warnings"]]
    lines += [f"error: {e}" for e in report["errors"]]
    if report["draft"]:
        lines.append(f"draft: {report['draft']}")
    return "\n".join(lines)
