"""The low-pass filter that a sensor is known to have: an amplifier's, a tracking program's."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spacerobot.effects.filters import KINDS, ORDERS
from spacerobot.recordings.document import Document
from spacerobot.support.errors import InputError

KEYS = ("cutoff", "order", "kind")


@dataclass(frozen=True)
class SensorFilter:
    """A filter as its data sheet has it.

    Attributes:
        cutoff: where its gain is 3 dB down, of one that runs both ways 6 dB [Hz].
        order: 1, 2 or 4; of one that runs both ways that of each way.
        kind: "butterworth", "bessel" or "zero_phase" (Butterworth, forwards and backwards).
    """

    cutoff: float
    order: int = 1
    kind: str = KINDS[0]


def read_filter(document: Document, spec: Mapping[str, Any], *path: str) -> SensorFilter | None:
    """`filter = { cutoff = 2000, order = 2, kind = "butterworth" }` of a channel; None where it has none.

    Raises:
        InputError: a key or value that no filter has, with its line.
    """
    if "filter" not in spec:
        return None
    given = document.table(spec, "filter", *path)
    path = (*path, "filter")
    document.check_keys(given, KEYS, *path)
    where = document.where(*path)
    if "cutoff" not in given:
        raise InputError("a filter needs its cutoff", valid="filter = { cutoff = 2000 } [Hz]", where=where)
    cutoff = document.number(given["cutoff"], *path, "cutoff")
    if not (math.isfinite(cutoff) and cutoff > 0.0):
        raise InputError("the cutoff of a filter must be positive", given=cutoff, valid="Hz", where=where)
    order, kind = given.get("order", 1), document.text(given, "kind", KINDS[0], *path)
    if order not in ORDERS or isinstance(order, bool):
        raise InputError("no such order of a filter", given=order, valid=", ".join(map(str, ORDERS)), where=where)
    if kind not in KINDS:
        raise InputError("no such kind of filter", given=kind, valid=", ".join(KINDS), where=where)
    return SensorFilter(cutoff, int(order), kind)
