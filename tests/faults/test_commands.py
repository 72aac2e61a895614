"""The commands themselves, killed, interrupted, out of disk or refused the folder; then run again.

The short ones are in every test run; those of `diagnose`, `prove`, `sweep` and `paper` take minutes: marked slow.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.faults.harness import DISK_FULL, INTERRUPT, KILL, READ_ERROR, ROOT, command, outputs, state, steps_of, whole
from tests.processes import PATIENCE, busy_for, eventually, family, gone
from tests.sweep.helpers_sweep import SWEEP

OVERLAY = ["overlay", "guide-friction", "--trials", "03"]
DIAGNOSE = ["diagnose", "guide-friction", "--jobs", "1"]
PAPER = ["paper"]
PROVE = ["prove", "--quick", "--kinds", "nothing_missing", "--share", "0.1", "--seed", "1", "--no-rivals"]

POINTS: dict[str, tuple[float, ...]] = {
    "overlay": (0.0, 0.25, 0.5, 0.75, 0.9, 1.0),
    "sweep": (0.0, 0.3, 0.6, 0.9, 1.0),
    "paper": (0.3, 0.8),
    "diagnose": (0.5, 0.9),
    "prove": (0.3, 0.7),
}
"""At which parts of a command's steps the fault happens; docs/trust.md says how many."""

EXPECTED = {KILL: -signal.SIGKILL, INTERRUPT: 130, DISK_FULL: 1, READ_ERROR: 2}


FAULTS = (KILL, INTERRUPT, DISK_FULL, READ_ERROR)


@dataclass(frozen=True)
class Undisturbed:
    """A run that nothing happened to: how many steps it took, what it left, and where the others find their input."""

    arguments: list[str]
    steps: int
    outputs: dict[str, bytes]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Callable[[list[str]], Undisturbed]:
    """Runs a command once for all its faults."""
    known: dict[tuple[str, ...], Undisturbed] = {}

    def run(arguments: list[str]) -> Undisturbed:
        key = tuple(arguments)
        if key not in known:
            folder = tmp_path_factory.mktemp("undisturbed")
            first = command([*arguments, "--out", str(folder / "out")], folder / "out")
            assert first.returncode == 0, first.stderr[-2000:]
            assert command([*arguments, "--out", str(folder / "out")], folder / "out").stdout, "a finished run answers"
            known[key] = Undisturbed(arguments, steps_of(first), outputs(folder / "out"))
        return known[key]

    return run


def survives(usual: Undisturbed, fault: str, parts: tuple[float, ...], tmp_path: Path) -> None:
    """The fault at some of the steps: whole or absent, nothing half-written looks finished, and again gets there."""
    folder, temporary = tmp_path / "out", tmp_path / "temporary"
    temporary.mkdir()
    line = [*usual.arguments, "--out", str(folder)]
    met = 0
    for part in parts:  # the same folder again and again: each fault meets what the one before has left
        at = max(1, round(part * usual.steps))
        done = command(line, folder, fault, at, temporary)
        said = state(folder)
        whole(folder, usual.outputs)
        if "fault" in done.stderr and done.returncode != 0:
            met += 1
            assert "Traceback" not in done.stderr, done.stderr[-3000:]
            assert done.returncode in (EXPECTED[fault], 1, 2), (fault, part, done.stderr[-500:])
            assert done.stdout == "", "no answer before the files are there"
            assert said != "finished"
    assert met, "it did happen"
    done = command(line, folder, temporary=temporary)
    assert done.returncode == 0, done.stderr[-2000:]
    assert state(folder) == "finished"
    assert outputs(folder).keys() == usual.outputs.keys()
    assert not list(folder.rglob(".*.part"))
    assert not (folder / "partial").exists()
    assert not lying_about(temporary)


