"""Sets over parts come in the order of a product, fewest changes first, and are never all made at once."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.alternatives import sets


@given(st.lists(st.integers(1, 4), max_size=5))
def test_sets_are_the_product_sorted_by_how_many_differ_from_the_first(sizes: list[int]) -> None:
    choices = [[(part, place) for place in range(size)] for part, size in enumerate(sizes)]
    product = sorted(itertools.product(*choices), key=lambda s: sum(place > 0 for _, place in s))
    assert [s for others in range(len(sizes) + 1) for s in sets(choices, others)] == product


def test_many_parts_are_listed_without_being_held() -> None:
    choices = [range(20)] * 30
    few = list(itertools.islice(itertools.chain.from_iterable(sets(choices, k) for k in range(31)), 32))
    assert few[0] == (0,) * 30
    assert [sum(x > 0 for x in one) for one in few] == [0] + [1] * 31
