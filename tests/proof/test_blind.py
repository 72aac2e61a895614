"""The blind process: what it is given, and what becomes of its answers."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import pytest

from spacerobot.proof.blind import diagnose
from spacerobot.proof.orders import Order
from spacerobot.proof.record import play
from tests.processes import gone, written

SPY = """
import json, os, sys
tree = [os.path.join(d, f) for d, _, files in os.walk(".") for f in files]
study = sys.argv[1]
print(json.dumps({"verdict": "unknown", "confidence": 0.5, "effects": [], "alternatives": [], "parameters": {},
    "argv": sys.argv[1:], "cwd": os.getcwd(), "tree": tree, "env": dict(os.environ),
    "study": sorted(os.listdir(study)), "beside": sorted(os.listdir(os.path.dirname(study)))}))
"""


LIMIT = 10.0
"""Seconds for a stand-in that never ends: enough to begin, whatever else the machine does."""


def script(folder: Path, text: str) -> Sequence[str]:
    path = folder / "stand_in.py"
    path.write_text(text)
    return (sys.executable, str(path))


def test_the_process_sees_the_study_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = tmp_path / "scratch" / "abc"
    study.mkdir(parents=True)
    (study / "study.toml").write_text("format = 1")
    monkeypatch.setenv("SPACEROBOT_DATA", "/somewhere")
    answer = diagnose(study, without="tether", command=script(tmp_path, SPY))
    assert answer.verdict is not None
    seen = answer.verdict
    assert seen["argv"][0] == str(study)
    assert "--json" in seen["argv"]
    assert seen["argv"][-2:] == ["--without", "tether"]
    assert seen["tree"] == []
    assert Path(seen["cwd"]).resolve() not in (tmp_path, study, Path.cwd())
    assert not any(k.startswith("SPACEROBOT_") for k in seen["env"])
    assert seen["study"] == ["study.toml"]


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary folder of the test's own, for this process and those that it begins."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_the_seal_is_out_of_reach_and_the_name_says_nothing(
    tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.setattr(
        "spacerobot.proof.record._compared", lambda study, *rest: {"same": False, "equal": False, "study": study.name}
    )
    spy = tmp_path / "seen.json"
    text = SPY + f"\nopen({str(spy)!r}, 'w').write(repr((sys.argv, os.getcwd(), dict(os.environ))))\n"
    order = Order("nothing_missing", "rig", 0, seed=3)
    record = play(order, tmp_path / "scratch", command=script(tmp_path, text))
    seen = spy.read_text()
    assert record["said"] == "unknown"
    assert record["expected"] == "nothing_missing"
    assert not record["top"]
    for word in ("nothing_missing", "rig-0", "truth"):
        assert word not in seen
    assert not list((tmp_path / "scratch").rglob("*"))
    assert not list(temporary.iterdir()), "neither study nor working folder is left lying about"


SEARCH = """
import json, os, sys, tempfile
held = []
for top in (tempfile.gettempdir(), os.path.dirname(sys.argv[1])):
    for folder, _, files in os.walk(top):
        for name in files:
            with open(os.path.join(folder, name), errors="replace") as stream:
                if "rig_as_built" in stream.read() or "truth" in name:
                    held.append(name)
print(json.dumps({"verdict": "unknown", "confidence": 0.5, "effects": [], "alternatives": [], "parameters": held}))
"""


def test_the_seal_is_on_no_disk_while_the_diagnosis_runs(
    tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who searches the temporary folder and all that lies beside the study finds nothing that tells."""
    pytest.importorskip("mujoco")
    monkeypatch.setattr(
        "spacerobot.proof.record._compared", lambda study, *rest: {"same": False, "equal": False, "found": rest[-1]}
    )
    order = Order("nothing_missing", "rig", 0, seed=3)
    record = play(order, temporary / "proof", command=script(tmp_path, SEARCH))
    assert record["said"] == "unknown", record["error"]
    assert record["found"]["parameters"] == []


KILLED = """
import os, signal, sys
count = int(open({count!r}).read()) + 1
open({count!r}, "w").write(str(count))
if count <= {times}:
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize(("times", "tries"), [(1, 2), (2, 2), (9, 2)])
def test_a_diagnosis_killed_for_want_of_memory_is_tried_once_more(tmp_path: Path, times: int, tries: int) -> None:
    count = tmp_path / "count"
    count.write_text("0")
    answer = diagnose(tmp_path, command=script(tmp_path, KILLED.format(count=str(count), times=times) + SPY))
    assert count.read_text() == str(tries)
    if times < tries:
        assert answer.verdict is not None
        assert answer.error == ""
    else:
        assert answer.verdict is None
        assert "killed 2 times" in answer.error
        assert "memory" in answer.error


def test_one_that_is_killed_again_and_again_is_scored_as_failed(
    tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.setattr("spacerobot.proof.record._compared", lambda *given: {"same": False, "equal": False})
    words = "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"
    record = play(Order("nothing_missing", "rig", 0, seed=3), temporary, command=script(tmp_path, words))
    assert record["said"] == "failed"
    assert record["abstained"]
    assert not record["confidently_wrong"]
    assert "memory" in record["error"]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("import sys; sys.stderr.write('broken'); sys.exit(3)", "exit 3: broken"),
        ("print('hello')", "no verdict"),
        ("print('[1, 2]')", "no verdict"),
    ],
)
def test_no_answer_is_told(tmp_path: Path, text: str, error: str) -> None:
    answer = diagnose(tmp_path, command=script(tmp_path, text))
    assert answer.verdict is None
    assert error in answer.error


@pytest.mark.slow
def test_an_endless_diagnosis_is_ended_with_its_children(tmp_path: Path) -> None:
    text = (
        "import subprocess, sys, time\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        f"open({str(tmp_path / 'pid')!r}, 'w').write(str(child.pid))\n"
        "time.sleep(60)\n"
    )
    answer = diagnose(tmp_path, command=script(tmp_path, text), limit=LIMIT)
    assert answer.verdict is None
    assert f"{LIMIT:.0f} s" in answer.error
    assert gone({int((tmp_path / "pid").read_text())}, 20.0), "the child would sleep for 60 s"


def test_answers_are_read_whole(tmp_path: Path) -> None:
    answer = diagnose(tmp_path, command=script(tmp_path, SPY))
    assert answer.verdict is not None
    assert json.dumps(answer.verdict)
    assert answer.seconds > 0.0


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="reads /proc")
def test_a_diagnosis_ends_with_the_proof_that_was_killed(tmp_path: Path) -> None:
    command = script(
        tmp_path, f"import os, time\nopen({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()))\ntime.sleep(60)\n"
    )
    words = (
        "from pathlib import Path; from spacerobot.proof.blind import diagnose; "
        f"diagnose(Path({str(tmp_path)!r}), command={list(command)!r})"
    )
    proof = subprocess.Popen([sys.executable, "-c", words])
    diagnosis = int(written(tmp_path / "pid"))
    proof.kill()
    proof.wait()
    assert gone({diagnosis}, 40.0), "it works on for nobody, who would sleep for 60 s"
