from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.support.errors import InputError
from spacerobot.support.numbers import parse_assignments, parse_numbers, to_radians

numbers = st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=8)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(values=numbers, between=st.sampled_from([" ", ",", ", ", " ,", ";"]), split=st.booleans())
def test_what_is_written_is_read(values: list[float], between: str, split: bool) -> None:
    text = between.join(repr(v) for v in values)
    assert parse_numbers(text.split(" ") if split else text, "--q", count=len(values)) == values


def test_brackets_and_exponents() -> None:
    assert parse_numbers("[-1e-3, .5, -.5, 2.]", "--q") == [-1e-3, 0.5, -0.5, 2.0]
    assert parse_numbers("", "--q") == []


@pytest.mark.parametrize("text", ["a", "1 2 x", "nan", "inf", "-inf", "1e999", "1..2", "--3"])
def test_no_number(text: str) -> None:
    with pytest.raises(InputError, match="--q"):
        parse_numbers(text, "--q")


def test_wrong_length_says_what_each_stands_for() -> None:
    with pytest.raises(InputError, match="3 numbers, one each for x, y, z"):
        parse_numbers("1 2", "--direction", count=3, names=("x", "y", "z"))


def test_assignments() -> None:
    assert parse_assignments(["a=1", "b=-2e-3,c=.5"], "--set") == {"a": 1.0, "b": -2e-3, "c": 0.5}
    for bad in ("a", "=1", "a=", "a=b", "a=1 a=2", "a=nan"):
        with pytest.raises(InputError, match="--set"):
            parse_assignments([bad], "--set")


def test_degrees_only_where_it_turns() -> None:
    assert to_radians([180.0, 0.5], [True, False]) == [math.pi, 0.5]
