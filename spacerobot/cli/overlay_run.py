"""What `spacerobot overlay` does once its arguments are read."""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from spacerobot.diagnosis.overlay import overlay
from spacerobot.recordings.lacking import lacks
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder, combined_hash


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    study = chosen(load_study(args.study, args.data), args.trials)
    if study.draft:  # the picture is how one finds a wrong sign or zero, so it is drawn
        print(f"warning: the study is still a draft; {lacks(study)}", file=sys.stderr)
    file = None if args.model is None else Path(args.model)
    if args.out is None:
        answer = work(study, None, args.verbose, file, args.dask)
    else:
        found = [] if file is None else [hashlib.sha256(_bytes(file)).hexdigest()]
        key = combined_hash("overlay", study.input_hash, [t.id for t in study.trials], *found)
        with RunFolder(args.out, "overlay", key, overwrite=args.overwrite) as folder:
            if not folder.finished:
                work(study, folder, args.verbose, file, args.dask)
            answer = json.loads((folder.folder / "overlay.json").read_text(encoding="utf-8"))
            answer["page"] = str(folder.folder / "overlay.html")
    print(dumps(answer) if args.json else summary(answer))
    return 0


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", given=str(path), where="--model") from None


def chosen(study: Study, wanted: list[str] | None) -> Study:
    """The study with the trials that are wanted, all if None.

    Raises:
        NotFoundError: no such trial.
        InputError: none is named.
    """
    if wanted is None:
        return study
    names = [name for text in wanted for name in re.split(r"[\s,]+", text) if name]
    if not names:
        raise InputError("no trial is named", valid=", ".join(t.id for t in study.trials[:24]), where="--trials")
    return replace(study, trials=tuple(study.trial(name) for name in dict.fromkeys(names)))


def work(
    study: Study, folder: RunFolder | None, verbose: bool, found: Path | None = None, dask: str | None = None
) -> dict[str, Any]:
    """Simulate, compare, and write page, figures and JSON if there is a folder; the answer as in overlay.json.

    The baseline is simulated, or what a diagnosis found, by its model.toml; here, or on a Dask scheduler's workers.
    """
    with contextlib.ExitStack() as stack:
        progress = stack.enter_context(Progress("simulating", len(study.trials), unit="trial", verbose=verbose))
        workers = None if dask is None else stack.enter_context(executor(dask=dask))
        made = overlay(study, model=found, workers=workers, report=progress.advance)
    answer = made.as_json()
    if folder is not None:
        from spacerobot.view.overlay.write import overlay_files

        for name, content in overlay_files(made, verbose=verbose).items():
            folder.write(name, content)
        folder.finish()
    return answer


def summary(answer: dict[str, Any]) -> str:
    """The answer as text."""
    lines = [
        f"{answer['title']}: {len(answer['trials'])} trials, {answer['model']}",
        *(f"  {text}" for text in answer["assumptions"]),
        "",
        f"{'channel':28} {'rms':>10} {'unit':6} {'in sigmas':>10} {'chi2/sample':>12} {'of the spread':>14}",
    ]
    for name, c in answer["channels"].items():
        share = "-" if c["share_of_spread"] is None else f"{100 * c['share_of_spread']:.3g} %"
        cells = f"{_cell(c['rms_sigmas']):>10} {_cell(c['chi2_per_sample']):>12} {share:>14}"
        lines.append(f"{name:28} {c['rms']:10.4g} {c['unit']:6} {cells}{'' if c['sigma_stated'] else ' *'}")
    if not all(c["sigma_stated"] for c in answer["channels"].values()):
        lines.append("* sigma is not stated: estimated from the recording's third differences")
    if answer["not_predicted"]:
        lines.append(f"recorded, but not predicted by this baseline: {', '.join(answer['not_predicted'])}")
    if "page" in answer:
        lines.append(f"page: {answer['page']}")
    return "\n".join(lines)


def _cell(value: float | None) -> str:
    return "-" if value is None else f"{float(value):.4g}"
