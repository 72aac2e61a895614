"""Text tables: every usual layout is read, whatever cannot be read is refused with its line."""

from __future__ import annotations

import bz2
import gzip
import lzma
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.readers import limits, read_table
from spacerobot.recordings.table import Options, RawTable
from spacerobot.support.errors import InputError, NotFoundError


def table(tmp_path: Path, content: str | bytes, name: str = "a.csv", **options: object) -> RawTable:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_table(path, Options(**options))  # type: ignore[arg-type]


PLAIN = "t,x\n0,1.5\n0.1,-2e-3\n0.2,4\n"
LAYOUTS = {
    "plain": PLAIN,
    "crlf": PLAIN.replace("\n", "\r\n"),
    "cr": PLAIN.replace("\n", "\r"),
    "no last newline": PLAIN.rstrip(),
    "semicolon": PLAIN.replace(",", ";"),
    "tab": PLAIN.replace(",", "\t"),
    "pipe": PLAIN.replace(",", " | "),
    "blanks": PLAIN.replace(",", "   "),
    "decimal comma": PLAIN.replace(",", ";").replace(".", ","),
    "decimal comma, tab": PLAIN.replace(",", "\t").replace(".", ","),
    "quoted": '"t","x"\n"0","1.5"\n"0.1","-2e-3"\n"0.2","4"\n',
    "blank lines": PLAIN.replace("\n", "\n\n"),
    "comments": "# made by a rig\n" + PLAIN.replace("0.1,", "# a remark\n0.1,"),
    "commented header": "# " + PLAIN,
    "preamble": "Rig 7\nRate,1000\n\n" + PLAIN,
    "trailing separator": PLAIN.replace("\n", ",\n"),
    "utf-8 mark": b"\xef\xbb\xbf" + PLAIN.encode(),
    "utf-16 mark": PLAIN.encode("utf-16"),
    "gz": gzip.compress(PLAIN.encode()),
    "bz2": bz2.compress(PLAIN.encode()),
    "xz": lzma.compress(PLAIN.encode()),
}


@pytest.mark.parametrize("content", LAYOUTS.values(), ids=LAYOUTS.keys())
def test_layouts(tmp_path: Path, content: str | bytes) -> None:
    found = table(tmp_path, content)
    np.testing.assert_array_equal(found["t"], [0, 0.1, 0.2])
    np.testing.assert_array_equal(found["x"], [1.5, -2e-3, 4])


def test_lines_point_into_the_file(tmp_path: Path) -> None:
    found = table(tmp_path, "# a\nt,x\n\n0,1\n# b\n1,2\n")
    assert found.lines is not None
    assert list(found.lines) == [4, 6]
    assert found.at(1).endswith("a.csv:6")


def test_two_header_rows_give_two_names_each(tmp_path: Path) -> None:
    found = table(tmp_path, "Axis1\nTime,Analog 1,Analog 2\nms,Speed,unused\n0,1,2\n1,3,4\n")
    np.testing.assert_array_equal(found["Speed"], found["Analog 1"])
    assert found.names() == ("Time", "Analog 1", "Analog 2")


def test_columns_without_names_go_by_index(tmp_path: Path) -> None:
    found = table(tmp_path, "0 1\n1 3\n", name="a.txt")
    np.testing.assert_array_equal(found["1"], [1, 3])
    with pytest.raises(NotFoundError, match="column"):
        found.index("2")


def test_duplicate_columns_are_refused_by_name_and_read_by_index(tmp_path: Path) -> None:
    found = table(tmp_path, "t,x,x\n0,1,2\n1,3,4\n")
    with pytest.raises(InputError, match=r"2 columns have the same name .* choose by index: 1, 2"):
        found.index("x")
    np.testing.assert_array_equal(found["2"], [2, 4])


def test_empty_and_nan_cells_are_no_readings(tmp_path: Path) -> None:
    found = table(tmp_path, "t,x\n0,\n1,NaN\n2,inf\n3,5\n")
    np.testing.assert_array_equal(found["x"], [np.nan, np.nan, np.nan, 5])


def test_text_columns_matter_only_where_they_are_wanted(tmp_path: Path) -> None:
    content = "t,ball,h\n0,red,1\n1,blue,2\n"
    np.testing.assert_array_equal(table(tmp_path, content, wanted=frozenset({"t", "h"}))["h"], [1, 2])
    with pytest.raises(InputError, match=r"a\.csv:2: column 1: not a number; given: red"):
        table(tmp_path, content)


def test_rows_are_chosen_before_anything_else_is_judged(tmp_path: Path) -> None:
    content = "0,1\n1,2\n2,3\nend of part one\n5,6,7\n"
    np.testing.assert_array_equal(table(tmp_path, content, rows=(0, 3), header_rows=0)["1"], [1, 2, 3])


