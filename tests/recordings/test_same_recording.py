"""The same recording, written down in another way, is the same recording: units, clocks, zeroes, order, formats."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import load_study
from tests.recordings.helpers_recordings import HEAD

TIME = np.round(np.arange(0.0, 2.0, 0.05), 10)
X = 0.02 * np.sin(2.0 * TIME) - 0.01 * TIME
YAW = 1.9 * TIME**2  # passes a turn
FORCE = np.round(3.0 * np.exp(-((TIME - 1.0) ** 2) / 0.02), 9)


def written(
    folder: Path,
    time: np.ndarray,
    columns: dict[str, np.ndarray],
    *,
    stream: str = "",
    channels: str = 'x = { is = "target.x", sigma = 1e-4 }\nyaw = { is = "target.yaw", sigma = 1e-3 }',
    trial: str = "",
    times: str = "t",
) -> Recording:
    """The recording of one stream, as a study reads it."""
    folder.mkdir(exist_ok=True)
    rows = zip(time, *columns.values(), strict=True)
    lines = [f"{times},{','.join(columns)}", *(",".join(repr(float(v)) for v in row) for row in rows)]
    (folder / "01.csv").write_text("\n".join(lines) + "\n")
    text = f'{HEAD}\n[streams.s]\ntime = "{times}"\n{stream}\n[streams.s.channels]\n{channels}\n'
    (folder / "study.toml").write_text(f'{text}\n[[trials]]\nid = "01"\ntarget.mass = 9.0\ns = "01.csv"\n{trial}\n')
    return load_study(folder).recording("01")


def same(one: Recording, other: Recording, shift: float = 0.0) -> None:
    for name in ("target.x", "target.yaw"):
        a, b = one[name], other[name]
        np.testing.assert_allclose(b.time, a.time + shift, atol=1e-6)
        np.testing.assert_allclose(b.value, a.value, atol=1e-12)
        np.testing.assert_array_equal(b.valid, a.valid)
        assert b.sigma == pytest.approx(a.sigma, rel=1e-12)
        assert b.unit == a.unit


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return written(tmp_path_factory.mktemp("usual"), TIME, {"x": X, "yaw": YAW})


@pytest.mark.parametrize(("unit", "seconds"), [("ms", 1e-3), ("us", 1e-6), ("min", 60.0), ("h", 3600.0)])
@pytest.mark.parametrize("offset", [0.0, 0.7, -0.3])
def test_a_clock_in_another_unit(tmp_path: Path, usual: Recording, unit: str, seconds: float, offset: float) -> None:
    """The offset of a stream's clock is in seconds, whatever unit the clock counts in."""
    found = written(
        tmp_path / "a", (TIME - offset) / seconds, {"x": X, "yaw": YAW},
        stream=f'time_unit = "{unit}"\ntime_offset = {offset}',
    )  # fmt: skip
    same(usual, found)


@pytest.mark.parametrize(("unit", "metres"), [("mm", 1e-3), ("in", 0.0254), ("cm", 1e-2)])
@pytest.mark.parametrize(("scale", "zero"), [(1.0, 0.0), (-2.0, 0.0), (0.5, 7.0), (-4.0, -30.0)])
def test_a_length_in_another_unit_from_another_zero(
    tmp_path: Path, usual: Recording, unit: str, metres: float, scale: float, zero: float
) -> None:
    """SI = unit (scale raw + offset): the raw count is what gives that."""
    channels = (
        f'x = {{ is = "target.x", sigma = {1e-4 / metres!r}, unit = "{unit}", scale = {scale}, offset = {zero} }}\n'
        f'yaw = {{ is = "target.yaw", sigma = {math.degrees(1e-3)!r}, unit = "deg" }}'
    )
    raw = (X / metres - zero) / scale
    same(usual, written(tmp_path / "a", TIME, {"x": raw, "yaw": np.degrees(YAW)}, channels=channels))


@pytest.mark.parametrize("unit", ["rad", "deg"])
@pytest.mark.parametrize("wrap", [-math.pi, 0.0])
def test_an_angle_that_is_written_within_a_turn(tmp_path: Path, usual: Recording, unit: str, wrap: float) -> None:
    wrapped = (YAW - wrap) % (2.0 * math.pi) + wrap
    assert np.abs(np.diff(wrapped)).max() > 5.5
    channels = (
        'x = { is = "target.x", sigma = 1e-4 }\n'
        f'yaw = {{ is = "target.yaw", sigma = {1e-3 if unit == "rad" else math.degrees(1e-3)!r}, unit = "{unit}", '
        "unwrap = true }"
    )
    raw = wrapped if unit == "rad" else np.degrees(wrapped)
    same(usual, written(tmp_path / "a", TIME, {"x": X, "yaw": raw}, channels=channels))


@pytest.mark.parametrize("epoch", [1_700_000_000.0, 1_000_000_000.0])
def test_times_that_count_from_an_epoch(tmp_path: Path, usual: Recording, epoch: float) -> None:
    same(usual, written(tmp_path / "a", TIME + epoch, {"x": X, "yaw": YAW}))


