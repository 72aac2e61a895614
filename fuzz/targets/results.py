"""What a run leaves behind, read again: its marker, what it had saved, its verdict."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from fuzz.targets.archives import packed
from spacerobot.diagnosis.answer.schema import schema, validate
from spacerobot.support.errors import InputError
from spacerobot.support.runs import MARKER, RunFolder

_OVERALL = ("rms_before", "rms_after", "noise_floor", "chi2_before", "chi2_after")
_VERDICT = {
    "format": 1, "spacerobot": "0.1.0", "input_hash": "0" * 64, "seed": 0, "study": "s", "seconds": 1.0,
    "verdict": "nothing_missing", "confidence": 0.9, "effects": [], "alternatives": [], "parameters": {}, "located": [],
    "held_out": {"scheme": "x", "channels": {}, "overall": dict.fromkeys(_OVERALL, 1.0)},
    "detectable": [], "next_experiment": None,
}  # fmt: skip
_MARKER = {"state": "finished", "command": "diagnose", "input_hash": "a", "version": "0.1.0", "outputs": {"a.txt": 2}}


def _prepare(folder: Path) -> Callable[[bytes], None]:
    run = folder / "run"
    run.mkdir()
    (folder / "precious").write_text("not the run's")
    with RunFolder(run, "diagnose", "a") as first:
        first.save("kept", 1)
        first.save_arrays("kept", {})
    (saved,), (arrays,) = run.glob("partial/*.json"), run.glob("partial/*.npz")

    def read(data: bytes) -> None:
        kind, rest = (data[0] if data else 0) % 4, data[1:]
        if kind == 0:
            (run / MARKER).write_bytes(rest)
            try:
                with RunFolder(run, "diagnose", "a", overwrite=rest[:1] == b" ") as again:
                    again.load("kept")
            finally:
                assert (folder / "precious").exists()
                (run / "a.txt").write_text("12")
        elif kind == 3:
            verdict = _object(rest)
            if verdict is not None:
                validate(verdict)
        else:
            (run / MARKER).unlink(missing_ok=True)
            for part in run.rglob("*"):
                if part.is_file() and part not in (saved, arrays):
                    part.unlink()
            (run / MARKER).write_text(json.dumps({**_MARKER, "state": "running"}))
            saved.parent.mkdir(exist_ok=True)
            saved.write_bytes(rest)
            arrays.write_bytes(packed(rest))
            with RunFolder(run, "diagnose", "a") as again:
                again.load("kept")
                again.load_arrays("kept")

    return read


def _object(data: bytes) -> dict | None:
    try:
        found = json.loads(data)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        raise InputError("not an object")
    return found


TARGET = Target(
    "results",
    _prepare,
    (
        b"\0" + json.dumps(_MARKER).encode(),
        b"\1" + json.dumps({"name": "kept", "value": 1}).encode(),
        b"\3" + json.dumps(_VERDICT).encode(),
    ),
    (
        *(f'"{key}"' for key in (*schema()["properties"], *_MARKER)),
        '"../precious"',
        "/etc/passwd",
        "null",
        "NaN",
        "[[",
        "-1",
    ),
    cases=100_000,
)
