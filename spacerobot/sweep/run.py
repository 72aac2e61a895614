"""A sweep from its file to its tables: the front door."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from typing import Any

from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.sweep.sweep_file import plan_from_text, read_sweep


def run_sweep(
    sweep: str | Path,
    out: str | Path,
    *,
    jobs: int = 1,
    dask: str | None = None,
    seed: int | None = None,
    overwrite: bool = False,
    verbose: bool = False,
) -> dict[str, Any]:
    """Make the parts of a sweep that are not there yet.

    Args:
        sweep: SWEEP.toml: what is varied, and how.
        out: folder for the Parquet tables and sweep.json; a finished run of the same sweep is reused, an interrupted
            one goes on.
        jobs: processes of this machine.
        dask: address of a Dask scheduler, whose workers see `out`, instead of `jobs`.
        seed: of the scatter, instead of the file's.
        overwrite: replace another run that is in `out`.
        verbose: show progress although nobody watches.

    Returns:
        the summary, as in sweep.json.

    Raises:
        InputError: pyarrow is not installed, the file describes no sweep, or `out` holds something else.
    """
    if importlib.util.find_spec("pyarrow") is None:
        raise InputError("pyarrow is not installed", valid='pip install "spacerobot[scale]"')
    from spacerobot.sweep.campaign import Job, make_parts

    text, base = read_sweep(sweep), Path(sweep).resolve().parent
    plan = plan_from_text(text, base, seed=seed, where=str(sweep))
    key = combined_hash("sweep", text, plan.scene.to_toml(), plan.poses, plan.seed)
    with RunFolder(out, "sweep", key, overwrite=overwrite) as folder:
        if not folder.finished:
            job = Job(text, str(base), plan.seed, str(folder.folder), key)
            with executor(jobs, dask) as workers:
                make_parts(folder, job, plan, workers, verbose=verbose)
            folder.finish()
        found: dict[str, Any] = json.loads((folder.folder / "sweep.json").read_text(encoding="utf-8"))
    return found
