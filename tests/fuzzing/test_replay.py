"""Every fuzz target in short: its seeds, what was once a defect, and some hundred edits, each under watch."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fuzz.binary.kinds import KINDS
from fuzz.corpus import KEPT, inputs
from fuzz.page import RESULTS, faults, filled, mended
from fuzz.targets import TARGETS

ROOT = Path(__file__).resolve().parents[2]
CASES = {"scene": 10, "mesh": 20, "hdf5": 20, "mat": 20, "bag": 15, "urdf": 30}


QUICK = ("study", "csv", "urdf", "npz")
"""What strangers hand over most; all others are among the long tests."""


@pytest.mark.parametrize(
    "name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in (*TARGETS, *KINDS)]
)
def test_nothing_but_answers_and_input_errors(name: str) -> None:
    command = [sys.executable, "-m", "fuzz.replay", name, str(CASES.get(name, 50))]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["defects"] == []
    assert found["read"] > 0, "the seeds at least are good"
    assert found["refused"] > 0 or name == "mesh", "a damaged mesh is left out, not refused"
    assert found["slowest case [s]"] < 10


def test_every_kept_input_belongs_to_a_target() -> None:
    assert {folder.name for folder in KEPT.iterdir()} <= set(TARGETS)
    for target in TARGETS.values():
        assert all(len(data) <= 20_000 for data in inputs(target))


def test_the_page_says_what_the_results_say() -> None:
    text = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    found = json.loads(RESULTS.read_text())
    assert filled(text, found) == text, "python -m fuzz.page docs/trust.md"
    assert found["defects"] == 0
    assert found["most memory [MB]"] < 1000.0


def test_what_the_page_counts() -> None:
    found = "## What was found, and mended\n\nBy x:\n\n1. a;\n2. b\n   on.\n\nBy y:\n\n{}. c.\n\n## Else\n\n4. d\n"
    assert mended(found.format(3)) == 3
    with pytest.raises(ValueError, match="counted through"):
        mended(found.format(4))
    rows = "## Faults\n\n| what | x | y |\n|---|---|---|\n| a | 50 | 2 |\n| b | | 1 |\n\n## Else\n\n| c | 9 |\n"
    assert faults(rows) == 53


WATCHED = """
import os, socket, sys
from pathlib import Path
from fuzz.watch import Watch
from spacerobot.support.errors import InputError
watch = Watch(Path(sys.argv[1]))
def refuse(data): raise InputError("no")
def out(data): open("/etc/hostname").read()
def hidden(data):
    try: open(sys.argv[1] + "/../made", "w")
    except OSError: pass
    except Exception: pass
def net(data): socket.create_connection(("127.0.0.1", 9))
def shell(data): os.system("true")
def broken(data): return {}["x"]
def fine(data): open(sys.argv[1] + "/own", "w").write("x")
for case in (refuse, out, hidden, net, shell, broken, fine):
    print(case.__name__, *watch.case(case, b"")[:2])
"""


def test_the_watch_sees_what_no_reader_may_do(tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    done = subprocess.run(
        [sys.executable, "-B", "-c", WATCHED, str(own)], cwd=ROOT, capture_output=True, text=True, check=True
    )
    said = dict(line.split(" ", 1) for line in done.stdout.splitlines())
    assert said["refuse"].startswith("refused")
    assert said["fine"].startswith("read")
    assert "reads outside" in said["out"]
    assert "writes outside" in said["hidden"]
    assert "socket" in said["net"]
    assert "os.system" in said["shell"]
    assert "KeyError" in said["broken"]
    assert not (tmp_path / "made").exists()