Usual = Callable[[list[str]], Undisturbed]


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_overlay(undisturbed: Usual, fault: str, tmp_path: Path) -> None:
    survives(undisturbed(OVERLAY), fault, POINTS["overlay"], tmp_path)


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small sweep."""
    path = tmp_path_factory.mktemp("sweep") / "sweep.toml"
    path.write_text(SWEEP, encoding="utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_sweep(undisturbed: Usual, sweep_file: Path, fault: str, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    usual = undisturbed(["sweep", str(sweep_file), "--jobs", "1"])
    survives(usual, fault, POINTS["sweep"], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_paper(undisturbed: Usual, fault: str, tmp_path: Path) -> None:
    survives(undisturbed(PAPER), fault, POINTS["paper"], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_diagnose(undisturbed: Usual, fault: str, tmp_path: Path) -> None:
    survives(undisturbed(DIAGNOSE), fault, POINTS["diagnose"], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_prove(undisturbed: Usual, fault: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    survives(undisturbed(PROVE), fault, POINTS["prove"], tmp_path)


def test_the_page_tells_the_points() -> None:
    page = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    for name, parts in POINTS.items():
        assert f"| `{name}` |" + f" {len(parts)} |" * len(FAULTS) in page


def begun(arguments: list[str], temporary: Path | None = None) -> subprocess.Popen[str]:
    """A command in a session of its own that hears Ctrl-C as from a terminal; a job in the background does not."""
    elsewhere = {} if temporary is None else {"TMPDIR": str(temporary)}
    return subprocess.Popen(
        [sys.executable, "-m", "spacerobot", *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **elsewhere},
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def with_workers(process: subprocess.Popen[str]) -> set[int]:
    """Wait until the command has two processes of its own at work, and name all it has."""

    def at_work() -> bool:
        assert process.poll() is None, process.communicate()[1][-1000:]
        return sum(busy_for(p) > 0.5 for p in family(process.pid)) >= 2

    assert eventually(at_work)
    return family(process.pid)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_nobody_works_on_for_a_diagnosis_that_is_gone(tmp_path: Path, how: signal.Signals) -> None:
    process = begun(["diagnose", "guide-friction", "--jobs", "2", "--out", str(tmp_path / "out")])
    workers = with_workers(process)
    if how == signal.SIGINT:
        os.killpg(process.pid, how)  # a terminal sends it to all of them
    else:
        process.kill()
    said = process.communicate(timeout=PATIENCE)
    assert process.returncode == (130 if how == signal.SIGINT else -signal.SIGKILL)
    if how == signal.SIGINT:
        assert "Traceback" not in said[1]
        assert said[1].strip().endswith("spacerobot diagnose: interrupted")
    assert gone(workers)
    assert state(tmp_path / "out") in ("running", "nothing")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
def test_a_lost_worker_does_not_lose_the_diagnosis(tmp_path: Path) -> None:
    process = begun(["diagnose", "guide-friction", "--jobs", "2", "--json", "--out", str(tmp_path / "out")])
    busiest = max(with_workers(process), key=lambda p: Path(f"/proc/{p}/statm").read_text().split()[1].zfill(12))
    os.kill(busiest, signal.SIGKILL)
    out, err = process.communicate(timeout=900)
    assert process.returncode == 0, err[-2000:]
    assert [e["effect"] for e in json.loads(out)["effects"]] == ["coulomb_friction"]


def lying_about(temporary: Path) -> set[str]:
    """What processes left in the temporary folder, compiled code aside, which is kept on purpose."""
    return {p.name for p in temporary.iterdir() if "numba" not in p.name}


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_proof_stopped_in_the_midst_of_a_diagnosis_goes_on_and_clears_up(tmp_path: Path, how: signal.Signals) -> None:
    pytest.importorskip("mujoco")
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    process = begun([*PROVE, "--out", str(tmp_path / "out")], temporary)

    def diagnosing() -> bool:
        assert process.poll() is None, process.communicate()[1][-1000:]
        return any("blind" in name for name in lying_about(temporary))

    assert eventually(diagnosing, 300.0)
    workers = family(process.pid)
    process.send_signal(how)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == (130 if how == signal.SIGINT else -signal.SIGKILL)
    assert "Traceback" not in said
    assert gone(workers)
    assert state(tmp_path / "out") == "running"
    assert bool(lying_about(temporary)) == (how == signal.SIGKILL), "who is interrupted clears up, who is killed cannot"
    done = command([*PROVE, "--out", str(tmp_path / "out")], tmp_path / "out", temporary=temporary)
    assert done.returncode == 0, done.stderr[-2000:]
    assert state(tmp_path / "out") == "finished"
    assert not lying_about(temporary)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 150 kB."""
    yield from mounted(tmp_path / "disk", "size=150k")


@pytest.fixture
def read_only(tmp_path: Path) -> Iterator[Path]:
    """A file system that cannot be written."""
    yield from mounted(tmp_path / "disk", "ro")


def mounted(folder: Path, options: str) -> Iterator[Path]:
    """A mount for the time of a test; skipped where that is not allowed."""
    folder.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], capture_output=True, text=True)
    if done.returncode != 0:
        pytest.skip(f"cannot mount: {done.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_disk_that_is_full(small_disk: Path) -> None:
    done = command([*OVERLAY, "--out", str(small_disk / "out")], small_disk / "out")
    assert done.returncode == 1
    assert "No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert state(small_disk / "out") != "finished"
    assert not list(small_disk.rglob("*.html")), "what did not fit is not there in part"
    assert not list(small_disk.rglob(".*.part"))


def test_a_folder_that_cannot_be_written(read_only: Path) -> None:
    done = command([*OVERLAY, "--out", str(read_only / "out")], read_only / "out")
    assert done.returncode == 2
    assert "Read-only file system" in done.stderr
    assert done.stderr.count("\n") <= 3
    assert not list(read_only.iterdir())


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_of_somebody_else(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    try:
        done = command([*OVERLAY, "--out", str(tmp_path / "out")], tmp_path / "out")
    finally:
        tmp_path.chmod(0o755)
    assert done.returncode == 2
    assert "Permission denied" in done.stderr
