"""Free parameters of a fit, each a number of order one with an explicit scale."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.effects.effect import Parameter

LOG_STEP = 0.25
"""Change of a logarithmic parameter, in natural logs, that counts as one unit."""


UNHELD = 0.15
"""Step of an absorbing constant that no sigma holds, as a share of it."""

TIMES_STATED = "times what each trial states"
"""In place of a unit: of a believed value that the study gives trial by trial, the factor on what each says."""


@dataclass(frozen=True)
class Free:
    """One free parameter, z = 0 at its centre unless it is counted from elsewhere.

    Attributes:
        key: dotted value name, "condition|name" for a scatter, or "effect@where.parameter".
        kind: "believed", "unknown", "absorbing", "zero", "scatter" or "effect".
        centre: value at z = 0, where that is counted from nothing.
        step: change of the value per unit of z (of its logarithm if `log`).
        prior: precision of z's normal prior about 0; none at 0.
        log: value = centre * exp(step * z).
        lower, upper: bounds of the value.
        stated: False where the study gives each trial its own value: the value here is a factor on those.
        about: what z is counted from: by so much it would be larger, counted from the centre.
    """

    key: str
    kind: str
    centre: float
    step: float
    prior: float = 0.0
    log: bool = False
    lower: float = -math.inf
    upper: float = math.inf
    stated: bool = True
    about: float = 0.0

    def value(self, z: float) -> float:
        """The physical value at z, within the bounds."""
        z += self.about
        raw = self.centre * math.exp(min(self.step * z, 700.0)) if self.log else self.centre + self.step * z
        return min(max(raw, self.lower), self.upper)

    def z(self, value: float) -> float:
        """The z of a physical value."""
        if self.log:
            return math.log(max(value, 1e-300) / self.centre) / self.step - self.about
        return (value - self.centre) / self.step - self.about

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds in z."""
        if self.log:
            low = -math.inf if self.lower <= 0.0 else self.z(self.lower)
            return low, math.inf if math.isinf(self.upper) else self.z(self.upper)
        return self.z(self.lower), self.z(self.upper)

    def slope(self, z: float) -> float:
        """d value / d z."""
        return self.step * self.value(z) if self.log else self.step


LEAST = 0.05
"""Share of what is believed of a value that is left of it, at the least: fits that go through nothing end elsewhere."""


def believed(name: str, value: float | None, sigma: float, prior: float = 1.0, *, to_nothing: bool = False) -> Free:
    """A believed value with its stated relative deviation; None where each trial states its own.

    Args:
        name: dotted.
        value: what is believed.
        sigma: relative deviation.
        prior: precision of its deviation, counted in sigma: less than 1 for a value that is given up.
        to_nothing: it may be zero, as one that is given up.
    """
    centre = 1.0 if value is None else value
    least = 0.0 if to_nothing and value is not None else LEAST * centre
    lower = least if centre > 0.0 else -math.inf
    return Free(name, "believed", centre, abs(centre) * sigma, prior=prior, lower=lower, stated=value is not None)


def around_zero(name: str, sigma: float, lower: float = -math.inf, upper: float = math.inf) -> Free:
    """A value believed to be zero, with its standard deviation in its own unit."""
    return Free(name, "believed", 0.0, sigma, prior=1.0, lower=lower, upper=upper)


def absorbing(name: str, value: float, sigma: float = UNHELD, lower: float = 0.0) -> Free:
    """A constant whose job is to absorb, free because an effect replaces it or because nothing holds it."""
    return Free(name, "absorbing", value, max(abs(value) * sigma, 0.05), lower=lower)


def zero(channel: str, sigma: float) -> Free:
    """Where a channel's readings are to be zero, found by the lab with this standard deviation."""
    return Free(zero_key(channel), "zero", 0.0, sigma, prior=1.0)


def zero_key(channel: str) -> str:
    """Key of a channel's zero among the free parameters; of "CHANNEL|COLUMN", of the column's factor beyond its own.

    "CHANNEL|" is the channel's zero too.
    """
    name, _, column = channel.partition("|")
    return f"{channel}.factor" if column else f"{name}.zero"


def unknown(name: str, centre: float) -> Free:
    """A positive value that the study does not state."""
    return Free(name, "unknown", centre, LOG_STEP, log=True, lower=1e-3 * centre, upper=1e3 * centre)


def scatter(condition: str, name: str, sigma: float) -> Free:
    """A condition's own relative change of a believed value; its value is a factor."""
    return Free(f"{condition}|{name}", "scatter", 1.0, sigma, prior=1.0, lower=0.2)


def of_effect(effect: str, where: str, parameter: Parameter, start: float) -> Free:
    """A parameter of an effect, centred on a start value."""
    key = f"{effect}@{where}.{parameter.name}"
    if parameter.log:
        return Free(key, "effect", start, LOG_STEP, log=True, lower=parameter.lower, upper=parameter.upper)
    return Free(
        key,
        "effect",
        0.0 if math.isinf(parameter.null) else parameter.null,
        parameter.scale,
        lower=parameter.lower,
        upper=parameter.upper,
    )
