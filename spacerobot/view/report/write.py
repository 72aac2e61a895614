"""Writing the report and its plots."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import Any

from spacerobot.support.files import atomic, write_text
from spacerobot.support.jsonio import plain
from spacerobot.support.workers import begin, context, may_fork, without_interrupts
from spacerobot.view import plotting
from spacerobot.view.report.charts import Chart
from spacerobot.view.report.evidence import read_evidence
from spacerobot.view.report.page import page
from spacerobot.view.report.plots import drawings


def write_report(verdict: Mapping[str, Any], evidence: Mapping[str, Any], path: Path) -> None:
    """Write one HTML file, under 5 MB, that opens offline and asks nothing of any network.

    Args:
        verdict: as in verdict.json (see `spacerobot.diagnosis.answer.schema`).
        evidence: traces, hypotheses, located mismatches, surfaces and checks; every part may be absent.
        path: the file to write, whole or not at all.

    Raises:
        InputError: the evidence is not of the agreed form.
    """
    write_text(Path(path), page(plain(dict(verdict)), read_evidence(plain(dict(evidence)))))


def _unnoted(names: Sequence[str]) -> None:
    """Nobody wants to know."""


_drawings: dict[str, Callable[[], Chart | None]] = {}
"""Of the report that is being written: processes that begin meanwhile have them too."""


def write_plots(
    verdict: Mapping[str, Any],
    evidence: Mapping[str, Any],
    folder: Path,
    jobs: int = 1,
    *,
    noted: Callable[[Sequence[str]], None] = _unnoted,
) -> list[str]:
    """Write the report's pictures as PNG and SVG.

    Args:
        verdict: as for `write_report`.
        evidence: as for `write_report`.
        folder: where they go; made if it is missing.
        jobs: processes.
        noted: told beforehand of all the names that may be written.

    Returns:
        Names of the files written.
    """
    _drawings.update(drawings(plain(dict(verdict)), read_evidence(plain(dict(evidence)))))
    write = partial(_write, folder)
    try:
        noted([f"{name}.{kind}" for name in _drawings for kind in ("png", "svg")])
        return _spread(write, [*_drawings], jobs)
    finally:
        _drawings.clear()


def _spread(write: Callable[[str], list[str]], names: Sequence[str], jobs: int) -> list[str]:
    if jobs > 1 and may_fork():
        try:
            with ProcessPoolExecutor(jobs, mp_context=context(fork=True), initializer=begin) as pool:
                with without_interrupts():  # submitting begins processes
                    waiting = [pool.submit(write, name) for name in names]
                return [file for future in waiting for file in future.result()]
        except BrokenProcessPool:  # one was lost: all of them here, then
            pass
    return [file for name in names for file in write(name)]


def _write(folder: Path, name: str) -> list[str]:
    chart = _drawings[name]()
    if chart is None:
        return []
    with atomic(Path(folder) / f"{name}.png", "wb") as stream:
        stream.write(plotting.png(chart.figure))
    write_text(Path(folder) / f"{name}.svg", plotting.svg(chart.figure))
    return [f"{name}.png", f"{name}.svg"]