def test_rows_in_disorder_repeated_or_behind_remarks(tmp_path: Path, usual: Recording) -> None:
    order = np.random.default_rng(0).permutation(TIME.size)
    mixed = {"x": X[order], "yaw": YAW[order]}
    same(usual, written(tmp_path / "a", TIME[order], mixed, stream="sort = true"))
    twice = np.repeat(np.arange(TIME.size), 2)
    same(usual, written(tmp_path / "b", TIME[twice], {"x": X[twice], "yaw": YAW[twice]}))
    both = np.sort(np.concatenate([np.arange(TIME.size), np.arange(0, TIME.size, 3)]))
    stale = {"x": X[both], "yaw": YAW[both]}
    same(usual, written(tmp_path / "c", TIME[both], stale, stream='repeated = "drop"'))
    shuffled = np.concatenate([twice[1::2], twice[::2]])
    again = {"x": X[shuffled], "yaw": YAW[shuffled]}
    same(usual, written(tmp_path / "d", TIME[shuffled], again, stream="sort = true"))


def test_a_rate_counts_from_the_first_row_on(tmp_path: Path, usual: Recording) -> None:
    """20 readings a second from 0 s are the times of the file, and those of a stream that begins later are later."""
    for offset in (0.0, 1.5):
        (tmp_path / "study.toml").write_text(
            f"{HEAD}\n[streams.s]\nrate = 20\ntime_offset = {offset}\n[streams.s.channels]\n"
            'x = { is = "target.x", sigma = 1e-4 }\nyaw = { is = "target.yaw", sigma = 1e-3 }\n'
            '[[trials]]\nid = "01"\ntarget.mass = 9.0\ns = "01.csv"\n'
        )
        (tmp_path / "01.csv").write_text(
            "x,yaw\n" + "".join(f"{x!r},{y!r}\n" for x, y in zip(X.tolist(), YAW.tolist()))
        )
        same(usual, load_study(tmp_path).recording("01"), shift=offset)


@pytest.mark.parametrize(("first", "last"), [(0.5, 1.5), (0.0, 0.05), (0.52, 0.98), (1.95, 9.0)])
def test_a_window_keeps_its_ends(tmp_path: Path, usual: Recording, first: float, last: float) -> None:
    """Both ends belong to it, in the trial's own seconds."""
    found = written(tmp_path / "a", TIME, {"x": X, "yaw": YAW}, trial=f"window = [{first}, {last}]")["target.x"]
    inside = (first <= TIME) & (last >= TIME)
    np.testing.assert_array_equal(found.time, TIME[inside])
    np.testing.assert_array_equal(found.value, X[inside])


def test_missing_readings_are_no_readings_whatever_they_are_called(tmp_path: Path) -> None:
    """A mark of a missing reading is of the raw number, before scale and unit."""
    gone = np.arange(TIME.size) % 4 == 1
    channels = 'x = { is = "target.x", sigma = 0.1, unit = "mm", offset = 500, missing = [-999, 123456] }\n'
    raw = np.where(gone, np.where(np.arange(TIME.size) % 8 == 1, -999.0, 123456.0), 1e3 * X - 500.0)
    found = written(tmp_path / "a", TIME, {"x": raw}, channels=channels)["target.x"]
    np.testing.assert_array_equal(found.valid, ~gone)
    np.testing.assert_allclose(found.value[~gone], X[~gone], atol=1e-12)
    assert np.isnan(found.value[gone]).all()


@pytest.mark.parametrize("late", [0.0, 3.4])
def test_streams_of_one_clock_stay_apart_by_what_their_files_say(tmp_path: Path, late: float) -> None:
    """The seconds that are taken off an epoch are the same for all of them, those of the earliest; each other's own."""
    epoch = 1_700_000_000.0
    for name, start in (("a", epoch + late), ("b", epoch)):
        rows = "".join(f"{start + t!r},{x!r}\n" for t, x in zip(TIME.tolist(), X.tolist()))
        (tmp_path / f"{name}.csv").write_text("t,x\n" + rows)
    streams = "".join(
        f'[streams.{n}]\ntime = "t"\n[streams.{n}.channels]\nx = {{ is = "{c}", sigma = 1e-4 }}\n'
        for n, c in (("a", "target.x"), ("b", "wrist.x"))
    )
    trial = '[[trials]]\nid = "01"\ntarget.mass = 9.0\na = "a.csv"\nb = "b.csv"\n'
    (tmp_path / "study.toml").write_text(f"{HEAD}\n{streams}{trial}")
    found = load_study(tmp_path).recording("01")
    assert found["target.x"].time[0] - found["wrist.x"].time[0] == pytest.approx(late, abs=1e-6)
    assert found["wrist.x"].time[0] == pytest.approx(0.0, abs=1e-6)


