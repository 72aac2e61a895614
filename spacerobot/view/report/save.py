"""A diagnosis as files: verdict, report, pictures, and the model to go on with."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.answer.schema import validate
from spacerobot.support.jsonio import dumps, plain
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.report.write import write_plots, write_report


def save_diagnosis(diagnosis: Diagnosis, out: str | Path, *, overwrite: bool = False) -> Path:
    """Write verdict.json, report.html, plots and what can be run again, as `spacerobot diagnose --out` does.

    That is scene.toml or model.toml, and of a learned law with a formula my_law.py.

    Args:
        diagnosis: what was found.
        out: the folder; one that holds the same finished diagnosis is left as it is.
        overwrite: replace another run that is there.

    Returns:
        the report.

    Raises:
        InputError: the folder holds something else.
    """
    key = combined_hash("saved", diagnosis.verdict["input_hash"], dumps(plain(diagnosis.verdict)))
    with RunFolder(out, "diagnose", key, overwrite=overwrite) as folder:
        if not folder.finished:
            write_diagnosis(diagnosis, folder)
            folder.finish()
        return folder.folder / "report.html"


def write_diagnosis(diagnosis: Diagnosis, folder: RunFolder, jobs: int = 1) -> dict[str, Any]:
    """Write a diagnosis's files into a run; returns the verdict as it was written."""
    verdict, evidence = plain(diagnosis.verdict), plain(diagnosis.evidence)
    assert isinstance(verdict, dict)
    assert isinstance(evidence, dict)
    validate(verdict)
    folder.write("verdict.json", dumps(verdict))
    if diagnosis.scene is not None:  # other machines than a wrist rig have a model instead
        folder.write("scene.toml", diagnosis.scene.to_toml())
    if diagnosis.model is not None:
        folder.write("model.toml", diagnosis.model)
    if diagnosis.law_file is not None:
        folder.write("my_law.py", diagnosis.law_file)
    write_report(verdict, evidence, folder.path("report.html"))
    write_plots(verdict, evidence, folder.folder / "plots", jobs, noted=partial(_noted, folder))
    return verdict


def _noted(folder: RunFolder, names: Sequence[str]) -> None:
    """The report's pictures as the run's own, before they are written."""
    folder.paths(f"plots/{name}" for name in names)
