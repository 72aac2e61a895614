"""Analogue low-pass filters as sums of first-order ones, so that whatever runs one of them runs all."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

import numpy as np

from spacerobot.effects.effect import Effect
from spacerobot.effects.form import FormOf
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap

ORDERS = (1, 2, 4)
ANALOGUE = ("butterworth", "bessel")
BOTH_WAYS = "zero_phase"
"""Butterworth forwards and backwards over a finished recording, as tracking software does: 6 dB down at the cutoff."""

KINDS = (*ANALOGUE, BOTH_WAYS)

PLAIN = "low_pass"
"""Name of the effect of which these are forms, and of the map that it puts on a channel."""

INNATE = 0.8
"""Share of half the rate from which on a filter without delay is the sensor's own. Anti-alias filters of data
acquisition end at 0.8 to 0.9 of it."""


@functools.cache
def first_orders(order: int, kind: str) -> tuple[tuple[complex, complex], ...]:
    """Rates (in units of 2 pi times the cutoff) and gains of the first-order filters that add up to one of any order.

    H(s) = sum_k g_k / (1 + s / r_k); complex ones come in conjugate pairs, the gains add up to 1. The cutoff is where
    the gain is 3 dB down (a data sheet's bandwidth), of both kinds.

    Args:
        order: of the filter; all kinds of the first order are one.
        kind: "butterworth" (flattest gain), "bessel" (flattest delay) or "zero_phase", of which this is one way.

    Source: residues of the analogue prototypes (e.g. Oppenheim and Schafer 2010, App. B).
    """
    from scipy.signal import bessel, butter

    if order == 1:
        return ((1.0 + 0j, 1.0 + 0j),)
    named = bessel(order, 1.0, analog=True, norm="mag", output="zpk") if kind == "bessel" else None
    _, poles, gain = named or butter(order, 1.0, analog=True, output="zpk")
    found = []
    for k, p in enumerate(poles):
        residue = gain / np.prod(p - np.delete(poles, k))
        found.append((complex(-p), complex(-residue / p)))
    return tuple(found)


def summed(form: tuple[int, str], respond: Callable[[complex | float], np.ndarray]) -> np.ndarray:
    """Output of a filter, shape (T,), from what `respond` makes of its input by a first-order one of each rate.

    Of each conjugate pair one is asked for, and counts twice with its real part.
    """
    parts = [
        (2.0 if rate.imag else 1.0) * (gain * respond(rate if rate.imag else rate.real)).real
        for rate, gain in first_orders(*form)
        if rate.imag >= 0.0
    ]
    return np.asarray(sum(parts))


def filter_of(channel: str, cutoff: float, order: int, kind: str) -> ChannelMap:
    """A channel read through a filter of this cutoff [Hz]."""
    return ChannelMap(channel, PLAIN, cutoff, form=(order, kind))


class HigherOrder(FormOf):
    """A low-pass filter of another form than the plain one: of the same thing, though it equals it at no cutoff."""

    def __init__(self, plain: Effect, form: str) -> None:
        order, kind = form.split("_", 1)
        how = kind.capitalize() if kind in ANALOGUE else "forwards and backwards"
        self.form = int(order), kind
        super().__init__(
            plain,
            form,
            title=f"{plain.title} ({how}, order {order})",
            phrase=f"{plain.phrase} ({how}, order {order})",
            formula=r"H(s) = \sum_k \frac{g_k}{1 + s / (2\pi f_c r_k)},\; |H(2\pi i f_c)|^2 = \tfrac{1}{2}",
            source=f"filter of order {order}, {how}",
            refines=(plain.name,),
            settings={"order": float(order), "kind": kind},
        )

    def innate(self, values: Mapping[str, float], rate: float) -> bool:
        """Readings without delay that end near half of the rate: what sampling asks for."""
        (cutoff,) = values.values()
        return self.form[1] == BOTH_WAYS and cutoff >= INNATE * 0.5 * rate

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The filter on each of the sensor's channels."""
        (value,) = values.values()
        return mechanism.with_map(*(filter_of(c, value, *self.form) for c in mechanism.sensors[where]))
