"""Hiding physics in an arm's joint logs, one way for each kind of concealment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spacerobot.proof.conceal import STRONG
from spacerobot.proof.draws import by_factors
from spacerobot.proof.driven.arm import Log, inertias, joints
from spacerobot.proof.driven.campaign import LAST_SIGMA, ROTOR_SIGMA, Campaign, drawn
from spacerobot.proof.driven.hidden import KNOWN, OUTSIDE, draw
from spacerobot.proof.driven.strength import Yardstick
from spacerobot.proof.orders import Order

PLAIN = (12.0, 60.0)
"""Strengths between which what is in no catalogue is drawn: enough that it must not be overlooked."""

OFF = (6.0, 12.0)
"""Standard deviations of the believed value by which it is wrong."""


@dataclass(frozen=True, eq=False)
class Concealed:
    """A campaign ready to be sealed.

    Attributes:
        campaign: with what is hidden in it.
        logs: without noise.
        expected: "named", "wrong_parameter", "nothing_missing" or "unknown": what an honest answer says.
        parameters: believed values that are wrong.
        strength: size in detection limits, None where nothing is hidden.
    """

    campaign: Campaign
    logs: Mapping[str, Log]
    expected: str
    parameters: tuple[str, ...] = ()
    strength: float | None = None

    def truth(self) -> dict[str, Any]:
        """What the seal holds."""
        return {
            "effects": [m.as_json() for m in self.campaign.hidden],
            "expected": self.expected,
            "parameters": list(self.parameters),
            "withheld": None,
            "strength": self.strength,
        }


def conceal(order: Order) -> Concealed:
    """Make the campaign of an order.

    Raises:
        SimulationError: the arm could not be run.
    """
    rng = np.random.default_rng(order.seed)
    return MAKERS[order.kind](rng)


def _nothing(rng: np.random.Generator) -> Concealed:
    plain = drawn(rng)
    return Concealed(plain, plain.logs(), "nothing_missing")


def _wrong_value(rng: np.random.Generator) -> Concealed:
    """A tool on the last link that nobody wrote down, or a rotor heavier than its data sheet."""
    plain = drawn(rng)
    times = float(rng.uniform(*OFF))
    if rng.random() < 0.5:
        last = list(plain.masses)[-1]
        share = 1.0 + times * LAST_SIGMA
        changed = replace(plain, masses={**plain.masses, last: plain.masses[last] * share})
        return Concealed(changed, changed.logs(), "wrong_parameter", (f"link.{last}.mass",))
    joint = str(rng.choice(joints()))
    more = times * ROTOR_SIGMA * inertias()[joint]
    changed = replace(plain, rotors={**plain.rotors, joint: plain.rotors[joint] + more})
    return Concealed(changed, changed.logs(), "wrong_parameter", (f"joint.{joint}.mass",))


def _unlabelled(rng: np.random.Generator) -> Concealed:
    return _hidden(rng, [str(rng.choice(KNOWN))], "named", STRONG)


def _two(rng: np.random.Generator) -> Concealed:
    """At two joints, each as strong as a single one."""
    return _hidden(rng, [str(n) for n in rng.choice(KNOWN, 2)], "named", (6.0, STRONG[1]))


def _outsider(rng: np.random.Generator) -> Concealed:
    return _hidden(rng, [str(rng.choice(OUTSIDE))], "unknown", PLAIN)


def _hidden(rng: np.random.Generator, effects: list[str], expected: str, between: tuple[float, float]) -> Concealed:
    plain = drawn(rng)
    logs = plain.logs()
    places = [str(j) for j in rng.choice(joints(), len(effects), replace=False)]
    yardstick = Yardstick(plain, logs)
    items, strengths = [], []
    for effect, joint in zip(effects, places, strict=True):
        kind = draw(effect, joint, rng)
        limits = by_factors(rng, *between)
        items.append(kind(limits / yardstick.limits_at_one(kind)))
        strengths.append(limits)
    changed = replace(plain, hidden=tuple(items))
    return Concealed(changed, changed.logs(), expected, strength=min(strengths))


MAKERS: dict[str, Callable[[np.random.Generator], Concealed]] = {
    "nothing_missing": _nothing,
    "wrong_value": _wrong_value,
    "unlabelled": _unlabelled,
    "two": _two,
    "outsider": _outsider,
}
