"""A stop that nothing came up to is none: two places far apart say nothing of what lies between."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.selection.nameable import reached
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.registry import effect

STOP = Site(effect("end_stop"), "joint.a")


@pytest.mark.parametrize(
    ("seen", "right"),
    [
        (np.linspace(0.0, 0.85, 200), True),  # runs into it, and it gives by a little
        (np.linspace(0.0, 0.79, 200), True),  # never there: the fit has nothing to go by, which is another's to judge
        (np.concatenate([np.linspace(0.0, 0.02, 50), np.linspace(1.43, 1.52, 50)]), False),
        (np.concatenate([np.linspace(0.0, 0.78, 9), np.linspace(0.81, 0.812, 9)]), True),  # a stiff one, few readings
        (np.linspace(-1.5, 1.5, 200), True),
        (np.linspace(-1.7, 1.7, 200), False),  # beyond it lies more than before it: a spring, or nothing at all
    ],
)
def test_a_stop_is_where_readings_come_up_to_it(seen: np.ndarray, right: bool) -> None:
    values = {STOP.key("travel_m"): 0.8, STOP.key("stiffness_N_m"): 100.0}
    assert reached([STOP], values, lambda where: seen) == right


def test_a_place_that_nothing_reads_is_not_asked() -> None:
    values = {STOP.key("travel_m"): 0.8, STOP.key("stiffness_N_m"): 100.0}
    assert reached([STOP], values, lambda where: np.zeros(0))
