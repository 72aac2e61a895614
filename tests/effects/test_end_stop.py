"""When a fitted stop is one."""

from __future__ import annotations

import pytest

from spacerobot.effects.registry import effect
from spacerobot.effects.sizes import Sizes


@pytest.mark.parametrize(("stiffness", "stop"), [(1e5, True), (1020.0, True), (27.0, False)])
def test_a_stop_is_no_softer_than_a_buffer(stiffness: float, stop: bool) -> None:
    """On a spring of 1,020 N/m: steel, a rubber buffer; and a spring that drifts, which is none."""
    sizes = Sizes(force=20.4, length=0.02, time=0.1)
    assert (effect("end_stop").implausible({"travel_m": 0.018, "stiffness_N_m": stiffness}, sizes) == "") is stop
