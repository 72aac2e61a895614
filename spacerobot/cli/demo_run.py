"""What `spacerobot demo` does: a list of commands, each run as if it had been typed."""

from __future__ import annotations

import argparse
import contextlib
import json
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.cli.beside import beside
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import Progress
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


LANES = (
    (Step("A floating target hits the compliant wrist of a PA10-like arm", "simulate", HIT, "collision"),),
    (
        Step("The same model over recordings of such hits", "overlay", STUDY, "overlay", "overlay.html"),
        Step("What the model lacks, named and fitted", "diagnose", STUDY, "diagnosis", "report.html"),
    ),
)
"""What is done beside each other: the whole robot and the rig alone each compile for a minute on a fresh machine."""

STEPS = tuple(step for lane in LANES for step in lane)


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
    commands = {s: [s.command, *shlex.split(s.arguments), "--out", str(top / s.folder)] for s in STEPS}
    with contextlib.ExitStack() as under_way:
        begun = [under_way.enter_context(beside(*([*commands[s], *options] for s in lane))) for lane in LANES]
        placed = ((lane, place, step) for lane, steps in zip(begun, LANES) for place, step in enumerate(steps))
        for number, (lane, place, step) in enumerate(placed, start=1):
            if not args.json:
                print(f"{number}. {step.title}\n$ spacerobot {shlex.join(commands[step])}\n", flush=True)
            if step is STEPS[-1] and not folder.finished:  # beside what is still under way
                with Progress("drawing"):
                    folder.write("demo.png", _picture(top))
            answer = lane.answer(place)
            if args.json:
                answers[step.folder] = json.loads(answer)
            else:
                print(answer)
            if step.page is not None:
                page = str((top / step.folder / step.page).resolve())
    if not folder.finished:
        folder.finish()
    picture = folder.folder / "demo.png"
    if args.json:
        print(dumps({"steps": answers, "picture": str(picture), "page": page}))
    else:
        print(f"picture: {picture}\nOpen this page in a browser: {page}")
    return 0


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
