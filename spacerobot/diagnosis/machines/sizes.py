"""The typical sizes of a recording, and effects with their parameters scaled to them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.sizes import Sizes

SMALL = 0.05
"""A fit's unit step of a parameter, as a share of its typical size."""

STIFF = 50.0
"""Stiffness at which a stop is screened, in units of a spring that the typical force bends by the typical length; a fit
begins at the share of it that would do."""

SPREAD = 1.0 / 3.0
"""Standard deviation of what a hit moves in a trial over its peak, and such a time over the spring's own: that of half
a sine in a recording some four times as long."""

USUAL = Sizes(force=5.5, length=3.5e-3, time=0.04)
"""Of the wrist rigs for which the catalogue's own scales and starts are written: geometric means over the campaigns
that are bundled and proved on."""

ALIKE = 10.0**0.5
"""A rig whose sizes are so many times larger or smaller at most is one of those: starts lie a factor of some five
apart."""


def sizes_of(force: np.ndarray, position: np.ndarray, velocity: np.ndarray, reading: float | None = None) -> Sizes:
    """Sizes from what was recorded, any shape each: rms of force, of position about its mean, of velocity."""
    length = float(np.std(position))
    return Sizes(
        force=float(np.sqrt(np.mean(np.square(force)))),
        length=length,
        time=length / float(np.sqrt(np.mean(np.square(velocity)))),
        reading=length if reading is None else reading,
    )


def sizes_of_hits(trials: Sequence[TrialData], values: Mapping[str, float], rates: Sequence[float]) -> Sizes:
    """Sizes at a wrist that targets hit: how far it moves, and against what, as their speed has it.

    Args:
        trials: of the rig; from what reads the wrist or the contact's force, or from the speeds where nothing does.
        values: of the baseline, by name.
        rates: speeds of the targets [m/s], where their tracks were read.
    """
    spring = values.get("wrist.stiffness", 1.0)
    masses = [t.overrides.get("target.mass", values.get("target.mass", 1.0)) for t in trials]
    natural = SPREAD * math.sqrt(float(np.median(masses)) / spring)
    speed = float(np.sqrt(np.mean(np.square(rates)))) if rates else 0.0
    length = spread(trials, "wrist.x") or spread(trials, "contact.force") / spring or speed * natural
    time = length / speed if length > 0.0 and speed > 0.0 else natural
    return Sizes(spring * max(length, 1e-9), max(length, 1e-9), max(time, 1e-9))


def spread(trials: Sequence[TrialData], channel: str) -> float:
    """Standard deviation of all good readings of a channel; 0 where nothing reads it."""
    shown = [t.channel(channel) for t in trials if channel in t.channels]
    good = [value[weight > 0.0] for _, value, weight in shown]
    return float(np.std(np.concatenate(good))) if any(x.size for x in good) else 0.0


def scaled(effect: Effect, sizes: Sizes) -> Effect:
    """The same effect, with its parameters' scales and starts of these sizes; null values and bounds are kept.

    A learned law knows its own.
    """
    if effect.learned:
        return effect
    parameters = [_scaled(p, sizes) for p in effect.parameters]
    if any(p.reach for p in parameters):  # what acts beyond a displacement is not soft
        parameters = [p if p.shape else replace(p, starts=(STIFF * sizes.of(p.unit),)) for p in parameters]
    return effect.with_parameters(parameters)


def beside_usual(effect: Effect, sizes: Sizes) -> Effect:
    """The same effect, its parameters' scales and starts larger by what a rig of these sizes is larger than the usual;
    itself where the rig is one of those.
    """
    pairs = ((sizes.force, USUAL.force), (sizes.length, USUAL.length), (sizes.time, USUAL.time))
    if all(usual / ALIKE < size < usual * ALIKE for size, usual in pairs):
        return effect
    return effect.with_parameters(_times(p, sizes.of(p.unit) / USUAL.of(p.unit)) for p in effect.parameters)


def _times(parameter: Parameter, factor: float) -> Parameter:
    if parameter.unit in ("1", "channel unit"):
        return parameter
    starts = tuple(min(max(factor * s, parameter.lower), parameter.upper) for s in parameter.starts)
    return replace(parameter, scale=factor * parameter.scale, starts=tuple(dict.fromkeys(starts)))


def _scaled(parameter: Parameter, sizes: Sizes) -> Parameter:
    if parameter.unit == "1":
        return parameter
    size = sizes.of(parameter.unit)
    if parameter.unit == "s":  # delays are short against the motion, and no more than tenths of it
        starts = [0.05 * size, -0.05 * size, 0.3 * size]
    elif parameter.unit == "Hz":
        starts = [1.0 * size, 0.3 * size, 3.0 * size]
    elif parameter.log and parameter.shape:  # known to no power of ten
        starts = [1.0 * size, 0.1 * size, 10.0 * size]
    else:
        starts = [0.1 * size, -0.1 * size, 0.5 * size]
    within = tuple(s for s in starts if parameter.lower <= s <= parameter.upper) or parameter.starts
    return replace(parameter, scale=SMALL * size, starts=within)
