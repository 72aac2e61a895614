"""A sensor's own filter in study.toml: read whole, and refused with its line where there is no such filter."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.diagnosis.selection.admission import admit
from spacerobot.recordings.sensor_filter import SensorFilter
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import SpacerobotError
from tests.diagnosis.rigs import write_study

FORCE = 'is = "contact.force"'


def stating(folder: Path, text: str, channel: str = FORCE) -> Study:
    """A study whose force sensor has this filter."""
    write_study(folder, masses=(9.0,), speeds=(0.1, 0.11))
    file = folder / "study.toml"
    whole = file.read_text()
    assert channel in whole
    file.write_text(whole.replace(channel, f"{channel}, filter = {text}"))
    return load_study(folder)


@pytest.mark.parametrize(
    ("text", "own"),
    [
        ("{ cutoff = 2000 }", SensorFilter(2000.0, 1, "butterworth")),
        ('{ cutoff = 450.5, order = 4, kind = "bessel" }', SensorFilter(450.5, 4, "bessel")),
        ('{ cutoff = 30, order = 2, kind = "zero_phase" }', SensorFilter(30.0, 2, "zero_phase")),
    ],
)
def test_a_filter_is_read(tmp_path: Path, text: str, own: SensorFilter) -> None:
    assert stating(tmp_path, text).filters() == {"contact.force": own}


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("{ order = 2 }", "cutoff"),
        ("{ cutoff = 0 }", "positive"),
        ("{ cutoff = -5 }", "positive"),
        ("{ cutoff = true }", "number"),
        ("{ cutoff = 100, order = 3 }", "1, 2, 4"),
        ("{ cutoff = 100, order = 2.5 }", "1, 2, 4"),
        ("{ cutoff = 100, order = [2] }", "1, 2, 4"),
        ('{ cutoff = 100, kind = "elliptic" }', "bessel"),
        ("{ cutoff = 100, corner = 2 }", "corner"),
        ("100", "table"),
    ],
)
def test_what_is_no_filter_is_refused_with_its_line(tmp_path: Path, text: str, given: str) -> None:
    with pytest.raises(SpacerobotError) as refused:
        stating(tmp_path, text)
    said = str(refused.value)
    line = next(n for n, row in enumerate((tmp_path / "study.toml").read_text().splitlines(), 1) if "filter" in row)
    assert given in said
    assert f"study.toml:{line}" in said or f"line {line}" in said


def test_a_filter_of_what_no_rig_reads_is_refused(tmp_path: Path) -> None:
    """A free body's track is taken as it is."""
    text = """format = 1
[baseline]
base = "free"
body.mass = 1
[streams.log]
time = "t"
[streams.log.channels]
q = { is = "body.position.x", filter = { cutoff = 20 } }
[[trials]]
id = "1"
log = "log.csv"
"""
    (tmp_path / "log.csv").write_text("t,q\n" + "".join(f"{0.01 * n},{0.1 * (-1) ** n}\n" for n in range(200)))
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(SpacerobotError, match=r"filter of body\.position\.x"):
        admit(load_study(tmp_path))
