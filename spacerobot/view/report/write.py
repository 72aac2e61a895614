"""Writing the report and its plots."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spacerobot.support.files import atomic, write_text
from spacerobot.support.jsonio import plain
from spacerobot.view import plotting
from spacerobot.view.report.evidence import read_evidence
from spacerobot.view.report.page import page
from spacerobot.view.report.plots import figures


def write_report(verdict: Mapping[str, Any], evidence: Mapping[str, Any], path: Path) -> None:
    """Write one HTML file, under 5 MB, that opens offline and asks nothing of any network.

    Args:
        verdict: as in verdict.json (see `spacerobot.diagnosis.schema`).
        evidence: traces, hypotheses, located mismatches, surfaces and checks; every part may be absent.
        path: the file to write, whole or not at all.

    Raises:
        InputError: the evidence is not of the agreed form.
    """
    write_text(Path(path), page(plain(dict(verdict)), read_evidence(plain(dict(evidence)))))


def write_plots(verdict: Mapping[str, Any], evidence: Mapping[str, Any], folder: Path) -> list[str]:
    """Write the report's pictures as PNG and SVG.

    Args:
        verdict: as for `write_report`.
        evidence: as for `write_report`.
        folder: where they go; made if it is missing.

    Returns:
        Names of the files written.
    """
    written = []
    for name, figure in figures(plain(dict(verdict)), read_evidence(plain(dict(evidence)))).items():
        with atomic(Path(folder) / f"{name}.png", "wb") as stream:
            stream.write(plotting.png(figure))
        write_text(Path(folder) / f"{name}.svg", plotting.svg(figure))
        written += [f"{name}.png", f"{name}.svg"]
    return written