def test_interleaved_values_are_folded(tmp_path: Path) -> None:
    found = table(tmp_path, "1\n2\n3\n4\n5\n6\n", name="a.txt", reshape=3)
    np.testing.assert_array_equal(found["1"], [2, 5])
    with pytest.raises(InputError, match="groups of 4"):
        table(tmp_path, "1\n2\n3\n4\n5\n6\n", name="a.txt", reshape=4)


REFUSED = {
    "ragged row": ("t,x\n0,1\n1,2\n2\n3,4\n", r":4: the row is ragged; given: 1 cells; valid: 2 cells"),
    "glued numbers": ("0 1.0 2.0\n1 2.0 3.0\n2 3.04.0\n3 5.0 6.0\n", r":3: .*(run together|ragged)"),
    "glued numbers in two columns": ("0 1.0\n1 2.0\n2 3.054.0\n3 5.0\n", r":3: column 1: two numbers run together"),
    "no separator at all": ("0 1.02.0\n1 2.03.0\n2 3.04.0\n", r":1: column 1: two numbers run together"),
    "text": ("t,x\n0,1\n1,two\n2,3\n", r":3: column 1: not a number; given: two"),
    "decimal comma in comma table": ("t;x\n0;1.5\n1;2,5,3\n2;1.5\n", r":3: column 1: not a number"),
    "uninitialised": ("t,x\n0,1\n1,6.95e-310\n", r":3: column 'x' holds a number no sensor gives"),
    "uninitialised, large": ("t,x\n0,1\n1,1.4889e+195\n", r":3: column 'x' holds a number no sensor gives"),
    "empty": ("", "no rows of numbers"),
    "header alone": ("t,x\n", "no rows of numbers|not a number"),
    "binary": (b"t,x\n0,1\n\x00\x01\x02\n", r":3: binary data"),
    "utf-16 without mark": (PLAIN.encode("utf-16-le"), r":1: binary data, or UTF-16"),
    "underscores": ("t,x\n0,1_000\n1,2_000\n", "not a number"),
    "hexadecimal": ("t,x\n0,0x10\n1,0x11\n", "not a number"),
}


@pytest.mark.parametrize(("content", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_refused_with_the_line(tmp_path: Path, content: str | bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        table(tmp_path, content)


def test_damaged_gz_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        table(tmp_path, gzip.compress(PLAIN.encode() * 100)[:-30], name="a.csv.gz")


def test_limits_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "LINE_CHARACTERS", 1000)
    with pytest.raises(InputError, match=r":2: the line is too long"):
        table(tmp_path, "t,x\n0," + "1" * 2000 + "\n")
    monkeypatch.setattr(limits, "TEXT_LINES", 100)
    with pytest.raises(InputError, match="too many lines"):
        table(tmp_path, "0,1\n" * 200)


def test_gz_bomb_stops_at_the_limit(tmp_path: Path) -> None:
    bomb = gzip.compress(bytes(150_000_000), compresslevel=9)
    assert len(bomb) < 200_000
    with pytest.raises(InputError, match="too long"):
        table(tmp_path, bomb)


numbers = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e80, max_value=1e80).filter(
    lambda v: v == 0 or abs(v) > 1e-200
)
layouts = st.sampled_from([(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (" ", "."), ("|", ".")])


@settings(max_examples=80, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    layout=layouts,
    rows=st.integers(1, 4).flatmap(
        lambda w: st.lists(st.lists(numbers, min_size=w, max_size=w), min_size=2, max_size=12)
    ),
    header=st.booleans(),
    end=st.sampled_from(["\n", "\r\n"]),
)
def test_round_trip(tmp_path: Path, layout: tuple[str, str], rows: list[list[float]], header: bool, end: str) -> None:
    separator, decimal = layout
    lines = [separator.join(f"c{j}" for j in range(len(rows[0])))] if header else []
    lines += [separator.join(repr(v).replace(".", decimal) for v in row) for row in rows]
    options = {"separator": separator, "decimal": decimal} if len(rows[0]) == 1 else {}
    found = table(tmp_path, end.join(lines) + end, **options)
    np.testing.assert_array_equal(np.stack([c.values for c in found.columns], axis=1), np.array(rows))
    if header:
        assert found.names() == tuple(f"c{j}" for j in range(len(rows[0])))


pieces = st.sampled_from(
    ["0", "1.5", "-2e-3", ",", ";", "\t", " ", "\n", "\r\n", '"', "#", "x", "Frame,", "Format Version,1.21,", "nan",
     "1e400", "\ufeff", "é", "\x00", "1.2.3", "Time", "9" * 30, "|", "--"]
)  # fmt: skip


@settings(
    max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(content=st.one_of(st.lists(pieces, max_size=40).map("".join).map(str.encode), st.binary(max_size=200)),
       name=st.sampled_from(["a.csv", "a.txt", "a.gz", "a"]))  # fmt: skip
def test_nothing_but_input_errors(tmp_path: Path, content: bytes, name: str) -> None:
    try:
        found = table(tmp_path, content, name=name)
    except InputError:
        return
    assert all(len(c.values) == len(found.columns[0].values) for c in found.columns)
