"""An effect whose size may be nothing, spans its range or sits at a bound is not shown, whichever effect it is."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.selection.nameable import at_bound, implausible, not_shown, why_nameless
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Parameter
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.sizes import Sizes

SITES = [Site(e, "somewhere") for e in all_effects().values()]
sites = st.sampled_from(SITES)
shares = st.floats(0.05, 1.0)


def strengths(site: Site) -> list[Parameter]:
    return [p for p in site.effect.parameters if not p.shape]


def off_null(p: Parameter, share: float) -> float:
    """A value between the parameter's null and its first start, away from both null and bounds."""
    if math.isinf(p.null):
        return p.starts[0] / share
    return p.null + share * ((p.starts[0] - p.null) or p.scale)


def plain(site: Site, share: float) -> dict[str, float]:
    return {site.key(p.name): off_null(p, share) for p in site.effect.parameters}


def narrow(values: dict[str, float], part: float = 1e-3) -> dict[str, tuple[float, float]]:
    return {k: (v - part * abs(v), v + part * abs(v)) for k, v in values.items()}


@given(sites, shares)
def test_a_size_far_from_nothing_is_shown(site: Site, share: float) -> None:
    values = plain(site, share)
    nearby = {
        site.key(p.name): (v - 0.01 * abs(v - p.null), v + 0.01 * abs(v - p.null))
        for p in site.effect.parameters
        if math.isfinite(p.null)
        for v in [values[site.key(p.name)]]
    }
    assert not_shown(site, values, nearby) == ""


@given(sites, shares)
def test_a_size_that_may_be_nothing_is_not(site: Site, share: float) -> None:
    values = plain(site, share)
    intervals = narrow(values)
    for p in strengths(site):
        key = site.key(p.name)
        intervals[key] = (min(values[key], p.null), max(values[key], p.null))
    assert "holds nothing" in not_shown(site, values, intervals)


@given(sites, shares)
def test_a_size_that_may_be_anything_is_not(site: Site, share: float) -> None:
    p = strengths(site)[0]
    values = plain(site, share)
    intervals = {**narrow(values), site.key(p.name): (p.lower, p.upper)}
    assert not_shown(site, values, intervals)


@given(sites, shares, st.data())
def test_a_value_at_a_drawn_bound_is_not(site: Site, share: float, data: st.DataObject) -> None:
    p = data.draw(st.sampled_from(site.effect.parameters))
    bound = data.draw(st.sampled_from([p.lower, p.upper]))
    values = {**plain(site, share), site.key(p.name): bound}
    drawn = math.isfinite(bound) and bound not in (0.0, p.null)
    assert at_bound(p, bound) is drawn
    if drawn:
        assert "at its bound" in not_shown(site, values, narrow(values))


@pytest.mark.parametrize(
    ("name", "value", "interval"),
    [
        ("coulomb_friction", 20.0, (0.0, 66.0)),
        ("payload", 3.0, (-67.0, 73.0)),
        ("scale", 0.1, (0.1, 0.2)),
        ("time_offset", 1.0, (0.98, 1.0)),
        ("low_pass", 900.0, (200.0, math.inf)),
    ],
)
def test_what_has_been_named_and_must_not_be(name: str, value: float, interval: tuple[float, float]) -> None:
    site = Site(all_effects()[name], "somewhere")
    key = site.key(site.effect.parameters[0].name)
    assert not_shown(site, {key: value}, {key: interval})


def test_one_strength_of_two_may_be_nothing() -> None:
    site = Site(all_effects()["asymmetric_friction"], "wrist")
    plus, minus = (site.key(p.name) for p in site.effect.parameters)
    values = {plus: 0.3, minus: 0.01}
    assert not_shown(site, values, {plus: (0.28, 0.32), minus: (0.0, 0.03)}) == ""
    assert not_shown(site, values, {plus: (0.0, 0.32), minus: (0.0, 0.03)})


@given(st.sampled_from([2.0**-20, 2.0**-10, 2.0**10]), st.floats(-5e-3, 5e-3))
def test_a_bound_is_as_near_in_any_unit(unit: float, away: float) -> None:
    def bounded(by: float) -> Parameter:
        return Parameter("size", "1", 0.0, by, 0.2 * by, 7.0 * by, (by,))

    for bound in (0.2, 7.0):
        value = bound * (1.0 + away)
        assert at_bound(bounded(unit), unit * value) == at_bound(bounded(1.0), value)


class Fitted:
    """As much of a fit as is asked here."""

    def __init__(self, site: Site, values: dict[str, float]) -> None:
        self.hypothesis = SimpleNamespace(sites=(site,), label=(site.label,))
        self._values = values

    def values(self) -> dict[str, float]:
        return self._values

    def errors(self) -> dict[str, tuple[float, float]]:
        return narrow(self._values)


def test_why_a_fit_is_not_named_is_what_speaks_against_it() -> None:
    """A sign, a bound, or numbers that are not its name's; nothing of a fit against which nothing speaks."""

    def why(site: Site, values: dict[str, float]) -> str:
        sizes = Sizes(force=10.0, length=0.02, time=0.1)
        return why_nameless(Fitted(site, values), lambda fit: implausible([site], values, lambda _: sizes))  # type: ignore[arg-type]

    late = Site(effect("time_offset"), "force_sensor")
    assert why(late, {late.key("delay_s"): 0.02}) == ""
    assert "sign" in why(late, {late.key("delay_s"): -0.02})
    rub = Site(effect("stribeck_friction"), "wrist")
    sane = {rub.key(p.name): p.starts[0] for p in rub.effect.parameters}
    assert why(rub, sane) == ""
    fast = next(p for p in rub.effect.parameters if p.name == "velocity_m_s")
    assert "velocity_m_s" in why(rub, {**sane, rub.key(fast.name): fast.upper})
    rising = {**sane, rub.key("coulomb_force_N"): 2.0 * sane[rub.key("static_force_N")]}
    assert "does not fall" in why(rub, rising)
