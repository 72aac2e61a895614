"""One wrist rig, and its trials written down as a lab would."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.table import Floats

SPEEDS = (0.03, 0.06, 0.09)


def rig(speed: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Times s, target m, slider m and force N of one trial: they touch at 1 s."""
    rng = np.random.default_rng(round(1000 * speed))
    t = np.arange(0, 2, 0.01)
    pushed = np.where(t > 1, speed / 8 * np.sin(np.clip(8 * (t - 1), 0, np.pi)), 0.0)
    target = np.where(t > 1, pushed - 1.5 * speed * np.clip(t - 1 - np.pi / 8, 0, None), speed * (t - 1))
    noise = [rng.normal(0, s, len(t)) for s in (1e-4, 1e-4, 0.2)]
    return t, target + noise[0], pushed + noise[1], 800 * pushed + noise[2]


def check(study: Study) -> None:
    assert [t.id for t in study.trials] == ["run1", "run2", "run3"]
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        t, target, wrist, force = rig(speed)
        recording = study.recording(trial)
        assert list(recording) == ["target.x", "wrist.x", "contact.force"]
        for name, truth, within in (
            ("target.x", target, 5e-4),
            ("wrist.x", wrist, 5e-5),
            ("contact.force", force, 0.1),
        ):
            series = recording[name]
            assert len(series.value) == len(t)
            assert np.ptp(series.time) == pytest.approx(np.ptp(t), abs=2e-3)
            assert abs(np.median(series.value - truth)) < within  # its zero was found again
            assert np.std(series.value - truth) < 1e-3 * np.ptp(truth)  # unit and sign too


def written(folder: Path, head: str, row: str, encoding: str = "utf-8", ending: str = "csv") -> Study:
    """Three trials in a layout: `row` is formatted with n, t, x, s, f and i, the row's number."""
    folder.mkdir(exist_ok=True)
    for n, speed in enumerate(SPEEDS, 1):
        rows = enumerate(zip(*rig(speed), strict=True))
        text = [row.format(i=i, n=n, t=t, d=1e9 * (0.4 + t / 86400), x=x, s=s, f=f) for i, (t, x, s, f) in rows]
        (folder / f"run{n}.{ending}").write_text("\n".join([head, *text]), encoding=encoding)
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    return load_study(folder)


def columns_of(study: Study) -> dict[str, str]:
    return {c.name: c.column for s in study.streams.values() for c in s.channels}
