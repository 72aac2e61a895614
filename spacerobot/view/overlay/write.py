"""An overlay as files: the page, its data, and a picture of each trial."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from spacerobot.diagnosis.forward.base import TrialOverlay
from spacerobot.diagnosis.forward.residuals import residuals
from spacerobot.diagnosis.overlay import Overlay
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.overlay.figures import glance, trial_figure
from spacerobot.view.overlay.page import page
from spacerobot.view.plotting import png

DRAWN = 30
"""Trials drawn at most: those with the largest residuals."""


def write_overlay(made: Overlay, out: str | Path, *, overwrite: bool = False) -> Path:
    """Write overlay.html, overlay.json and a PNG of each trial, as `spacerobot overlay --out` does.

    Args:
        made: what was simulated.
        out: the folder; one that holds the same finished overlay is left as it is.
        overwrite: replace another run that is there.

    Returns:
        the page.

    Raises:
        InputError: the folder holds something else.
    """
    key = combined_hash("overlay written", dumps(made.as_json()))
    with RunFolder(out, "overlay", key, overwrite=overwrite) as folder:
        if not folder.finished:
            for name, content in overlay_files(made).items():
                folder.write(name, content)
            folder.finish()
        return folder.folder / "overlay.html"


def overlay_files(made: Overlay, *, verbose: bool = False) -> dict[str, str | bytes]:
    """The files by their names, page and data last."""

    def size(trial: TrialOverlay) -> float:
        return float(np.nan_to_num([residuals([c]).chi2_per_sample for c in trial.channels if c.time.size]).sum())

    there = [t for t in made.trials if any(c.time.size for c in t.channels)]
    worst = {t.id for t in sorted(there, key=size, reverse=True)[:DRAWN]}
    found: dict[str, str | bytes] = {}
    pictures: dict[str, bytes] = {}
    with Progress("drawing", len(worst), unit="trial", verbose=verbose) as progress:
        for trial in there:
            if trial.id in worst:
                pictures[trial.id] = png(trial_figure(trial))
                found[f"{_file_name(trial.id)}.png"] = pictures[trial.id]
                progress.advance()
    trials = list(made.trials)
    found["overlay.html"] = page(
        made.study, made.model, trials, made.residuals, pictures, glance(trials), made.not_predicted
    )
    found["overlay.json"] = dumps(made.as_json()) + "\n"
    return found


def _file_name(trial: str) -> str:
    return "trial_" + re.sub(r"[^\w.+=-]+", "_", trial)
