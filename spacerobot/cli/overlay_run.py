"""What `spacerobot overlay` does once its arguments are read."""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot import __version__
from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay
from spacerobot.diagnosis.forward.elsewhere import model_of, overlays
from spacerobot.diagnosis.forward.residuals import by_channel, residuals
from spacerobot.recordings.lacking import lacks
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor
from spacerobot.support.jsonio import dumps, plain
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder, combined_hash

DRAWN = 30
"""Trials drawn at most: those with the largest residuals."""


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
    model = model_of(study, found)
    by_id: dict[str, TrialOverlay] = {}
    with contextlib.ExitStack() as stack:
        progress = stack.enter_context(Progress("simulating", len(study.trials), unit="trial", verbose=verbose))
        if dask is None:
            coming: Iterator[TrialOverlay] = (model.simulate(trial) for trial in study.trials)
        else:
            coming = overlays(study, found, stack.enter_context(executor(dask=dask)))
        for done in coming:
            by_id[done.id] = done
            progress.advance()
    trials = [by_id[t.id] for t in study.trials]
    answer = plain(as_json(study, model, trials))
    if folder is not None:
        _write(study, model, trials, folder, verbose)
        folder.write("overlay.json", dumps(answer) + "\n")
        folder.finish()
    assert isinstance(answer, dict)
    return answer


def as_json(study: Study, model: ForwardModel, trials: list[TrialOverlay]) -> dict[str, Any]:
    """The answer; SI."""
    return {
        "format": 1,
        "spacerobot": __version__,
        "input_hash": study.input_hash,
        "study": str(study.path),
        "title": study.title,
        "model": model.kind,
        "assumptions": list(model.assumptions),
        "values": {v.name: {"value": v.value, "unit": v.unit, "source": v.source} for v in model.values},
        "channels": {name: found.as_json() for name, found in by_channel(trials).items()},
        "not_predicted": not_predicted(study, trials),
        "trials": [
            {
                "id": t.id,
                "condition": t.condition,
                "touches_s": list(t.touches),
                "channels": {c.channel: residuals([c]).as_json() for c in t.channels if c.time.size},
            }
            for t in trials
        ],
    }


def not_predicted(study: Study, trials: list[TrialOverlay]) -> list[str]:
    """Recorded channels that no simulation shows, drives and notes apart."""
    shown = {c.channel for t in trials for c in t.channels}
    recorded = {s.name for t in study.trials for s in study.recording(t).outputs()}
    return sorted(n for n in recorded - shown if not n.startswith("aux.") and not n.endswith(".reference"))


def _write(study: Study, model: ForwardModel, trials: list[TrialOverlay], folder: RunFolder, verbose: bool) -> None:
    from spacerobot.view.overlay.figures import glance, trial_figure
    from spacerobot.view.overlay.page import page
    from spacerobot.view.plotting import png

    def size(trial: TrialOverlay) -> float:
        return float(np.nan_to_num([residuals([c]).chi2_per_sample for c in trial.channels if c.time.size]).sum())

    worst = {t.id for t in sorted(trials, key=size, reverse=True)[:DRAWN]}
    figures = {}
    with Progress("drawing", len(worst), unit="trial", verbose=verbose) as progress:
        for trial in trials:
            if trial.id in worst and any(c.time.size for c in trial.channels):
                figures[trial.id] = trial_figure(trial)
                folder.write(f"{_file_name(trial.id)}.png", png(figures[trial.id]))
                progress.advance()
    left = not_predicted(study, trials)
    text = page(study, model, trials, by_channel(trials), figures, glance(trials), left)
    folder.write("overlay.html", text)


def _file_name(trial: str) -> str:
    return "trial_" + re.sub(r"[^\w.+=-]+", "_", trial)


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
