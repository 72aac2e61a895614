"""One rig, written down as many labs would: `study new` makes the same recording of it in SI, whatever the layout."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, check, columns_of, rig, written
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.drafting.files import sentinel
from spacerobot.recordings.drafting.languages import english
from spacerobot.recordings.readers.layout import headings
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Floats

START = datetime(2025, 3, 10, 23, 59, 59, 250000, tzinfo=UTC)

NAMES = {
    "english": ("time", "target pos", "slider pos", "contact force", "slider setpoint"),
    "german": ("Zeit", "Zielposition", "Schlittenweg", "Kontaktkraft", "Soll"),
    "japanese": ("時刻", "ターゲット位置", "手首変位", "接触力", "目標値"),
    "french": ("Temps", "Cible x", "Poignet x", "Force", "Consigne"),
}
ENCODINGS = {
    "english": ("ascii",),
    "german": ("utf-8", "latin-1"),
    "japanese": ("utf-8", "cp932"),
    "french": ("ascii",),
}


def clock(form: str, t: Floats) -> list[str]:
    """The times of a trial as loggers write them."""
    if form == "iso":
        return [(START + timedelta(seconds=float(s))).isoformat(timespec="milliseconds") for s in t]
    if form == "points":
        return [(START + timedelta(seconds=float(s))).strftime("%d.%m.%Y %H:%M:%S.%f")[:-3] for s in t]
    if form == "epoch ns":
        return [str(1741600000_000000000 + round(1e9 * s)) for s in t]
    return [f"{s * {'s': 1, 'ms': 1e3}[form]:.3f}" for s in t]


@pytest.mark.slow
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    st.sampled_from(sorted(NAMES)),
    st.sampled_from([(";", ","), (";", "."), (",", "."), ("\t", "."), ("\t", ",")]),
    st.sampled_from(["s", "ms", "iso", "points", "epoch ns"]),
    st.sampled_from(["in the name", "on a line"]),
    st.sampled_from([("m", 1.0), ("mm", 1e3), ("cm", 1e2)]),
    st.booleans(),
    st.floats(-500, 500),
    st.data(),
)
def test_whatever_the_layout_the_recording_is_the_same(
    language: str,
    marks: tuple[str, str],
    form: str,
    units: str,
    unit: tuple[str, float],
    title: bool,
    zero: float,
    data: st.DataObject,
) -> None:
    encoding = data.draw(st.sampled_from(ENCODINGS.get(language, ("ascii",))))
    separator, comma = marks
    time_unit = {"s": "s", "ms": "ms", "epoch ns": "ns"}.get(form, "")
    said = [time_unit, unit[0], unit[0], "N", unit[0]]
    names = [f"{n} [{u}]" if u and units == "in the name" else n for n, u in zip(NAMES[language], said, strict=True)]
    lines = ["Bench 3, 12.03.2025"] if title else []
    lines += [separator.join(names)] + ([separator.join(said)] if units == "on a line" and all(said) else [])
    if units == "on a line" and not all(said):
        unit = ("m", 1.0)  # no line of units can be written above stamps: then it is metres
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for n, speed in enumerate(SPEEDS, 1):
            t, target, wrist, force = rig(speed)
            columns = (target * unit[1] + zero, wrist * unit[1] - zero, force, 0 * t)
            rows = [
                separator.join([stamp.replace(".", comma) if form in ("s", "ms") else stamp, *cells])
                for stamp, *cells in zip(clock(form, t), *_cells(columns, comma), strict=True)
            ]
            (folder / f"run{n}.csv").write_bytes("\n".join([*lines, *rows]).encode(encoding))
        (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
        check(load_study(folder))


def _cells(columns: Sequence[Floats], comma: str) -> list[list[str]]:
    return [[f"{v:.6f}".replace(".", comma) for v in column] for column in columns]


@pytest.mark.parametrize(
    ("cell", "seconds"),
    [
        ("1970-01-02T00:00:01Z", 86401.0),
        ("1970-01-01 01:00:00,5", 3600.5),
        ("01.01.1970 00:00:02", 2.0),
        ("1/2/1970 00:00:00", 86400.0),
        ("13/1/1970 00:00:00", 12 * 86400.0),
        ("1970-01-01T02:00:00+02:00", 0.0),
        ("23:59:59.25", 86399.25),
        ("1970-13-01 00:00:00", None),
        ("24:00:00", None),
        ("12:61:00", None),
        ("1:2", None),
    ],
)
def test_stamps(cell: str, seconds: float | None) -> None:
    assert number(cell) == seconds


@given(st.datetimes(datetime(1971, 1, 1), datetime(2099, 1, 1)))
def test_a_stamp_is_its_seconds_since_1970(when: datetime) -> None:
    seconds = when.replace(tzinfo=UTC).timestamp()
    for text in (when.isoformat(timespec="microseconds"), when.strftime("%d.%m.%Y %H:%M:%S.%f")):
        assert number(text.replace(f"{when.year}", f"{when.year:04d}")) == pytest.approx(seconds, abs=1e-6)


def test_a_line_of_units_states_them_and_one_of_names_does_not() -> None:
    assert headings([["t", "x"], ["s", "mm"]], 2) == ([("t",), ("x",)], ["s", "mm"])
    assert headings([["t", "x"], ["[s]", "(mm)"]], 2) == ([("t",), ("x",)], ["s", "mm"])
    assert headings([["t", "m"]], 2) == ([("t",), ("m",)], [None, None])  # the only line has the names


@pytest.mark.parametrize("word", ["spacecraft", "satellite", "list", "coupled", "time_ms", "target_x", "Force"])
def test_english_stays_english(word: str) -> None:
    assert english(word) == word


def test_a_camera_systems_export_names_things_above_their_axes(tmp_path: Path) -> None:
    head = "Trajectories\n100\n,,rig:target,,,rig:slider,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm"
    head += "\n,,,,,,,"
    study = written(tmp_path / "rig", head, "{i},0,500,{x:.6f}e3,210,480,{s:.6f}e3,200")
    assert columns_of(study) == {"target.x": "rig:target.position.y", "wrist.x": "rig:slider.position.y"}
    np.testing.assert_allclose(np.diff(study.recording(study.trials[0])["target.x"].time), 0.01)
    assert "# ? Hz" not in (tmp_path / "rig" / "study.toml").read_text()
    units = {c.unit for c in study.streams["log"].channels}
    assert units == {"mm"}


def test_a_loggers_header_of_several_lines(tmp_path: Path) -> None:
    head = "LabVIEW Measurement\nDecimal_Separator\t.\nChannels\t3\nSamples\t200\t200\t200"
    head += "\nY_Unit_Label\tmm\tmm\tN\n***End***\t\t\t\nX_Value\tTarget\tSlider\tForce\tComment"
    study = written(tmp_path / "rig", head, "{t:.4f}\t{x:.6f}e3\t{s:.6f}e3\t{f:.4f}", ending="lvm")
    check(study)


QUOTED = '"{t:.3f}","{x:.6f}","{s:.6f}","{f:.4f}"'


@pytest.mark.parametrize(
    ("head", "row"),
    [
        ("sep=;\nt [s];target [m];slider [m];force [N]", "{t:.3f};{x:.6f};{s:.6f};{f:.4f}"),
        ('"t","target_m","slider_m","force_N"', QUOTED),
        ("# run 5\n# t [s], target_x [m], slider_x [m], F [N]", "{t:.3f}, {x:.6f}, {s:.6f}, {f:.4f}"),
        ("", "{t:.3f} {x:.6f} {s:.6f} {f:.4f}"),
        ("t,mode,target_m,slider_m,force", "{t:.3f},RUN,{x:.6f},{s:.6f},{f:.4f}"),
        ("t;target [m];slider [m];force;", "{t:.3f};{x:.6f};{s:.6f};{f:.4f};"),
        ("time,target,slider,force", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}"),
        ("datenum,target,slider,force", "739685.{d:09.0f},{x:.6f},{s:.6f},{f:.4f}"),
    ],
)
def test_what_loggers_leave(tmp_path: Path, head: str, row: str) -> None:
    check(written(tmp_path / "rig", head, row))


def test_a_decimal_comma_within_quotes(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t;target;slider;force", "{t:.3f};{x:.6f};{s:.6f};{f:.4f}")
    for file in (tmp_path / "rig").glob("*.csv"):
        rows = (",".join(f'"{c}"' for c in line.split(";")) for line in file.read_text().replace(".", ",").splitlines())
        file.write_text("\n".join(rows))
    (tmp_path / "rig" / "study.toml").write_text(draft_study(tmp_path / "rig"))
    check(load_study(study.path))


def test_a_reading_that_stands_for_none_is_said_to(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t,target_m,slider_m,force_N", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}")
    for file in (tmp_path / "rig").glob("*.csv"):
        rows = [line.split(",") for line in file.read_text().splitlines()]
        for row in rows[7::31]:
            row[1] = "-9999"
        file.write_text("\n".join(map(",".join, rows)))
    text = draft_study(tmp_path / "rig")
    assert "missing = [-9999.0]" in text
    study.path.write_text(text)
    for trial in load_study(study.path).trials:
        target = load_study(study.path).recording(trial)["target.x"]
        assert 0 < np.sum(~target.valid) < 10
        assert np.nanmin(target.value) > -1.0


@given(st.lists(st.floats(-10, 10), min_size=4, max_size=40, unique=True), st.integers(0, 3))
def test_only_what_is_far_from_all_others_and_given_again_stands_for_none(values: list[float], again: int) -> None:
    assert sentinel(np.array(values)) is None
    with_it = np.array([*values, *[-9999.0] * again])
    assert sentinel(with_it) == (-9999.0 if again > 1 else None)


def test_numbers_too_large_for_metres_are_taken_for_millimetres_and_asked(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t,target,slider,force", "{t:.3f},{x:.6f}e3,{s:.6f}e3,{f:.4f}")
    check(study)
    text = study.path.read_text()
    assert text.count('unit = "mm"') == 2
    assert text.count("are they mm") == 1


def test_a_line_of_units_counts_where_the_study_says_nothing(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t;target;slider;force\nms;m;m;N", "{t:.4f}e3;{x:.6f};{s:.6f};{f:.4f}")
    check(study)
    text = study.path.read_text()
    assert 'time_unit = "ms"' in text
    study.path.write_text(text.replace('time_unit = "ms"\n', ""))
    check(load_study(study.path))
