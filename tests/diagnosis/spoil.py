"""Ways in which a laboratory's files are spoiled, done to a copy of a study."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from spacerobot.recordings.study import Study, load_study

Table = np.ndarray
"""A file's columns, shape (T, C): the time first."""


def rewritten(file: Path, change: Callable[[Table], Table]) -> None:
    """A CSV file with its numbers changed."""
    head, *rows = file.read_text().splitlines()
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    np.savetxt(file, change(table), "%.9g", ",", header=head, comments="")


def glitch(table: Table, size: float, column: int = 1, at: float = 0.6) -> Table:
    """One reading that is off."""
    out = table.copy()
    out[int(at * len(out)), column] += size
    return out


def outliers(table: Table, sigmas: Mapping[int, float], random: np.random.Generator, share: float = 0.01) -> Table:
    """A share of the readings 20 sigma off, to either side."""
    out = table.copy()
    for column, sigma in sigmas.items():
        hit = random.random(len(out)) < share
        out[hit, column] += 20.0 * sigma * random.choice([-1.0, 1.0], hit.sum())
    return out


def rounded(table: Table, step: float) -> Table:
    """Readings to whole steps."""
    return np.column_stack([table[:, 0], np.round(table[:, 1:] / step) * step])


def clipped(table: Table, share: float) -> Table:
    """A force sensor whose range ends at a share of the peak."""
    return np.column_stack([table[:, 0], np.minimum(table[:, 1], share * table[:, 1].max())])


def jittered(table: Table, seconds: float, random: np.random.Generator) -> Table:
    """Time stamps that come late or early."""
    time = table[:, 0] + seconds * random.standard_normal(len(table))
    return np.column_stack([np.maximum.accumulate(time) + 1e-7 * np.arange(len(table)), table[:, 1:]])


def cut_short(file: Path) -> None:
    """The last number without most of its digits, as a full disk leaves it."""
    text = file.read_text().rstrip("\n")
    file.write_text(text[: text.rindex(",") + 3])


def weighed(text: str, factor: float) -> str:
    """The study's words with another sigma for every channel."""
    for stated in ("0.00015", "0.25"):
        text = text.replace(f"sigma = {stated}", f"sigma = {factor * float(stated):.6g}")
    return text


WAYS = ("glitch", "outliers", "half", "double", "rounded", "clipped", "cut", "jitter")


def spoiled(source: Study, folder: Path, way: str) -> Study:
    """A copy of an air-bed study, spoiled in one way."""
    shutil.copytree(source.path.parent, folder, copy_function=shutil.copyfile)
    file = folder / "study.toml"
    random = np.random.default_rng(7)
    for number, trial in enumerate(source.trials):
        mocap, force = (folder / trial.sources[name].file for name in ("mocap", "force"))
        if way == "glitch" and number == 1:
            rewritten(mocap, lambda t: glitch(t, 0.005))
        elif way == "outliers":
            width = len(mocap.read_text().partition("\n")[0].split(","))
            rewritten(mocap, lambda t, w=width: outliers(t, dict.fromkeys(range(1, w), 1.5e-4), random))
            rewritten(force, lambda t: outliers(t, {1: 0.25}, random))
        elif way == "rounded":
            rewritten(mocap, lambda t: rounded(t, 1e-3))
        elif way == "clipped":
            rewritten(force, lambda t: clipped(t, 0.8))
        elif way == "cut" and number == 2:
            cut_short(mocap)
        elif way == "jitter":
            rewritten(mocap, lambda t: jittered(t, 5e-4, random))
            rewritten(force, lambda t: jittered(t, 5e-5, random))
    if way in ("half", "double"):
        file.write_text(weighed(file.read_text(), {"half": 0.5, "double": 2.0}[way]))
    return load_study(file)
