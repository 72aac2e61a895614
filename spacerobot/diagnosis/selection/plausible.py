"""Fits that are no physics: signs and sizes that an effect's name would not survive."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from spacerobot.diagnosis.machines.sizes import Sizes
from spacerobot.diagnosis.terms.hypothesis import Site

SLOW = 0.3
"""Stribeck's velocity lies below this share of the typical speed: beyond it the law is a damper in disguise."""

DRY = frozenset({"coulomb_friction", "asymmetric_friction", "stribeck_friction"})
"""Laws of dry friction; one place has one of them."""

QUICK = 0.1
"""A filter's time constant is at most this share of the motion's own time."""

HARD = 3.0
"""An end stop is this many times as stiff as a spring that the typical force bends by the typical length."""

Rule = Callable[[Mapping[str, float], Sizes], bool]


def _stribeck(p: Mapping[str, float], sizes: Sizes) -> bool:
    """Friction falls with speed, within the speeds that were seen."""
    return p["static_force_N"] > p["coulomb_force_N"] and p["velocity_m_s"] < SLOW * sizes.length / sizes.time


def _end_stop(p: Mapping[str, float], sizes: Sizes) -> bool:
    return p["stiffness_N_m"] > HARD * sizes.force / sizes.length


def _low_pass(p: Mapping[str, float], sizes: Sizes) -> bool:
    """A sensor that needs longer to settle than this would blur the motion itself."""
    return 2.0 * math.pi * p["cutoff_Hz"] * QUICK * sizes.time > 1.0


def _payload(p: Mapping[str, float], sizes: Sizes) -> bool:
    """Mass that is there; less of it than believed is a wrong value, not a payload."""
    return p["mass_kg"] > 0.0


def _time_offset(p: Mapping[str, float], sizes: Sizes) -> bool:
    """Nothing is read before it happens; where one of two streams is early, the other one is late."""
    return p["delay_s"] > 0.0


RULES: Mapping[str, Rule] = {
    "stribeck_friction": _stribeck,
    "end_stop": _end_stop,
    "low_pass": _low_pass,
    "payload": _payload,
    "time_offset": _time_offset,
}
"""By effect; those without a rule say all with the bounds of their parameters."""


def plausible(sites: Sequence[Site], values: Mapping[str, float], sizes: Mapping[str, Sizes]) -> bool:
    """Whether every effect, with its fitted numbers, is what its name says."""
    if redundant(sites):
        return False
    for site in sites:
        rule = RULES.get(site.effect.name)
        own = {p.name: values[site.key(p.name)] for p in site.effect.parameters}
        if rule is not None and not rule(own, sizes.get(site.where, sizes[""])):
            return False
    return True


def redundant(sites: Sequence[Site]) -> bool:
    """Whether one place has two laws of dry friction."""
    places = [s.where for s in sites if s.effect.name in DRY]
    return len(places) != len(set(places))
