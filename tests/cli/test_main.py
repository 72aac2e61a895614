"""The front door: help at once, mistakes in one line, output that can break off."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.cli import mass, robots
from spacerobot.cli.main import COMMANDS, main

HEAVY = {"numpy", "scipy", "pinocchio", "numba", "matplotlib", "yourdfpy", "h5py", "jinja2"}


def spacerobot(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [sys.executable, "-m", "spacerobot", *arguments], capture_output=True, text=True, check=False, **options
    )


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_is_light_and_has_examples(command: str) -> None:
    code = (
        "import sys\nfrom spacerobot.cli.main import main\n"
        "try:\n    main(sys.argv[1:])\n"
        f"finally:\n    sys.stderr.write(' '.join({HEAVY!r} & set(sys.modules)))"
    )
    arguments = [*([command] if command else []), "--help"]
    done = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stderr == "", "help loads something heavy"
    assert "example" in done.stdout
    assert "spacerobot mass" in done.stdout if not command else f"spacerobot {command}" in done.stdout


def test_help_loads_the_standard_library_and_little_of_ours() -> None:
    """What keeps it at a twentieth of a second, however busy the machine is; benchmarks/startup.py measures that."""

    def loaded(code: str) -> set[str]:
        code = f"import sys\n{code}\nsys.stderr.write(' '.join(sys.modules))"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        return set(done.stderr.split())

    help_ = "from spacerobot.cli.main import main\ntry:\n    main(['mass', '--help'])\nexcept SystemExit:\n    pass"
    more = loaded(help_) - loaded("pass")
    others = {m for m in more if m.partition(".")[0] not in {*sys.stdlib_module_names, "spacerobot"}}
    assert not others
    assert len(more) < 120


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "the following arguments are required: COMMAND"),
        (["maas"], "did you mean 'mass'?"),
        (["mass"], "ROBOT"),
        (["mass", "pa10", "--diretion", "1", "0", "0"], "did you mean '--direction'?"),
        (["mass", "pa10", "--direc", "1", "0", "0"], "did you mean '--direction'?"),
        (["mass", "pa10", "--q"], "--q: expected at least one argument"),
        (["--json", "mass", "pa10"], "must follow it"),
        (["mass", "pa10", "panda"], "more arguments than the command takes; given: panda"),
        (["mass", "pa10", "--json=yes"], "--json: ignored explicit argument 'yes'"),
        (["study", "chek", "guide-friction"], "did you mean 'check'?"),
        (["study", "check", "guide-friction", "--dta", "x"], "unknown option; given: --dta"),
    ],
)
def test_a_mistyped_command_line_is_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""


@pytest.mark.parametrize("number", ["-1", "-1e-3", "-.5", "-1.e2", "-0.5,0,1"])
def test_a_list_may_begin_with_any_negative_number(number: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mass", "pa10", "--direction", number, "--q", "0"]) == 2
    assert "unknown option" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (FileNotFoundError(errno.ENOENT, "No such file or directory", "robot.urdf"), 2, "robot.urdf: No such file"),
        (PermissionError(errno.EACCES, "Permission denied", "out"), 2, "out: Permission denied"),
        (OSError(errno.ENOSPC, "No space left on device", "out/mass.json"), 1, "out/mass.json: No space left"),
        (MemoryError(), 1, "not enough memory"),
        (ZeroDivisionError("float division\nby zero"), 1, "please report it: ZeroDivisionError: float division by"),
    ],
)
def test_whatever_happens_is_one_line(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    error: BaseException,
    code: int,
    message: str,
) -> None:
    def fail(_: object) -> int:
        raise error

    monkeypatch.setattr(robots, "run", fail)
    assert main(["robots"]) == code
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.startswith("spacerobot robots: ")
    assert captured.err.count("\n") == 1


def test_the_traceback_is_there_for_who_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: object) -> int:
        raise ZeroDivisionError

    monkeypatch.setattr(mass, "run", fail)
    monkeypatch.setenv("SPACEROBOT_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["mass", "pa10"])


def test_a_reader_that_leaves_early_is_no_error() -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "spacerobot", "robots", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        said = process.stderr.read()
        assert process.wait(60) == 0
    assert said == b""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_disk_is_one_line() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "spacerobot", "study", "schema"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr == "spacerobot study: No space left on device\n"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_is_one_line(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    done = spacerobot("mass", "pa10", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert "Permission denied" in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_folder_that_is_a_file_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "out").write_text("a file")
    assert main(["mass", "pa10", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert main(["mass", "pa10", "--out", str(tmp_path / "out" / "below")]) == 2


def test_the_module_runs_too() -> None:
    done = spacerobot("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("spacerobot ")
