"""How sure an answer is of believed values: least where one lies just at the bound beyond which it counts as wrong."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.selection.judge import sure_of_values
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.diagnosis.terms.hypothesis import Believed, hypothesis


def sure(*away: float, within: bool = False) -> float:
    """Of values so many of their sigmas from what is stated of them; one may be sure to be no further than three."""
    names = [f"joint.j{k}.zero" for k in range(len(away))]
    sigma = dict.fromkeys(names, 0.01)
    bound = dict.fromkeys(names, MOVED * 0.01) if within else {}
    made = hypothesis(Believed(dict.fromkeys(names, 0.0), {}, {}, (), absolute=sigma, within=bound), ())
    return sure_of_values(cast(Fit, SimpleNamespace(hypothesis=made, z=np.array(away))))


def test_at_the_bound_the_odds_are_even() -> None:
    assert sure(MOVED) == pytest.approx(0.5)
    assert sure(0.1, -MOVED) == pytest.approx(0.5)


@given(st.floats(0.0, 2.9), st.floats(0.0, 0.1))
def test_the_nearer_to_it_the_less_sure_from_either_side(away: float, more: float) -> None:
    assert sure(away + more) <= sure(away) <= 1.0
    assert sure(MOVED + 0.1 + more) >= sure(MOVED + 0.1)


def test_a_value_2_8_sigmas_off_is_not_as_good_as_one_that_is_right() -> None:
    assert sure(2.8) < 0.75
    assert sure(1.0) > 0.98


def test_what_can_be_no_further_is_never_wrong() -> None:
    assert sure(MOVED, within=True) == pytest.approx(sure(0.0))
