"""Tables of plain numbers, read in one compiled pass: every number as `float` reads it, nothing else taken for one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from spacerobot.recordings.readers import read_table
from spacerobot.recordings.readers.decimals import LINES, decimals
from spacerobot.recordings.readers.numbers import number

SPELLED = st.builds(
    "{}{}{}{}".format,
    st.sampled_from(["", "", "-", "+"]),
    st.from_regex(r"[0-9]{1,25}", fullmatch=True),
    st.one_of(st.just(""), st.just("."), st.from_regex(r"\.[0-9]{1,25}", fullmatch=True)),
    st.one_of(st.just(""), st.just(""), st.from_regex(r"[eE][+-]?[0-9]{1,3}", fullmatch=True)),
)
NUMBERS = st.one_of(SPELLED, st.floats(allow_nan=False, allow_infinity=False).map(repr))
HALFWAY = [
    "9007199254740993",
    "9007199254740992.5",
    "1.00000000000000011102",
    "0.50000000000000005551",
    "4503599627370496.5",
]


@given(cells=st.lists(NUMBERS, min_size=1, max_size=30))
@example(cells=HALFWAY)
@example(cells=["5e-324", "1e308", ".5", "-0", "1.", "00012", "0e999", "1e-400"])
def test_every_number_is_the_double_nearest_to_it(cells: list[str]) -> None:
    expected = np.array([float(c) for c in cells])
    found = decimals(cells, ",", 1)
    if not np.isfinite(expected).all():
        assert found is None
        return
    assert found is not None
    assert found[:, 0].tobytes() == expected.tobytes(), "to the last bit, and the sign of zero"


@given(line=st.text('0123456789.eE+-,; \t"#x\n_\xa0١', min_size=1, max_size=12), separator=st.sampled_from(",;\t| "))
@example(line="1,2,", separator=",")
@example(line="1-2,3", separator=",")
@example(line="1 2", separator=" ")
def test_what_is_no_number_is_not_taken_for_one(line: str, separator: str) -> None:
    """Whatever is accepted, the reader that goes cell by cell reads alike."""
    cells = line.split() if separator == " " else line.split(separator)
    expected = [number(c) for c in cells]
    found = decimals([line], separator, len(cells))
    if found is not None:
        assert list(found[0]) == expected
    elif "\n" not in line and all(v is not None and np.isfinite(v) for v in expected):
        assert not line.isascii() or not all(c in "0123456789.eE+- \t,;|" for c in line), line


def test_lines_of_another_width_are_refused() -> None:
    for line in ("1", "1,2,3", "1,2,", ",1,2", "1,,2", ""):
        assert decimals(["1,2", line], ",", 2) is None


def test_more_lines_than_are_parsed_at_a_time() -> None:
    lines = [f"{k},{k}.5" for k in range(LINES + 3)]
    found = decimals(lines, ",", 2)
    assert found is not None
    assert (found == np.add.outer(np.arange(LINES + 3.0), [0.0, 0.5])).all()
    assert decimals([*lines, "end,"], ",", 2) is None


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", " , "])
def test_a_comment_among_the_rows_changes_nothing_but_their_lines(separator: str, tmp_path: Path) -> None:
    rows = [separator.join(cells) for cells in (("0.0", "1e-3"), ("0.1", "-2.5"), ("0.2", "3"), ("0.3", "4"))]
    tables = []
    for name, lines in (("plain", rows), ("broken", [*rows[:2], "# a comment", "", *rows[2:]])):
        path = tmp_path / f"{name}.csv"
        path.write_text("\n".join([separator.join(("t", "x")), *lines, ""]))
        tables.append(read_table(path))
    for name in ("t", "x"):
        assert (tables[0][name] == tables[1][name]).all()
    assert [t.lines.tolist() for t in tables if t.lines is not None] == [[2, 3, 4, 5], [2, 3, 6, 7]]
