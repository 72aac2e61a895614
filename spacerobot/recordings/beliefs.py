"""How well a lab knows what it believes of a wrist rig: as it says, and by one rule where it says nothing.

A value without a sigma is known to UNSTATED, unless it cannot be so: geometry, gravity and travel are exact, and a
constant whose job is to absorb what is not modelled is no measurement, so that it is free, and with it whatever adds
to it. `exact` holds a value as it is stated.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from spacerobot.recordings.study import Study

UNSTATED = 0.02
"""One standard deviation, relative, of a value whose own is not stated: a kitchen scale, a spring's data sheet."""

ABSORBING: Mapping[str, str] = {"wrist.equivalent_damping": "wrist.damping"}
"""Constants whose job is to absorb -> the value that adds to it: no recording tells the two apart."""

MEASURED = ("mass", "stiffness", "damping", "yaw_inertia")
"""Last words of what a lab measures with an error worth a word; all else is geometry, or a law's choice."""


@dataclass(frozen=True)
class Beliefs:
    """What is known of a rig's values, and how well.

    Attributes:
        sigma: relative standard deviations by dotted name, stated or by the rule.
        assumed: those of them that are by the rule.
        free: constants whose job is to absorb that nothing holds -> how far each may fall [its unit]: below zero where
            what adds to it is no better known.
    """

    sigma: Mapping[str, float]
    assumed: tuple[str, ...]
    free: Mapping[str, float]

    def words(self) -> tuple[str, ...]:
        """What was assumed, a sentence each; none where everything is stated."""
        said = []
        if self.assumed:
            said.append(f"no sigma stated, so taken as known to {UNSTATED:.0%}: {', '.join(self.assumed)}")
        for name in self.free:
            beside = f", {ABSORBING[name]} with it" if self.free[name] < 0.0 else ""
            said.append(f"{name} has no sigma and is there to absorb, so it is fitted freely{beside}")
        return tuple(said)


def beliefs_of(study: Study, names: Collection[str]) -> Beliefs:
    """How well the values of a rig are known.

    Args:
        study: what the lab says.
        names: the values that its rig is made of.
    """
    values, held, stated = study.values(), study.baseline.exact, {**study.absolute, **study.sigma}
    everywhere = [n for n in names if n in values or all(n in t.overrides for t in study.trials)]
    sigma: dict[str, float] = {n: s for n, s in study.sigma.items() if n in names and n not in held}
    free: dict[str, float] = {}
    beside = set()
    for name, added in ABSORBING.items():
        if name not in values or name in held:
            continue
        if added not in stated and added not in held:
            beside.add(added)  # its uncertainty is the constant's
        if name not in stated:
            free[name] = -values.get(added, 0.0) if added in beside else 0.0
    assumed = tuple(
        n
        for n in everywhere
        if n.rsplit(".", 1)[-1] in MEASURED
        and n not in {*stated, *held, *free, *beside}
        and values.get(n, 1.0) != 0.0  # no share of nothing is anything
    )
    return Beliefs({**sigma, **dict.fromkeys(assumed, UNSTATED)}, assumed, free)
