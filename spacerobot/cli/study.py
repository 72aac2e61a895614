"""`spacerobot study`: write a first study file, or check one."""

from __future__ import annotations

import argparse
import itertools
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spacerobot.recordings.drafting.rigs import RIGS, UNKNOWN
from spacerobot.support.jsonio import dumps

if TYPE_CHECKING:
    from spacerobot.recordings.draft import Draft
    from spacerobot.recordings.drafting.groups import Group

_MOST_SHOWN = 60
"""Channels that the table of a check has room for."""

_EPILOG = """examples:
  spacerobot study example my_rig           raw recordings of a wrist rig, to try the next two commands on
  spacerobot study new my_recordings        writes my_recordings/study.toml, to be completed by you
  spacerobot study new joint_logs --robot panda
  spacerobot study new my_recordings --rig body --files 'run_*.csv'    no names in the files: say what they are of
  spacerobot study check my_recordings      trials, channels, rates, gaps and what is odd
  spacerobot study check guide-friction     the bundled study
  spacerobot study check emps/study.toml --data ~/emps --json
  spacerobot study schema > study.schema.json             keys, what they may hold and their units, for your editor
  spacerobot study table --runs runs --out table.md       verdicts of all bundled real studies
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.epilog = _EPILOG
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    new = actions.add_parser("new", help="write a first study.toml from a folder of recordings")
    new.add_argument("folder", type=Path, metavar="FOLDER", help="folder that holds the recordings")
    new.add_argument("--out", type=Path, metavar="FILE", help="where to write it (default: FOLDER/study.toml)")
    new.add_argument("--robot", metavar="NAME", help="the arm that was logged (default: the URDF among the files)")
    new.add_argument(
        "--rig", choices=list(RIGS), default="", help="kind of rig (default: by what the columns are called)"
    )
    new.add_argument("--files", default="*", metavar="PATTERN", help="read only files of such names, as 'run_*'")
    new.add_argument("--overwrite", action="store_true", help="replace a study that is there")
    new.add_argument("--json", action="store_true", help="one JSON object on stdout")
    check = actions.add_parser("check", help="read a study and all its files, and say what they hold")
    check.add_argument("study", metavar="STUDY", help="a folder, its study.toml, or the name of a bundled study")
    check.add_argument("--data", type=Path, metavar="DIR", help="folder that the study's files are relative to")
    check.add_argument("--json", action="store_true", help="one JSON object on stdout")
    example = actions.add_parser("example", help="copy a folder of raw recordings, to try the way to a study on")
    example.add_argument("folder", type=Path, metavar="FOLDER", help="where to: a folder that is new or empty")
    actions.add_parser("schema", help="print the JSON Schema of study.toml, for an editor or a program that writes one")
    table = actions.add_parser("table", help="diagnose several studies and write their verdicts as one page")
    table.add_argument("studies", nargs="*", metavar="STUDY", help="studies (default: the bundled real ones)")
    table.add_argument("--out", type=Path, metavar="FILE", help="Markdown file to write (default: standard output)")
    table.add_argument("--runs", type=Path, metavar="DIR", help="folder that keeps verdicts; finished ones are reused")
    table.add_argument("--overwrite", action="store_true", help="replace FILE")
    table.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Write or check a study, or say what one may hold; 2 where a file of it cannot be read."""
    if args.action == "example":
        from spacerobot.recordings.example import example_recordings

        path = example_recordings(args.folder)
        print(f"{path}: {len(list(path.iterdir()))} files, as a lab's logger left them")
        print(f"Next: `spacerobot study new {path}`.")
        return 0
    if args.action == "schema":
        from spacerobot.recordings.study_schema import study_schema

        print(dumps(study_schema()))
        return 0
    if args.action == "table":
        from spacerobot.cli.study_table import run as table

        return table(args)
    return _new(args) if args.action == "new" else _check(args)


def _new(args: argparse.Namespace) -> int:
    from spacerobot.recordings.draft import draft
    from spacerobot.recordings.lacking import lacks
    from spacerobot.recordings.new_study import study_path, written
    from spacerobot.support.progress import Progress

    path = study_path(args.folder, args.out, args.overwrite)
    with Progress("reading the files, and telling what they are"):
        made = draft(args.folder, args.robot, rig=args.rig, pattern=args.files)
        study = written(made, args.folder, path)
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
    print(f"{path}: {RIGS.get(made.kind, UNKNOWN)}; {len(names)} trial{'s' if len(names) > 1 else ''}")
    for name, lines in made.lines.items():
        left = f"; left out: {', '.join(made.left[name][:6])}" if made.left[name] else ""
        print(f"  {name}: {', '.join(line.channel for line in lines[:8])}{', ...' if len(lines) > 8 else ''}{left}")
    for remark in made.remarks[:5]:
        print(f"  not read: {remark}")
    if len(made.remarks) > 5:
        print(f"  and {len(made.remarks) - 5} more, listed at the end of the file")
    if advice := _advice(made):
        print(advice)
    print(f"Next: {lacks(study)}.\nThen run `spacerobot study check {args.folder}`.")
    if path.resolve().parent != args.folder.resolve():
        print(f"The recordings are elsewhere: give --data {args.folder} with the study.")
    return 0


