"""From files to series: SI, clocks, drop-outs, repeats, epochs, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_recordings import HEAD, STREAM, TRIAL, write_study
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError, NotFoundError

CHANNEL = 'x = { is = "target.x", sigma = 1e-4 }'


def load(tmp_path: Path, csv: str, stream: str = "", channel: str = CHANNEL, trial: str = "") -> Recording:
    text = HEAD + STREAM.replace("[streams.mocap.ch", f"{stream}\n[streams.mocap.ch").replace(CHANNEL, channel)
    return load_study(write_study(tmp_path, text + TRIAL + trial, csv)).recording("01")


def test_units_scale_and_offset(tmp_path: Path) -> None:
    channel = 'x = { is = "target.x", sigma = 0.2, unit = "mm", scale = -2, offset = 3 }'
    series = load(tmp_path, "t,x\n0,1\n100,2\n", 'time_unit = "ms"', channel)["target.x"]
    np.testing.assert_allclose(series.time, [0, 0.1])
    np.testing.assert_allclose(series.value, [1e-3, -1e-3])
    assert (series.sigma, series.sigma_stated, series.unit, series.use) == (2e-4, True, "m", "output")
    assert series.rate == pytest.approx(10)


def test_one_column_may_be_two_channels(tmp_path: Path) -> None:
    channel = 'x = [{ is = "target.x" }, { is = "hand.x", scale = -1 }]'
    recording = load(tmp_path, "t,x\n0,1\n1,2\n", channel=channel)
    np.testing.assert_array_equal(recording["hand.x"].value, -recording["target.x"].value)


def test_drop_outs_are_no_readings(tmp_path: Path) -> None:
    channel = 'x = { is = "target.x", offset = 5 }'
    series = load(tmp_path, "t,x\n0,1\n1,0.0\n2,\n3,4\n", "missing = 0.0", channel)["target.x"]
    assert list(series.valid) == [True, False, False, True]
    np.testing.assert_array_equal(series.value, [6, np.nan, np.nan, 9])
    np.testing.assert_array_equal(series.good()[0], [0, 3])


def test_repeated_rows_are_left_out(tmp_path: Path) -> None:
    recording = load(tmp_path, "t,x\n0,1\n0,1\n1,2\n1,2\n2,2\n")
    np.testing.assert_array_equal(recording["target.x"].time, [0, 1, 2])
    assert "2 of 5 rows repeat" in recording.notes[0]


def test_stale_readings_are_left_out_on_request(tmp_path: Path) -> None:
    csv = "t,x\n0,1\n1,1\n2,2\n3,2\n4,3\n"
    assert len(load(tmp_path, csv)["target.x"]) == 5
    assert list(load(tmp_path, csv, 'repeated = "drop"')["target.x"].time) == [0, 2, 4]


def test_time_backwards_is_refused_unless_sorted(tmp_path: Path) -> None:
    csv = "t,x\n0,1\n2,3\n1,2\n3,4\n"
    with pytest.raises(InputError, match=r"01\.csv:4: time runs backwards; given: 1 after 2"):
        load(tmp_path, csv)
    np.testing.assert_array_equal(load(tmp_path, csv, "sort = true")["target.x"].value, [1, 2, 3, 4])


@pytest.mark.parametrize(
    ("csv", "message"),
    [
        ("t,x\n0,1\n0,2\n1,3\n", r":3: time stands still"),
        ("t,x\n0,1\n,2\n1,3\n", r":3: the row has no time"),
        ("t,x\n" + "".join(f"{i},{'nan' if i else 1}\n" for i in range(100)), r":2: target\.x is missing nearly"),
        ("t,x\n0,nan\n1,nan\n", r"target\.x has no reading at all"),
        ("t,y\n0,1\n1,2\n", r"study\.toml:16: unknown column of 01\.csv; given: x"),
        ("t,x,x\n0,1,2\n1,2,3\n", r"study\.toml:16: 2 columns have the same name"),
    ],
)
def test_refused(tmp_path: Path, csv: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(tmp_path, csv)


def test_epoch_seconds_start_near_zero_and_streams_keep_their_distance(tmp_path: Path) -> None:
    (tmp_path / "f.csv").write_text("t,f\n1700000000.75,1\n1700000001.75,2\n")
    text = HEAD + STREAM + STREAM.replace("mocap", "force").replace(CHANNEL, 'f = { is = "contact.force" }')
    csv = "t,x\n1700000000.25,1\n1700000001.25,2\n"
    recording = load_study(write_study(tmp_path, text + TRIAL + 'force = "f.csv"\n', csv)).recording("01")
    np.testing.assert_array_equal(recording["target.x"].time, [0.25, 1.25])
    np.testing.assert_array_equal(recording["contact.force"].time, [0.75, 1.75])
    assert recording.epoch == {"shared": 1_700_000_000.0}
    assert "epoch" in recording.notes[0]


def test_clocks(tmp_path: Path) -> None:
    series = load(tmp_path, "t,x\n0,1\n1,2\n", 'clock = "own"\ntime_offset = 10')["target.x"]
    assert series.clock == "own:mocap"
    np.testing.assert_array_equal(series.time, [10, 11])


def test_rate_instead_of_times(tmp_path: Path) -> None:
    text = HEAD + STREAM.replace('time = "t"', "rate = 50.0") + TRIAL
    series = load_study(write_study(tmp_path, text, "x\n1\n2\n3\n")).recording("01")["target.x"]
    np.testing.assert_allclose(series.time, [0, 0.02, 0.04])


def test_times_from_a_file_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "t.txt").write_text("0\n0.5\n")
    text = HEAD + STREAM.replace('time = "t"', "time = 0\nreshape = 2").replace("x =", "1 =")
    trial = TRIAL.replace('"01.csv"', '{ file = "q.txt", time_file = "t.txt" }')
    series = load_study(write_study(tmp_path, text + trial, "1\n2\n3\n4\n", "q.txt")).recording("01")["target.x"]
    np.testing.assert_array_equal(series.time, [0, 0.5])
    np.testing.assert_array_equal(series.value, [2, 4])
    (tmp_path / "t.txt").write_text("0\n0.5\n1\n")
    with pytest.raises(InputError, match="differ in number"):
        load_study(tmp_path).recording("01")


def test_window_and_rows(tmp_path: Path) -> None:
    csv = "t,x\n" + "".join(f"{i},{i}\n" for i in range(10))
    assert list(load(tmp_path, csv, trial="window = [2.5, 5]\n")["target.x"].value) == [3, 4, 5]
    assert list(load(tmp_path, csv, "rows = [1, 3]")["target.x"].value) == [1, 2]
    with pytest.raises(InputError, match=r"study\.toml:18: the trial's window holds no sample"):
        load(tmp_path, csv, trial="window = [20, 30]\n")


def test_angles_are_unwrapped_across_drop_outs(tmp_path: Path) -> None:
    channel = 'x = { is = "target.yaw", unit = "deg", unwrap = true, missing = 999 }'
    value = load(tmp_path, "t,x\n0,170\n1,999\n2,-170\n3,-150\n", channel=channel)["target.yaw"].value
    np.testing.assert_allclose(np.rad2deg(value), [170, np.nan, 190, 210])


def test_events_before_and_after(tmp_path: Path) -> None:
    text = (
        HEAD
        + """[streams.impacts]
