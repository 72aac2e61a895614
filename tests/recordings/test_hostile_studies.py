"""Study files made to hurt: every one is answered with an InputError, soon."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import pytest
from helpers_recordings import CSV, HEAD, STREAM, TRIAL, write_study
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

GOOD = HEAD + '[baseline.sigma]\n"wrist.mass" = 0.01\n' + STREAM + TRIAL
HOSTILE = {
    "deep dots": HEAD + "[baseline.joint." + "a." * 50_000 + "b]\nmass = 1\n",
    "deep lists": HEAD + "x = " + "[" * 50_000 + "]" * 50_000 + "\n",
    "blanks in a header": HEAD + "[" + " " * 200_000 + "\n",
    "long key": HEAD + "a" * 2_000_000 + " = 1\n",
    "too long": "#" * 5_000_000,
    "binary": bytes(range(256)) * 10,
    "utf-16": GOOD.encode("utf-16"),
    "many trials": HEAD + STREAM + '[[trials]]\neach = [0, 99999999]\nid = "{n}"\nmocap = "01.csv"\n',
    "path in id": HEAD + STREAM + TRIAL.replace('"01"', '"../../x"'),
    "script in id": HEAD + STREAM + TRIAL.replace('"01"', '"<script>alert(1)</script>"'),
    "huge index": HEAD + STREAM.replace('"t"', "99999999999999999999") + TRIAL,
}


@pytest.mark.parametrize("content", HOSTILE.values(), ids=HOSTILE.keys())
def test_hostile_study_is_refused_soon(tmp_path: Path, content: str | bytes) -> None:
    (tmp_path / "01.csv").write_text(CSV)
    (tmp_path / "study.toml").write_bytes(content.encode() if isinstance(content, str) else content)
    start = time.process_time()
    with pytest.raises(InputError) as caught:
        load_study(tmp_path).recordings()
    assert time.process_time() - start < 5
    assert len(str(caught.value)) < 2000


def test_columns_without_end_are_refused_soon(tmp_path: Path) -> None:
    start = time.process_time()
    with pytest.raises(InputError, match="too many columns"):
        load_study(write_study(tmp_path, csv=("1," * 400_000 + "1\n") * 5)).recordings()
    assert time.process_time() - start < 5


def test_endless_digits_are_refused_soon(tmp_path: Path) -> None:
    start = time.process_time()
    for cell in ("1" * 900_000 + "x", "0." + "1" * 900_000 + "x"):
        folder = write_study(tmp_path, csv=f"t,x\n0,2\n1,{cell}\n2,3\n3,4\n")
        with pytest.raises(InputError, match=r"01\.csv:3: column 1: longer than a number"):
            load_study(folder).recordings()
    assert time.process_time() - start < 5


tokens = st.sampled_from(
    ['"', "'", "[", "]", "[[", "{", "}", "=", "\n", ".", ",", "nan", "inf", "-1", "1e999", "true", '"x"', "[]", "{}",
     "wrist", "target.mass", "channels", "is", "0", "1979-05-27", "#", "\\u0000", "é", '"""', "unknown"]
)  # fmt: skip


@settings(
    max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(edits=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 12), tokens), min_size=1, max_size=4))
def test_mutated_studies_give_nothing_but_input_errors(tmp_path: Path, edits: list[tuple[float, int, str]]) -> None:
    text = GOOD
    for where, cut, new in edits:
        start = int(where * len(text))
        text = text[:start] + new + text[start + cut :]
    folder = write_study(tmp_path, text)
    with contextlib.suppress(InputError):
        study = load_study(folder)
        study.recordings()
        assert study.conditions()
        assert study.input_hash


LINES = GOOD.split("\n")
values = st.sampled_from(
    ["1", "-1", "0", "nan", "inf", "true", '"text"', '""', "[]", "[1]", "[1, 2, 3]", '["a"]', "{}", "{ a = 1 }", "[{}]",
     "1979-05-27", "1e308", "9" * 30, '"\\u0000"', '"../x"', '"unknown"', "[[1]]", '{ is = 3 }', '{ file = 3 }']
)  # fmt: skip


@settings(
    max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    line=st.integers(0, len(LINES) - 1),
    key=st.sampled_from(
        ["", "format", "title", "data", "pose", "pose_deg", "gravity", "law", "time_unit", "rate", "rows", "reshape",
         "missing", "clock", "kind", "separator", "header_rows", "window", "condition", "each", "sort", "encoding",
         "variable", "unit", "sigma", "wrist", "target", "joint", "contact", "compression", "decimal", "time_offset"]
    ),
    value=values,
)  # fmt: skip
def test_any_value_of_any_key_gives_nothing_but_input_errors(tmp_path: Path, line: int, key: str, value: str) -> None:
    name = key or LINES[line].split("=")[0].strip()
    lines = [*LINES[:line], f"{name} = {value}", *LINES[line + (not key) :]]
    folder = write_study(tmp_path, "\n".join(lines))
    with contextlib.suppress(InputError):
        load_study(folder).recordings()
