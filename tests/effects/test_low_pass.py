"""Between blurring the motion and changing nothing: where a filter is one."""

from __future__ import annotations

import pytest

from spacerobot.effects.registry import effect
from spacerobot.effects.sizes import Sizes


@pytest.mark.parametrize("time", [0.01, 1.0, 30.0])
@pytest.mark.parametrize(
    ("times", "is_one"), [(1.5, False), (3.0, True), (3e3, True), (1e6, False), (float("inf"), False)]
)
def test_a_filter_is_slower_than_nothing_and_quicker_than_the_motion(time: float, times: float, is_one: bool) -> None:
    """By the motion's own time over the filter's, in whatever units of time."""
    cutoff = times / (2.0 * 3.141592653589793 * time)
    assert (effect("low_pass").implausible({"cutoff_Hz": cutoff}, Sizes(1.0, 1.0, time)) == "") is is_one
