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
    """

    title: str
    command: str
    arguments: str
    folder: str
    page: str | None = None


STEPS = (
    Step("A floating target hits the compliant wrist of a PA10-like arm", "simulate", HIT, "collision"),
    Step("The same model over recordings of such hits", "overlay", STUDY, "overlay", "overlay.html"),
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
    for number, step in enumerate(STEPS, start=1):
        arguments = [*shlex.split(step.arguments), "--out", str(top / step.folder)]
        if not args.json:
            print(f"{number}. {step.title}\n$ spacerobot {shlex.join([step.command, *arguments])}\n", flush=True)
        answers[step.folder] = _typed(
            step.command, [*arguments, *(["--overwrite"] if args.overwrite else [])], args.json
        )
        if step.page is not None:
            page = str((top / step.folder / step.page).resolve())
        if not args.json:
            print()
    if not folder.finished:
        folder.write("demo.png", _picture(top))
        folder.finish()
    picture = folder.folder / "demo.png"
    if args.json:
        print(dumps({"steps": answers, "picture": str(picture), "page": page}))
    else:
        print(f"picture: {picture}\nOpen this page in a browser: {page}")
    return 0


def _typed(command: str, arguments: Sequence[str], as_json: bool) -> Any:
    """What the command answers: printed, or as the object that its --json prints."""
    from spacerobot.cli.main import COMMANDS, build_parser

    module = importlib.import_module(f"spacerobot.cli.{COMMANDS[command][0]}")
    said = io.StringIO()
    parsed = build_parser(command).parse_args([command, *arguments, *(["--json"] if as_json else [])])
    with contextlib.redirect_stdout(said if as_json else sys.stdout):
        module.run(parsed)
    return json.loads(said.getvalue()) if as_json else None


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