kind = "events"
[streams.impacts.channels]
0 = { is = "body.velocity.y", moment = "before" }
1 = { is = "body.velocity.y", moment = "after" }
2 = { is = "aux.side" }
[[trials]]
id = 1
impacts = "01.csv"
"""
    )
    recording = load_study(write_study(tmp_path, text, "-1,0.5,1\n-2,1.1,0\n")).recording("1")
    assert list(recording) == ["body.velocity.y.before", "body.velocity.y.after", "aux.side"]
    np.testing.assert_array_equal(recording["body.velocity.y.after"].value, [0.5, 1.1])


def test_two_streams_do_not_give_one_channel(tmp_path: Path) -> None:
    text = HEAD + STREAM + STREAM.replace("mocap", "radar") + TRIAL + 'radar = "01.csv"\n'
    with pytest.raises(InputError, match=r"two streams both give target\.x; given: mocap, radar"):
        load_study(write_study(tmp_path, text)).recording("01")


def test_recordings_are_read_once_and_name_their_channels(tmp_path: Path) -> None:
    study = load_study(write_study(tmp_path))
    assert study.recording("01") is study.recordings()["01"]
    assert "target.x" in study.recording("01")
    assert "wrist.x" not in study.recording("01")
    with pytest.raises(NotFoundError, match=r"did you mean 'target\.x'"):
        study.recording("01")["target.z"]


def test_noise_is_estimated_within_a_tenth() -> None:
    random = np.random.default_rng(3)
    t = np.linspace(0, 3, 3000)
    for sigma in (1e-4, 0.2):
        signal = np.sin(3 * t) + 5 * (t > 1.5) + sigma * random.standard_normal(t.size)
        assert estimate_noise(signal) == pytest.approx(sigma, rel=0.1)
    assert estimate_noise(t**2) < 1e-10
    assert np.isnan(estimate_noise(t[:5]))


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    values=st.lists(st.one_of(st.none(), st.floats(-1e6, 1e6)), min_size=3, max_size=30).filter(
        lambda v: any(x is not None for x in v)
    ),
    scale=st.floats(1e-3, 1e3),
)
def test_values_come_back_scaled_and_in_place(tmp_path: Path, values: list[float | None], scale: float) -> None:
    rows = [f"{0.1 * i!r},{'' if v is None else repr(v)}" for i, v in enumerate(values)]
    channel = f'x = {{ is = "target.x", scale = {scale!r}, unit = "cm" }}'
    try:
        series = load(tmp_path, "t,x\n" + "\n".join(rows) + "\n", channel=channel)["target.x"]
    except InputError as error:  # mostly drop-outs, or denormal numbers
        assert "missing nearly" in str(error) or "no sensor" in str(error)  # noqa: PT017
        return
    expected = np.array([np.nan if v is None else v * scale * 0.01 for v in values])
    np.testing.assert_allclose(series.value, expected, rtol=1e-14)
    np.testing.assert_array_equal(series.valid, np.isfinite(expected))


def test_rows_are_chosen_of_the_times_in_their_own_file_too(tmp_path: Path) -> None:
    text = (
        HEAD
        + STREAM.replace('time = "t"', 'time = "t"\nrows = [1, 4]')
        + TRIAL.replace('mocap = "01.csv"', 'mocap = { file = "01.csv", time_file = "clock.csv" }')
    )
    write_study(tmp_path, text, "x\n1\n2\n4\n8\n16\n")
    (tmp_path / "clock.csv").write_text("t\n0\n0.1\n0.3\n0.6\n1\n")
    series = load_study(tmp_path).recording("01")["target.x"]
    assert series.time.tolist() == [0.1, 0.3, 0.6]
    assert series.value.tolist() == [2.0, 4.0, 8.0]


@pytest.mark.parametrize(("step", "remarked"), [(3.4, False), (3.6, True)])
def test_a_gap_is_remarked_upon_from_three_and_a_half_steps(step: float, remarked: bool, tmp_path: Path) -> None:
    times = [0.0, 1.0, 2.0, 3.0, 3.0 + step, 4.0 + step, 5.0 + step]
    write_study(tmp_path, csv="t,x\n" + "".join(f"{t},{k}\n" for k, t in enumerate(times)))
    assert any("gaps" in note for note in load_study(tmp_path).recording("01").notes) is remarked
