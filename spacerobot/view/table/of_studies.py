"""Many studies diagnosed, one page: the front door of `spacerobot study table`."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.recordings.study import Study, bundled_studies, load_study, resolve_study
from spacerobot.support.errors import InputError
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps, plain
from spacerobot.support.sources import package_hash
from spacerobot.view.table.literature import Figure, measured, quoted
from spacerobot.view.table.page import page

REAL = "real/"

BY_HAND = "<!-- Written by hand from here on: `spacerobot study table` keeps it. -->"


def named_or_real(studies: Sequence[str | Path] = ()) -> list[str]:
    """The studies that are named, else the bundled real ones."""
    return [str(s) for s in studies] or sorted(n for n in bundled_studies() if n.startswith(REAL))


def _unwatched(name: str, fault: InputError | None) -> None:
    """Progress that nobody watches."""


def study_table(
    studies: Sequence[str | Path] = (),
    *,
    runs: str | Path | None = None,
    report: Callable[[str, InputError | None], None] = _unwatched,
) -> str:
    """Diagnose studies and set their verdicts side by side, as `spacerobot study table` does.

    Args:
        studies: folders, study files or names of bundled studies; the bundled real ones if none is given, those
            whose recordings are absent being named in the page.
        runs: folder that keeps verdicts: one of the same input and code is not computed again.
        report: called with each study's name when it is done, and with why its recordings cannot be read.

    Returns:
        the page, Markdown.

    Raises:
        InputError: a study that was given, or every bundled one, cannot be read.
    """
    names = named_or_real(studies)
    verdicts: dict[str, Mapping[str, Any]] = {}
    absent = []
    for name in names:
        short, fault = name.removeprefix(REAL), None
        try:
            verdicts[short] = _verdict(load_study(resolve_study(name)), short, None if runs is None else Path(runs))
        except InputError as error:
            if studies:
                raise
            absent.append(short)
            fault = error
        report(name, fault)
    if not verdicts:
        raise InputError("no study could be read", given=", ".join(names), valid="SPACEROBOT_DATA with the recordings")
    return page(verdicts, absent)


def by_hand(path: Path) -> str:
    """What an earlier page at this place has from the line BY_HAND on, which its next writing keeps."""
    if not path.is_file():
        return ""
    _, line, rest = path.read_text(encoding="utf-8").partition(f"\n{BY_HAND}\n")
    return line[1:] + rest


def _verdict(study: Study, name: str, runs: Path | None) -> Mapping[str, Any]:
    """The study's verdict, with the CPU time that it took; from an earlier run where nothing changed."""
    path = None if runs is None else runs / f"{name.replace('/', '_')}.json"
    kept = None if path is None else _kept(path)
    if kept is not None and kept.get("input_hash") == study.input_hash and kept.get("code") == package_hash():
        notes = {f.what: f.note for f in _quoted(study)}
        for figure in kept.get("figures", ()):
            figure["note"] = notes.get(figure["what"], "")
        return kept
    began = time.process_time()
    found = diagnose(study, jobs=1)
    verdict = {**plain(found.verdict), "code": package_hash(), "cpu_seconds": round(time.process_time() - began, 1)}
    verdict["figures"] = _figures(study, found)
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, dumps(verdict))
    return verdict


def _kept(path: Path) -> dict[str, Any] | None:
    """The verdict of an earlier run, None where there is none.

    Raises:
        InputError: something else is there, which a verdict would replace.
    """
    if not os.path.lexists(path):
        return None
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        found = None
    if path.is_symlink() or not isinstance(found, dict) or not {"verdict", "input_hash"} <= set(found):
        raise InputError("a file is there that is no kept verdict", given=str(path), where="--runs")
    return found


def _figures(study: Study, found: Diagnosis) -> list[dict[str, Any]]:
    """What others state for these recordings, and the same measure of ours."""
    return [
        {
            "what": f.what,
            "unit": f.unit,
            "note": f.note,
            "theirs": {"before": list(f.before), "after": list(f.after)},
            "ours": measured(f, found.parts),
        }
        for f in _quoted(study)
    ]


def _quoted(study: Study) -> tuple[Figure, ...]:
    stated = quoted(study.path if study.path.is_dir() else study.path.parent)
    return stated.figures if stated is not None else ()
