"""Channels that no single column is: sums of columns, lists in cells, body axes, offsets and windows of each trial."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

FACTORS = st.integers(1, 9999).map(lambda n: (-1) ** n * n / 100)


def read(folder: Path, channels: str, table: str, trial: str = "", top: str = "") -> list[Recording]:
    """The trials of a study with one stream."""
    (folder / "log.csv").write_text(table)
    text = f"""format = 1
[baseline]
base = "free"
body.mass = 1
{top}
[streams.log]
time = "t"
[streams.log.channels]
{channels}
[[trials]]
id = "{{n}}"
{trial or "each = [0, 0]"}
log = "log.csv"
"""
    (folder / "study.toml").write_text(text)
    study = load_study(folder)
    return [study.recording(t) for t in study.trials]


def columns(**values: np.ndarray) -> str:
    rows = np.column_stack(list(values.values()))
    return ",".join(values) + "\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows)


T = np.arange(0, 1, 0.05)
A, B = np.sin(3 * T), np.cos(5 * T)


@settings(max_examples=25, deadline=None)
@given(FACTORS, FACTORS, FACTORS)
def test_a_channel_is_the_sum_that_it_says(k: float, other: float, offset: float) -> None:
    line = f'a = {{ is = "body.yaw", unit = "deg", scale = {k!r}, offset = {offset!r}, plus = {{ b = {other!r} }} }}'
    with tempfile.TemporaryDirectory() as folder:
        (recording,) = read(Path(folder), line, columns(t=T, a=A, b=B))
    np.testing.assert_allclose(recording["body.yaw"].value, np.radians(k * A + other * B + offset), atol=1e-9)


def test_a_sum_lacks_a_reading_where_one_of_its_columns_does(tmp_path: Path) -> None:
    a = A.copy()
    a[3] = 1234.0
    line = 'b = { is = "body.position.x", plus = { a = 2.0 }, missing = 1234.0 }'
    (recording,) = read(tmp_path, line, columns(t=T, a=a, b=B))
    assert list(np.flatnonzero(~recording["body.position.x"].valid)) == [3]


@settings(max_examples=25, deadline=None)
@given(st.integers(-700, 700).map(lambda n: n / 100), st.integers(-700, 700).map(lambda n: n / 100))
def test_forces_along_the_body_turn_with_it(yaw: float, rate: float) -> None:
    lines = """a = { is = "body.force.x", frame = "body", use = "input" }
b = { is = "body.force.y", frame = "body", use = "input" }
yaw = { is = "body.yaw" }"""
    turn = yaw + rate * T
    with tempfile.TemporaryDirectory() as folder:
        (recording,) = read(Path(folder), lines, columns(t=T, a=A, b=B, yaw=turn))
    world = recording["body.force.x"].value + 1j * recording["body.force.y"].value
    np.testing.assert_allclose(world, (A + 1j * B) * np.exp(1j * turn), atol=1e-9)


def test_a_yaw_that_wraps_is_followed_through_a_gap(tmp_path: Path) -> None:
    """Between a reading just below half a turn and one just above, the body points backwards, not forwards."""
    lines = 'a = { is = "body.force.x", frame = "body", use = "input" }\nyaw = { is = "body.yaw" }'
    turn = np.pi + 0.5 * (T - T.mean())
    wrapped = np.angle(np.exp(1j * turn))
    wrapped[np.abs(turn - np.pi) < 0.1] = np.nan
    assert np.isnan(wrapped).any()
    (recording,) = read(tmp_path, lines, columns(t=T, a=A, yaw=wrapped))
    np.testing.assert_allclose(recording["body.force.x"].value, A * np.cos(turn), atol=1e-9)
    np.testing.assert_allclose(recording["body.force.y"].value, A * np.sin(turn), atol=1e-9)


def test_one_axis_of_the_body_pushes_along_both_of_the_world(tmp_path: Path) -> None:
    lines = 'a = { is = "body.force.x", frame = "body", use = "input" }\nyaw = { is = "body.yaw" }'
    (recording,) = read(tmp_path, lines, columns(t=T, a=A, yaw=0 * T + np.pi / 2))
    np.testing.assert_allclose(recording["body.force.x"].value, 0, atol=1e-12)
    np.testing.assert_allclose(recording["body.force.y"].value, A, atol=1e-12)
    assert recording["body.force.y"].use == "input"


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ('a = { is = "body.force.x", frame = "body" }', "no body.yaw"),
        ('a = { is = "body.position.x", frame = "body" }', "only a force"),
        ('a = { is = "body.position.x", frame = "bdy" }', "body"),
        ('a = { is = "body.position.x", plus = { c = 1.0 } }', "unknown column"),
        ('a = { is = "body.position.x", plus = { b = "x" } }', "must be a number"),
        ('a = { is = "body.position.x", plus = 3 }', "must be a table"),
    ],
)
def test_what_cannot_be_meant_is_refused(tmp_path: Path, line: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        read(tmp_path, line, columns(t=T, a=A, b=B))


def test_a_list_in_a_cell_is_as_many_columns(tmp_path: Path) -> None:
    on = np.random.default_rng(0).integers(0, 2, (len(T), 3))
    rows = "".join(
        f'{t!r},"[{u}, {v}, {w}]",{x!r}\n' for t, (u, v, w), x in zip(T.tolist(), on.tolist(), A.tolist(), strict=True)
    )
    line = '"command[0]" = { is = "body.force.x", scale = 0.5, use = "input", plus = { "command[2]" = -0.25 } }'
    (recording,) = read(tmp_path, line, "t,command,x\n" + rows)
    np.testing.assert_allclose(recording["body.force.x"].value, 0.5 * on[:, 0] - 0.25 * on[:, 2])


def test_an_offset_of_a_trial_is_added_to_the_channels_own(tmp_path: Path) -> None:
    line = 'a = { is = "body.position.x", unit = "mm", offset = 2.0 }'
    trial = 'each = [0, 0]\noffset."body.position.x" = 0.5'
    (recording,) = read(tmp_path, line, columns(t=T, a=A), trial)
    np.testing.assert_allclose(recording["body.position.x"].value, (A + 2.5) * 1e-3)
    with pytest.raises(InputError, match=r"unknown channel|no such"):
        read(tmp_path, line, columns(t=T, a=A), 'each = [0, 0]\noffset."body.position.y" = 0.5')


def test_each_steps_a_window_through_a_record(tmp_path: Path) -> None:
    line = 'a = { is = "body.position.x" }'
    trial = "each = [3, 7]\nwindow = [-0.01, 0.19]\nstep = 0.2"
    found = read(tmp_path, line, columns(t=T, a=A), trial)
    assert [r.trial.id for r in found] == ["3", "4", "5", "6", "7"]
    np.testing.assert_allclose(np.concatenate([r["body.position.x"].value for r in found]), A)
    for wrong in ("each = [0, 1]\nstep = 0.2", "window = [0, 1]\nstep = 0.2"):
        with pytest.raises(InputError, match="step"):
            read(tmp_path, line, columns(t=T, a=A), wrong)
