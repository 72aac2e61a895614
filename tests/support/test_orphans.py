"""A command that is not to outlive the process that began it does not, even where that one was killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.support.orphans import watch_over
from tests.processes import gone, written

SLEEPER = "import os, sys, time; open(sys.argv[1], 'w').write(str(os.getpid())); time.sleep(60)"

HOW = {
    "the kernel tells": "become(command, os.getppid())",
    "somebody looks": "watch_over(command, os.getppid(), every=0.1)",
    "nobody": "subprocess.run(command)",
}


def begun(tmp_path: Path, how: str) -> tuple[subprocess.Popen[bytes], int]:
    """A process that waits for a second one, which in `how` comes by a sleeper; the sleeper's id with it."""
    note = tmp_path / "pid"
    second = (
        "import os, subprocess, sys; from spacerobot.support.orphans import become, watch_over\n"
        f"command = [sys.executable, '-c', {SLEEPER!r}, {str(note)!r}]\n{HOW[how]}\n"
    )
    first = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {second!r}])"
    process = subprocess.Popen([sys.executable, "-c", first])
    return process, int(written(note))


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
@pytest.mark.parametrize("how", ["the kernel tells", "somebody looks"])
def test_it_is_gone_once_its_parent_was_killed(tmp_path: Path, how: str) -> None:
    process, sleeper = begun(tmp_path, how)
    process.kill()
    process.wait()
    assert gone({sleeper}, 40.0), "the sleeper would sleep for 60 s"


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
def test_without_it_it_lives_on(tmp_path: Path) -> None:
    process, sleeper = begun(tmp_path, "nobody")
    process.kill()
    process.wait()
    try:
        assert not gone({sleeper}, 0.7)
    finally:
        os.kill(sleeper, signal.SIGKILL)


def test_the_exit_code_is_the_commands_own() -> None:
    assert watch_over([sys.executable, "-c", "raise SystemExit(7)"], os.getppid()) == 7
