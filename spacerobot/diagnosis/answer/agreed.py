"""One physical value has one value: what several parts tell of one thing that all of them feel, as one entry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from msgspec import UNSET
from msgspec.structs import replace

from spacerobot.diagnosis.answer.record import Effect, Value
from spacerobot.diagnosis.fitting.fitted import NORMAL_95
from spacerobot.diagnosis.fitting.pooled import pooled
from spacerobot.effects.registry import all_effects


def agreed(found: Sequence[Effect]) -> list[Effect]:
    """The same effects; those that all parts feel together once for each place, with the parts' common value.

    Of one that a single part tells of, that part is still said.
    """
    out: list[Effect] = []
    together = {e.name for e in all_effects().values() if e.together}
    for one in found:
        if one.effect not in together:
            out.append(one)
            continue
        every = [e for e in found if (e.effect, e.where) == (one.effect, one.where)]
        if one is every[0]:
            parameters = {name: _common([e.parameters[name] for e in every]) for name in one.parameters}
            out.append(one if len(every) == 1 else replace(one, parameters=parameters, part=UNSET))
    return out


def _common(values: Sequence[Value]) -> Value:
    """Weighted mean of what several parts tell, its interval as wide as their differences ask for (Birge 1932)."""
    told = [(float(v.value or 0.0), error) for v in values if np.isfinite(error := error_of(v))]
    if len(told) < 2:
        return values[0]
    common = pooled(*zip(*told, strict=True))
    wider = max(common.scatter / common.error / (len(told) - 1) ** 0.5, 1.0)
    return within(replace(values[0], value=common.value), wider * common.error)


def within(value: Value, error: float) -> Value:
    """A value with this standard error."""
    middle, half = float(value.value or 0.0), NORMAL_95 * error
    return replace(value, ci95=(middle - half, middle + half))


def error_of(value: Value) -> float:
    """Standard error of a value; infinite where nothing is told of it."""
    low, high = value.ci95 or (None, None)
    return np.inf if low is None or high is None else 0.5 * (float(high) - float(low)) / NORMAL_95
