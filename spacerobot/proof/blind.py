"""The blind part: the diagnosis in a process of its own, given the study's folder and nothing else."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.support.orphans import leashed
from spacerobot.support.scratch import scratch
from spacerobot.support.workers import THREAD_VARIABLES

LIMIT = 900.0
"""Seconds after which a diagnosis counts as failed."""

TRIES = 2
"""A diagnosis that is killed from outside, not by its limit, is begun so often."""

COMMAND = (sys.executable, "-m", "spacerobot", "diagnose")


@dataclass(frozen=True)
class Answer:
    """What a diagnosis said.

    Attributes:
        verdict: the object on its standard output, None where it failed.
        seconds: wall time.
        error: the end of what it said where it failed.
    """

    verdict: dict[str, Any] | None
    seconds: float
    error: str = ""


def diagnose(
    study: Path, *, without: str | None = None, command: Sequence[str] = COMMAND, limit: float = LIMIT
) -> Answer:
    """Run the diagnosis on a study's folder alone.

    Its working folder is a fresh one; the verdict comes on standard output, without the report. Where this process is
    killed, so is the diagnosis; one that was killed itself, as the system does where memory runs out, is tried again.

    Args:
        study: folder of the study.
        without: effect that the catalogue is to do without.
        command: the diagnosis; STUDY, --json, --jobs and --without are added.
        limit: in s.
    """
    arguments = [*command, str(study.resolve()), "--json", "--jobs", "1"]
    if without is not None:
        arguments += ["--without", without]
    began = time.monotonic()
    for _ in range(TRIES):
        try:
            code, out, err = _run(arguments, limit)
        except subprocess.TimeoutExpired:
            return Answer(None, time.monotonic() - began, f"took more than {limit:g} s")
        if code != -signal.SIGKILL:
            break
    seconds = time.monotonic() - began
    if code == -signal.SIGKILL:
        return Answer(None, seconds, f"killed {TRIES} times from outside, as the system does where memory runs out")
    if code != 0:
        return Answer(None, seconds, f"exit {code}: {err.strip()[-400:]}")
    try:
        verdict = json.loads(out)
    except ValueError:
        verdict = None
    if not isinstance(verdict, dict) or "verdict" not in verdict:
        return Answer(None, seconds, "standard output holds no verdict")
    return Answer(verdict, seconds)


def _run(arguments: Sequence[str], limit: float) -> tuple[int, str, str]:
    """Exit code (-signal where one ended it), standard output and error."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("SPACEROBOT_")}
    environment.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    with scratch("blind") as folder:
        process = subprocess.Popen(  # noqa: S603 - our own command on our own files
            leashed(arguments),
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        try:
            out, err = process.communicate(timeout=limit)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise
    return process.returncode, out, err
