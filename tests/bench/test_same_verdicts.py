"""Two verdicts are the same but for the seconds, and nothing else may hide in that."""

from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from benchmarks.same_verdicts import MAY_DIFFER, differences

JSON = st.recursive(
    st.one_of(st.booleans(), st.integers(), st.text(max_size=3)),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=8,
)


@given(st.dictionaries(st.text(max_size=3), JSON, max_size=4), JSON)
def test_a_verdict_equals_itself_whatever_it_took(verdict: dict[str, Any], other: Any) -> None:
    assert not differences(verdict, {**verdict, **dict.fromkeys(MAY_DIFFER, other)})


@given(JSON, JSON)
def test_every_other_field_counts(one: Any, two: Any) -> None:
    before, after = {"effects": [{"seconds": one}]}, {"effects": [{"seconds": two}]}
    assert bool(differences(before, after)) == (one != two)
    assert differences({"a": None}, {})
    assert differences({"a": [1]}, {"a": [1, 2]})
