"""What `spacerobot demo` does: a list of commands, each run as if it had been typed."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import json
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.cli.beside import beside
from spacerobot.support.jsonio import dumps
from spacerobot.support.runs import RunFolder, combined_hash

STUDY = "guide-friction"
TRIAL = "03"

HIT = (
    "pa10_wrist --approach -1 0 0 --wrist-stiffness 530 --wrist-damping 1.4 --equivalent-damping 9.69 "
    "--contact-damping 40 --target-mass 9 --speed 0.07 --gap 0.02"
)


@dataclass(frozen=True)
class Step:
    """One command of the demo.

    Attributes:
        title: what it shows, one line.
        command: name of the command.
        arguments: what follows the name.
        folder: where its results go, inside the demo's.
        page: the file to look at afterwards, or None.
        beside: begin it with the first one, in a process of its own.
    """

    title: str
    command: str
    arguments: str
    folder: str
    page: str | None = None
    beside: bool = False


STEPS = (
    Step("A floating target hits the compliant wrist of a PA10-like arm", "simulate", HIT, "collision"),
    Step("The same model over recordings of such hits", "overlay", STUDY, "overlay", "overlay.html", True),
    Step("What the model lacks, named and fitted", "diagnose", STUDY, "diagnosis", "report.html"),
)


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    key = combined_hash("demo", [[step.command, step.arguments, step.folder] for step in STEPS])
    with RunFolder(args.out, "demo", key, overwrite=args.overwrite) as folder:
        return _steps(args, folder)


def _steps(args: argparse.Namespace, folder: RunFolder) -> int:
    top = Path(args.out)
    answers: dict[str, Any] = {}
    page = ""
    options = [*(["--overwrite"] if args.overwrite else []), *(["--json"] if args.json else [])]
    with contextlib.ExitStack() as under_way:
        commands = [[s.command, *shlex.split(s.arguments), "--out", str(top / s.folder)] for s in STEPS]
        begun = {s: under_way.enter_context(beside([*c, *options])) for s, c in zip(STEPS, commands) if s.beside}
        for number, (step, command) in enumerate(zip(STEPS, commands), start=1):
            if not args.json:
                print(f"{number}. {step.title}\n$ spacerobot {shlex.join(command)}\n", flush=True)
            answer = begun[step].answer() if step in begun else _typed([*command, *options], args.json)
            if args.json:
                answers[step.folder] = json.loads(answer)
            else:
                print(answer if step in begun else "")
            if step.page is not None:
                page = str((top / step.folder / step.page).resolve())
    if not folder.finished:
        folder.write("demo.png", _picture(top))
        folder.finish()
    picture = folder.folder / "demo.png"
    if args.json:
        print(dumps({"steps": answers, "picture": str(picture), "page": page}))
    else:
        print(f"picture: {picture}\nOpen this page in a browser: {page}")
    return 0


def _typed(command: Sequence[str], as_json: bool) -> str:
    """What the command prints: at once, or, an object, when it is whole."""
    from spacerobot.cli.main import COMMANDS, build_parser

    module = importlib.import_module(f"spacerobot.cli.{COMMANDS[command[0]][0]}")
    said = io.StringIO()
    with contextlib.redirect_stdout(said if as_json else sys.stdout):
        module.run(build_parser(command[0]).parse_args(command))
    return said.getvalue()


def _picture(top: Path) -> bytes:
    """All of it in one picture, from what the steps have written."""
    from spacerobot.diagnosis.forward.choose import forward_model
    from spacerobot.recordings.study import load_study
    from spacerobot.simulation.scene_file import read_scene
    from spacerobot.simulation.trajectory import Trajectory
    from spacerobot.view.demo.picture import picture
    from spacerobot.view.plotting import png

    collision = top / "collision"
    study = load_study(STUDY)
    figure = picture(
        read_scene(collision / "scene.toml"),
        Trajectory.load(collision / "trajectory.npz"),
        json.loads((collision / "simulate.json").read_text(encoding="utf-8")),
        forward_model(study).simulate(study.trial(TRIAL)),
        f"over a recording ({STUDY}, trial {TRIAL})",
    )
    return png(figure)
