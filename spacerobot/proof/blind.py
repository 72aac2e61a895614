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
from tempfile import TemporaryDirectory
from typing import Any

from spacerobot.support.executors.base import THREAD_VARIABLES
from spacerobot.support.orphans import leashed

LIMIT = 900.0
"""Seconds after which a diagnosis counts as failed."""

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

    Its working folder is a fresh one, which neither holds the seal nor says where it is; the verdict comes on standard
    output, without the report. Where this process is killed, so is the diagnosis.

    Args:
        study: folder of the study.
        without: effect that the catalogue is to do without.
        command: the diagnosis; STUDY, --json, --jobs and --without are added.
        limit: in s.
    """
    with TemporaryDirectory(prefix="blind-") as folder:
        arguments = [*command, str(study.resolve()), "--json", "--jobs", "1"]
        if without is not None:
            arguments += ["--without", without]
        environment = {k: v for k, v in os.environ.items() if not k.startswith("SPACEROBOT_")}
        environment.update(dict.fromkeys(THREAD_VARIABLES, "1"))
        began = time.monotonic()
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
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return Answer(None, time.monotonic() - began, f"took more than {limit:g} s")
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise
        seconds = time.monotonic() - began
    if process.returncode != 0:
        return Answer(None, seconds, f"exit {process.returncode}: {err.strip()[-400:]}")
    try:
        verdict = json.loads(out)
    except ValueError:
        verdict = None
    if not isinstance(verdict, dict) or "verdict" not in verdict:
        return Answer(None, seconds, "standard output holds no verdict")
    return Answer(verdict, seconds)