def test_times_of_a_file_of_their_own_are_cut_with_the_readings(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "x.csv", X, header="x", comments="")
    np.savetxt(tmp_path / "t.csv", TIME, header="t", comments="")
    (tmp_path / "study.toml").write_text(
        f'{HEAD}\n[streams.s]\ntime = "t"\n[streams.s.channels]\nx = {{ is = "target.x", sigma = 1e-4 }}\n'
        '[[trials]]\nid = "01"\ntarget.mass = 9.0\ns = { file = "x.csv", time_file = "t.csv", rows = [5, 20] }\n'
    )
    found = load_study(tmp_path).recording("01")["target.x"]
    np.testing.assert_allclose(found.time, TIME[5:20])
    np.testing.assert_allclose(found.value, X[5:20])


def test_what_a_trial_says_of_its_file_goes_before_what_the_stream_says(tmp_path: Path) -> None:
    np.savez(tmp_path / "01.npz", one=np.column_stack([TIME, X]), two=np.column_stack([TIME, -X]))
    text = (
        f'{HEAD}\n[streams.s]\ntime = "0"\nvariable = "one"\nrows = [0, 10]\n'
        '[streams.s.channels]\n1 = { is = "target.x", sigma = 1e-4 }\n'
    )
    for own, sign, rows in (
        ("", 1.0, slice(0, 10)),
        (', variable = "two"', -1.0, slice(0, 10)),
        (", rows = [5, 30]", 1.0, slice(5, 30)),
    ):
        trial = f'[[trials]]\nid = "01"\ntarget.mass = 9.0\ns = {{ file = "01.npz"{own} }}\n'
        (tmp_path / "study.toml").write_text(text + trial)
        found = load_study(tmp_path).recording("01")["target.x"]
        np.testing.assert_allclose(found.time, TIME[rows])
        np.testing.assert_allclose(found.value, sign * X[rows])


def test_a_clock_always_moves_on_where_repeats_are_dropped(tmp_path: Path) -> None:
    """Of rows at one time the first counts, whether the others repeat its readings or not."""
    time = np.repeat(TIME, 2)
    x = np.repeat(X, 2)
    x[1::4] += 0.5
    found = written(tmp_path / "a", time, {"x": x, "yaw": np.repeat(YAW, 2)}, stream='repeated = "drop"')["target.x"]
    assert (np.diff(found.time) > 0.0).all()
    np.testing.assert_array_equal(found.time, TIME)
    np.testing.assert_array_equal(found.value, X)


@pytest.mark.parametrize(("lost", "told"), [(2, False), (3, True), (20, True)])
def test_a_gap_is_told_from_three_lost_rows_on(tmp_path: Path, lost: int, told: bool) -> None:
    kept = np.r_[:10, 10 + lost : TIME.size]
    found = written(tmp_path / "a", TIME[kept], {"x": X[kept], "yaw": YAW[kept]})
    assert any("1 gaps" in note for note in found.notes) == told


def study_of(folder: Path, files: dict[str, str]) -> str:
    """The input hash of a study of two trials and a file of times."""
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    (folder / "study.toml").write_text(
        f'{HEAD}\n[streams.s]\ntime = "t"\n[streams.s.channels]\nx = {{ is = "target.x", sigma = 1e-4 }}\n'
        '[[trials]]\nid = "01"\ntarget.mass = 9.0\ns = { file = "a.csv", time_file = "t.csv" }\n'
        '[[trials]]\nid = "02"\ntarget.mass = 9.0\ns = { file = "b.csv", time_file = "t.csv" }\n'
    )
    return load_study(folder).input_hash


def test_every_byte_of_the_input_counts_in_its_own_file(tmp_path: Path) -> None:
    usual = {"a.csv": "x\n1\n2\n3\n", "b.csv": "x\n4\n5\n6\n", "t.csv": "t\n0\n1\n2\n"}
    others = [
        {**usual, "t.csv": "t\n0\n1\n3\n"},
        {**usual, "a.csv": usual["b.csv"], "b.csv": usual["a.csv"]},
        {**usual, "a.csv": "x\n1\n2\n", "b.csv": "3\n" + usual["b.csv"]},
    ]
    hashes = {study_of(tmp_path / str(k), files) for k, files in enumerate([usual, *others])}
    assert len(hashes) == 4
    assert study_of(tmp_path / "again", usual) in hashes


@pytest.mark.parametrize("step", [0.4, 1.7, 3.0, -2.9])
def test_a_fast_turn_is_followed_up_to_half_a_turn_a_reading(tmp_path: Path, step: float) -> None:
    turned = step * np.arange(TIME.size)
    wrapped = (turned + math.pi) % (2.0 * math.pi) - math.pi
    channels = 'x = { is = "target.x", sigma = 1e-4 }\nyaw = { is = "target.yaw", sigma = 1e-3, unwrap = true }'
    found = written(tmp_path / "a", TIME, {"x": X, "yaw": wrapped}, channels=channels)["target.yaw"]
    np.testing.assert_allclose(found.value, turned, atol=1e-9)
