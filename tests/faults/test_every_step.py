"""A small run with all that a run does, broken at every single step in every way; then run again."""

from __future__ import annotations

import errno
import json
import os
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacerobot.support.runs import MARKER, RunFolder
from tests.faults.harness import DISK_FULL, INTERRUPT, KILL, READ_ERROR, ROOT, state

TEXT, DATA = "a line\n" * 500, bytes(range(256)) * 20
_MAKING = os.O_WRONLY | os.O_RDWR | os.O_CREAT
DONE, REFUSED, INTERRUPTED, BROKEN = 0, 1, 130, 99


def small_run(folder: Path) -> None:
    """Two partial results, three outputs, one of them in a folder of its own."""
    with RunFolder(folder, "small", "a") as run:
        if run.finished:
            return
        for i in range(2):
            if run.load(f"step {i}") is None:
                run.save(f"step {i}", {"value": i})
                run.save_arrays(f"step {i}", {"x": np.arange(5.0)})
        run.write("answer.json", json.dumps({"steps": [run.load(f"step {i}") for i in range(2)], "text": TEXT}))
        run.write("figures/a.png", DATA)
        run.write("page.html", TEXT)
        run.finish()


def broken(work: Callable[[], None], folder: Path, fault: str, at: int) -> tuple[int, int]:
    """Do the work in a process of its own with a fault at one step; exit code (or -signal), and steps taken."""
    source, sink = os.pipe()
    process = os.fork()
    if process == 0:
        code = BROKEN
        steps = 0

        def step(event: str, args: tuple[Any, ...]) -> None:
            nonlocal steps
            wanted = event in ("os.rename", "os.remove", "os.mkdir", "os.chmod") or (
                event == "open" and isinstance(args[2], int) and bool(args[2] & _MAKING)
            )
            if not wanted or not str(args[0]).startswith(str(folder)):
                return
            steps += 1
            if steps != at:
                return
            if fault == KILL:
                os.kill(os.getpid(), signal.SIGKILL)
            elif fault == INTERRUPT:
                signal.raise_signal(signal.SIGINT)
            else:
                number = errno.ENOSPC if fault == DISK_FULL else errno.EROFS
                raise OSError(number, os.strerror(number), str(args[0]))

        try:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            sys.addaudithook(step)
            work()
            code = DONE
        except KeyboardInterrupt:
            code = INTERRUPTED
        except OSError:
            code = REFUSED
        except Exception as error:
            code = REFUSED if type(error).__name__ == "InputError" else BROKEN
            if code == BROKEN:
                traceback.print_exc()
        finally:
            at = -1
            os.write(sink, steps.to_bytes(4, "little"))
            os._exit(code)
    os.close(sink)
    with os.fdopen(source, "rb") as stream:
        said = stream.read()
    _, status = os.waitpid(process, 0)
    return os.waitstatus_to_exitcode(status), int.from_bytes(said or b"\0", "little")


def test_the_small_run_takes_many_steps(tmp_path: Path) -> None:
    code, steps = broken(lambda: small_run(tmp_path / "run"), tmp_path, "none", 0)
    assert code == DONE
    assert steps > 30
    assert f"at each of its {steps} steps | {steps} |" in (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    assert state(tmp_path / "run") == "finished"


@pytest.mark.parametrize(
    "fault", [KILL, DISK_FULL, *(pytest.param(f, marks=pytest.mark.slow) for f in (INTERRUPT, READ_ERROR))]
)
def test_whole_or_absent_after_a_fault_at_every_step(tmp_path: Path, fault: str) -> None:
    _, steps = broken(lambda: small_run(tmp_path / "reference"), tmp_path, "none", 0)
    names = ("answer.json", "figures/a.png", "page.html")
    wanted = {name: (tmp_path / "reference" / name).read_bytes() for name in names}
    expected = {KILL: -signal.SIGKILL, INTERRUPT: INTERRUPTED}.get(fault, REFUSED)
    met = 0
    for at in range(1, steps + 1):
        folder = tmp_path / f"run{at}"
        code, _ = broken(lambda folder=folder: small_run(folder), folder, fault, at)  # type: ignore[misc]
        assert code in (expected, DONE), at
        met += code == expected
        said = state(folder)
        for name, content in wanted.items():
            if (folder / name).exists():
                assert (folder / name).read_bytes() == content, f"{name} is half there after step {at}"
            elif said == "finished":
                pytest.fail(f"it calls itself finished after step {at}, without {name}")
        small_run(folder)  # again, and undisturbed
        assert state(folder) == "finished"
        assert {name: (folder / name).read_bytes() for name in wanted} == wanted
        assert not list(folder.rglob(".*.part"))
        assert not (folder / "partial").exists()
    assert met >= 0.7 * steps, "it did happen, but for steps that are allowed to fail"


def test_the_check_can_fail(tmp_path: Path) -> None:
    """A run that marks itself finished first and writes in place is caught."""

    def careless() -> None:
        folder = tmp_path / "run"
        folder.mkdir()
        (folder / MARKER).write_text(json.dumps({"state": "finished", "outputs": {"page.html": len(TEXT)}}))
        (folder / "page.html").write_text(TEXT)

    code, _ = broken(careless, tmp_path / "run", KILL, 3)
    assert code == -signal.SIGKILL
    with pytest.raises((AssertionError, FileNotFoundError)):
        state(tmp_path / "run")