def _advice(made: Draft) -> str:
    """What to do where columns could not be told: the ways to say what they are, the shortest first."""
    silent = [name for name, lines in made.lines.items() if all(x.channel.startswith("aux.") for x in lines)]
    if not silent:
        return ""
    group = made.groups[silent[0]]
    said = []
    if len(made.groups) > 1:
        said.append(f"files of one rig alone: --files '{_pattern(group)}'")
    if not made.kind:
        said.append(f"the rig, whose beliefs the draft then has: --rig {', '.join(RIGS)}")
    number = made.lines[silent[0]][0].reading.index
    said.append(
        "the columns, in the study, where each line says what it does and could be;\n"
        f'    or in columns.csv beside the files, a line for each that counts, as "{number},target x [mm]"\n'
        "    (then time [s], wrist x [mm], force [N], x [m], y [m], rotation [deg], q1 [rad], tau1 [Nm])"
    )
    return "What no name tells can be said:\n" + "\n".join(f"  {line}" for line in said)


def _pattern(group: Group) -> str:
    """A pattern that the names of a group's files share."""
    names = [Path(f.relative).name for f in group.files]
    alike = itertools.takewhile(lambda letters: len(set(letters)) == 1, zip(*names, strict=False))
    start = "".join(letters[0] for letters in alike)
    return names[0] if len(set(names)) == 1 else f"{start}*"


def _check(args: argparse.Namespace) -> int:
    from spacerobot.diagnosis.study_check import check_study
    from spacerobot.recordings.study import load_study
    from spacerobot.support.progress import Progress

    study = load_study(args.study, args.data)
    with Progress("reading, and trying the model as believed", len(study.trials), unit="trial") as progress:
        report = check_study(study, report=progress.advance)
    print(dumps(report) if args.json else _text(report))
    if args.json and report["errors"]:
        print("\n".join(report["errors"]), file=sys.stderr)
    return 2 if report["errors"] else 0


def _text(report: dict[str, Any]) -> str:
    lines = [report["title"], f"  study {report['study']}", f"  data  {report['data']}", ""]
    spans = report["ranges"]
    if spans:
        lines += [f"{'channel':28}  {'lowest':>10} {'highest':>10} unit   {'rate, Hz':>9}  {'sigma':>8}  the baseline"]
    for r in spans[:_MOST_SHOWN]:
        low, high = r["rate"]
        rate = f"{low:.4g}" if high - low <= 0.01 * high else f"{low:.3g}-{high:.3g}"
        sigma = f"{r['sigma']:.2g}{'' if r['sigma_stated'] else '*'}" if math.isfinite(r["sigma"]) else "-"
        missing = f"  {r['missing']:.1%} missing" if r["missing"] > 0 else ""
        numbers = f"{r['low']:10.4g} {r['high']:10.4g} {r['unit']:5}  {rate:>9}  {sigma:>8}"
        lines.append(f"{r['name']:28}  {numbers}  {r['belief']}{missing}".rstrip())
    if len(spans) > _MOST_SHOWN:
        lines.append(f"and {len(spans) - _MOST_SHOWN} channels more")
    if any(not r["sigma_stated"] for r in spans):
        lines.append("* not stated: estimated from the readings")
    lines.append("")
    for trial in report["trials"]:
        sizes: dict[str, str] = {}
        for c in trial["channels"]:
            sizes.setdefault(
                c["stream"], f"{c['stream']} {c['samples']} samples {c['start_s']:.4g} to {c['end_s']:.4g} s"
            )
        lines.append(f"trial {trial['id']}  ({trial['condition']})  {'; '.join(sizes.values())}".rstrip())
        lines += [f"  note: {note}" for note in trial["notes"]]
    counts = [(len(report["trials"]), "trial"), (len(report["conditions"]), "condition")]
    lines += ["", " in ".join(f"{n} {noun}{'s' * (n != 1)}" for n, noun in counts)]
    lines += [f"warning: {w}" for w in report["warnings"]]
    lines += [f"error: {e}" for e in report["errors"]]
    if report["draft"]:
        lines.append(f"draft: {report['draft']}")
    return "\n".join(lines)
