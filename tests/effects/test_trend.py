"""Effects that change over the trials: their share, their null, and their place beside the steady ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.terms.candidates import contains, redundant, refines
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.sizes import Sizes
from spacerobot.effects.trend import NUMBER, SUFFIX, TREND, Trend, may_change
from spacerobot.simulation.rig import rig

CHANGING = [e for e in all_effects().values() if may_change(e) and "wrist" in e.places(rig({}))]


@given(force=st.floats(0.0, 10.0), trend=st.floats(-0.08, 0.5), number=st.integers(0, 11))
def test_the_strength_changes_by_the_same_share_of_the_first_each_time(force: float, trend: float, number: int) -> None:
    fading = effect("coulomb_friction" + SUFFIX)
    values = {"force_N": force, TREND: trend, NUMBER: float(number)}
    friction = fading.edit(rig({}), "wrist", values).frictions[-1]
    assert friction.p[0] == pytest.approx(force * (1.0 + trend * number), abs=1e-12)


@pytest.mark.parametrize("steady", CHANGING, ids=lambda e: e.name)
def test_without_a_trend_an_effect_is_the_steady_one_in_every_trial(steady: object) -> None:
    name = getattr(steady, "name")  # noqa: B009 - parametrised over what the registry holds
    values = {p.name: p.starts[0] for p in effect(name).parameters}
    for number in (0.0, 7.0):
        changed = effect(name + SUFFIX).edit(rig({}), "wrist", {**values, TREND: 0.0, NUMBER: number})
        plain = effect(name).edit(rig({}), "wrist", values)
        assert changed.forces == plain.forces
        assert changed.frictions == plain.frictions
        assert changed.states == plain.states
        assert changed.coordinates == plain.coordinates


def test_a_changing_effect_holds_the_steady_one_and_its_special_cases() -> None:
    changing = ("stribeck_friction" + SUFFIX, "wrist")
    assert refines(changing[0], "stribeck_friction")
    assert refines(changing[0], "coulomb_friction")
    assert contains([changing], [("coulomb_friction", "wrist")])
    assert not contains([("coulomb_friction", "wrist")], [changing])
    assert contains([changing], [("coulomb_friction" + SUFFIX, "wrist")])
    assert redundant([changing, ("coulomb_friction", "wrist")])
    assert redundant([("coulomb_friction", "wrist"), ("coulomb_friction", "wrist")])
    assert redundant([("coulomb_friction", "wrist"), ("coulomb_friction" + SUFFIX, "wrist")])
    assert not redundant([("coulomb_friction" + SUFFIX, "wrist"), ("table_tilt", "target")])


def test_a_changing_effect_is_as_plausible_as_the_steady_one() -> None:
    """A bristle that gives by a micrometre is no bristle, whether it fades or not."""
    sizes = Sizes(force=1.0, length=0.01, time=0.1, reading=1e-4)
    for stiffness in (1e2, 1e9):
        values = {"force_N": 0.4, "stiffness_N_m": stiffness}
        steady, changing = effect("dahl_friction"), effect("dahl_friction" + SUFFIX)
        assert changing.implausible({**values, TREND: 0.01}, sizes) == steady.implausible(values, sizes)
    assert steady.implausible(values, sizes)


def test_a_trials_values_are_those_of_the_steady_effect_at_that_strength() -> None:
    """What the scene of a trial is written with acts as the changing effect does in it."""
    changing = effect("coulomb_friction" + SUFFIX)
    assert isinstance(changing, Trend)
    values = {"force_N": 0.4, TREND: -0.05}
    for number in (0, 3, 11):
        own = changing.in_trial(values, number)
        assert own == {"force_N": pytest.approx(0.4 * (1.0 - 0.05 * number))}
        edited = changing.edit(rig({}), "wrist", {**values, NUMBER: float(number)})
        assert edited.frictions == effect("coulomb_friction").edit(rig({}), "wrist", own).frictions
