"""The work of `spacerobot diagnose`, loaded only when it is called."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import os
import re
import sys
from collections.abc import Mapping
from typing import Any

from spacerobot.cli.effect_files import read_text, run_effect_files
from spacerobot.diagnosis.answer.schema import validate
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.effects.registry import effect
from spacerobot.recordings.lacking import refuse_draft
from spacerobot.recordings.rig_robot import mended_links, study_robot
from spacerobot.recordings.study import load_study, resolve_study
from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor, not_both
from spacerobot.support.jsonio import dumps, plain
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder, combined_hash

_WORDS = {
    "named": "The missing physics is named.",
    "learned": "The missing physics has no name in the catalogue; its law was learned.",
    "ambiguous": "Something is missing, and these data cannot tell its candidates apart.",
    "unknown": "Something is missing that the catalogue has no name for.",
    "nothing_missing": "Nothing is missing that these data could show.",
    "wrong_parameter": "The physics is right; a believed value is not.",
    "not_trusted": "The fit failed its own checks; nothing is concluded.",
}


LISTED = 8
"""Channels that no model predicts, as many as a line of a terminal takes; the file and the report have all."""

_UNITS = {"sigma": "in sensor sigmas", "spread": "as a share of each channel's spread"}


def run(args: argparse.Namespace) -> int:
    """Diagnose a study and write what was found."""
    if args.jobs is not None and args.jobs < 1:
        raise InputError("--jobs must be at least 1", given=args.jobs)
    not_both(args.jobs, args.dask)
    codes = [read_text(f, "--effects") for f in args.effects]
    run_effect_files(args.effects)
    for name in args.without:
        effect(name)  # an unknown name is an error that suggests the nearest
    study = load_study(resolve_study(args.study), args.data)
    refuse_draft(study)  # before a folder is made for it
    if study.robot_file is not None:  # the project's own robots need no mending
        for text in mended_links(study_robot(study)):
            print(f"warning: {text}", file=sys.stderr)
    key = combined_hash(study.input_hash, str(args.seed), *sorted(args.without), *codes)
    with contextlib.ExitStack() as stack:
        folder = None
        if args.out is not None:
            folder = stack.enter_context(RunFolder(args.out, "diagnose", key, overwrite=args.overwrite))
            if folder.finished:
                return show(args, json.loads((folder.folder / "verdict.json").read_text(encoding="utf-8")), folder)
        workers = None if args.dask is None else stack.enter_context(executor(dask=args.dask))
        report = stack.enter_context(_Stages(args.verbose))
        result = diagnose(
            study,
            jobs=args.jobs,
            seed=args.seed,
            without=args.without,
            effects_files=args.effects,
            report=report,
            store=folder,
            workers=workers,
        )
        if folder is None:
            verdict = plain(result.verdict)
            validate(verdict)
        else:
            from spacerobot.view.report.save import write_diagnosis

            verdict = write_diagnosis(result, folder, args.jobs or os.cpu_count() or 1)
            folder.finish()
        return show(args, verdict, folder)


_IDLE = "single effects"
"""The stage in which this process only waits for its workers."""


class _Stages:
    """Progress on standard error, a bar a stage; loads what draws the report where there is nothing else to do."""

    def __init__(self, verbose: bool) -> None:
        self.verbose = verbose
        self._what = ""
        self._bar: Progress | None = None
        self._done = 0

    def __enter__(self) -> _Stages:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def _close(self) -> None:
        if self._bar is not None:
            self._bar.__exit__(None, None, None)
            self._bar = None

    def __call__(self, what: str, done: int, total: int) -> None:
        if what != self._what:
            self._close()
            self._what, self._done = what, 0
            self._bar = Progress(what, total, unit="fit", verbose=self.verbose)
            self._bar.__enter__()
            if what == _IDLE:
                importlib.import_module("spacerobot.view.report")
        if self._bar is not None and done > self._done:
            self._bar.advance(done - self._done)
            self._done = done


def _in_a_line(latex: str) -> str:
    """A learned law's formula as a terminal can show it."""
    text = re.sub(r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/\2", latex)
    return re.sub(r"\\(left|right)|\\(?=[a-z])", "", text.replace(r"\,", " "))


def show(args: argparse.Namespace, verdict: Mapping[str, Any], folder: RunFolder | None) -> int:
    """Print a verdict, as JSON where that is asked; the exit code."""
    if args.json:
        print(dumps(verdict))
        return 0
    from spacerobot.view.report.words import per_unit, with_own_units

    verdict = per_unit(with_own_units(verdict, {}))
    print(f"{verdict['study']}: {verdict['verdict']} (confidence {verdict['confidence']:.2f})")
    from spacerobot.view.report.several import several

    line = several(verdict)
    print(f"{line}." if line else _WORDS[verdict["verdict"]])
    for line in verdict.get("why", []):
        print(f"  {line}")
    found = verdict["effects"] or [{**e, "part": p["part"]} for p in verdict.get("parts", ()) for e in p["effects"]]
    for entry in found:
        part = f" ({entry['part']})" if "part" in entry and not entry["where"].endswith(entry["part"]) else ""
        alone = f", in trial {' and '.join(entry['trials'])} alone" if "trials" in entry else ""
        print(f"  {entry['effect']} at {entry['where']}{part}{alone}")
        _show_values(entry["parameters"])
    for law in verdict.get("learned", []):
        formula = _in_a_line(law["formula"]) if law["formula"] else "no short formula"
        print(f"    {law['kind']} of {' and '.join(law['depends_on'])}: {formula}")
        _show_values(law["parameters"])
        if law["like"]:
            print(f"    {law['like']['words']}")
        if law["formula"] and folder is not None:
            print(f"    a draft of an effect of your own: {folder.folder / 'my_law.py'}")
    if verdict["verdict"] == "ambiguous":
        for other in verdict["alternatives"]:
            names = " + ".join(f"{e['effect']} at {e['where']}" for e in other["effects"])
            wrong = "another " + " and ".join(other["parameters"])
            print(f"  {names or wrong}   (score {other['score']:+.1f})")
    for name, p in verdict["parameters"].items():
        print(f"  {name} moved from {_number(p['believed'])} to {_number(p['value'])} {p['unit']}")
    from spacerobot.view.report.when import happened

    for text in happened(verdict):
        print(f"  {text}")
    overall = verdict["held_out"]["overall"]
    if overall["rms_before"] is not None and overall["rms_after"] is not None:
        unit = _UNITS[verdict["held_out"].get("unit", "sigma")]
        print(f"held out, {unit}: {overall['rms_before']:.3f} before, {overall['rms_after']:.3f} after")
        from spacerobot.view.report.unseen import unseen

        for text in unseen(verdict):
            print(f"  {text}")
    if silent := [c["channel"] for c in verdict.get("not_predicted", ())]:
        more = f" and {len(silent) - LISTED} more" if len(silent) > LISTED else ""
        print(f"predicted by nothing: {', '.join(silent[:LISTED])}{more}")
    if verdict["next_experiment"]:
        print(f"next experiment: {verdict['next_experiment']['change']}; {verdict['next_experiment']['why']}")
    if folder is not None:
        print(f"report: {folder.path('report.html')}")
    return 0


def _show_values(parameters: Mapping[str, Any]) -> None:
    """Each with its interval; a whole number, such as a filter's order, has none."""
    for name, p in parameters.items():
        ends = "" if p["ci95"] is None else f"   95 % {' to '.join(map(_number, p['ci95']))}"
        print(f"    {name:24} {_number(p['value'])}{ends} {p['unit']}".rstrip())


def _number(value: float | str | None) -> str:
    return f"{value:.5g}" if isinstance(value, int | float) else str(value)
