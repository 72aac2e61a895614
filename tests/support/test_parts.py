"""Functions that compiled ones are made of: what they compute, for whom, and in how many forms."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.support import jit, parts


@jit.lean
def _weighed(x, first, share):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(first, x.size):
        total += share * x[i]
    return total


@jit.part
def _doubled(x):  # type: ignore[no-untyped-def]
    out = np.empty(x.size)
    for i in range(x.size):
        out[i] = 2.0 * x[i]
    return out


@jit.inlined
def _first(x):  # type: ignore[no-untyped-def]
    return x[0]


@jit.jit
def _whole(x, start):  # type: ignore[no-untyped-def]
    return _weighed(_doubled(x), 0, 1.0), _weighed(x, 1, 0.5), _weighed(x, start, 2.0), _first(x)


X = np.array([1.0, 2.0, 4.0])


@pytest.fixture(scope="module", autouse=True)
def _in_this_process() -> None:
    """Compiled here, whatever is kept on disk."""
    jit.numba().njit(_whole.py_func)(X, 2)


def test_parts_make_what_they_make_in_python() -> None:
    assert _whole(X, 2) == (14.0, 3.0, 8.0, 1.0)
    assert _weighed(X, 1, 0.5) == _weighed.py_func(X, 1, 0.5) == 3.0
    assert _doubled(X).tolist() == [2.0, 4.0, 8.0]


def test_constants_make_no_other_forms() -> None:
    assert len(_weighed.overloads) == 1


def test_a_part_is_left_to_its_callers() -> None:
    """There is no machine code of its own to load, and nothing of it on disk."""
    (made,) = _weighed.overloads.values()
    assert made.library.get_pointer_to_function(made.fndesc.llvm_cpython_wrapper_name) == 0
    assert _weighed.stats.cache_path is None


def test_where_numba_is_another_all_is_finished_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parts.part() is not None
    monkeypatch.setattr(parts, "REPLACED", ("no such method",))
    parts.part.cache_clear()
    try:
        plain = jit.lean(_weighed.py_func)
        assert type(plain) is not type(_weighed)
        assert plain(X, 1, 0.5) == 3.0
    finally:
        parts.part.cache_clear()


def test_operators_of_other_types_are_what_they_are() -> None:
    """What is remembered of `+` is by the types of both sides."""

    def added(a, b):  # type: ignore[no-untyped-def]
        return a + b

    made = jit.numba().njit(added)
    pairs = [(1, 2), (1, 2.5), (1.5, 2.0), (True, 2), ("a", "b"), ((1, 2.0), (3,)), (1j, 2)]
    for a, b in (*pairs, *pairs):
        assert made(a, b) == a + b
        assert type(made(a, b)) is type(a + b)
    assert made(np.arange(3), 0.5).tolist() == [0.5, 1.5, 2.5]
