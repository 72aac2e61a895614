"""The evidence of a diagnosis as reports read it: JSON-ready lists become arrays, what is absent becomes empty."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spacerobot.support.errors import InputError
from spacerobot.view.report.words import finite, floating

Array = NDArray[np.float64]


def _array(values: Any, what: str) -> Array:
    if values is None:
        return np.zeros(0)
    try:
        return np.array([math.nan if v is None else float(v) for v in values])
    except (TypeError, ValueError) as error:
        raise InputError(f"evidence: {what} is not a list of numbers", given=str(values)[:60]) from error


@dataclass(frozen=True)
class Trace:
    """One channel of one trial: measured, predicted by the refitted baseline and by the chosen model.

    Attributes:
        sigma: known noise of the sensor, in the channel's unit; None if unknown.
        time, measured, before, after: (n,), seconds and the channel's unit, NaN where there is no sample; `before`
            or `after` may be empty.
        held_out: the trial took no part in the fit that predicts it.
    """

    trial: str
    condition: str
    channel: str
    unit: str
    sigma: float | None
    time: Array
    measured: Array
    before: Array
    after: Array
    held_out: bool = False

    def __post_init__(self) -> None:
        n = len(self.time)
        for name in ("measured", "before", "after"):
            if len(getattr(self, name)) not in ({n} if name == "measured" else {0, n}):
                raise InputError(
                    f"evidence: trace of {self.channel} in trial {self.trial}: {name} differs in length from time",
                    given=len(getattr(self, name)),
                    valid=str(n),
                )

    @property
    def scale(self) -> float:
        """What residuals are divided by: sigma, or 1 (the unit itself) where it is unknown."""
        return self.sigma if self.sigma is not None and self.sigma > 0.0 and math.isfinite(self.sigma) else 1.0

    def residual(self, which: str) -> Array:
        """(n,) predicted minus measured over `scale`; empty if that prediction is absent."""
        predicted: Array = getattr(self, which)
        return (predicted - self.measured) / self.scale if len(predicted) else np.zeros(0)

    def rms(self, which: str) -> float | None:
        """Root mean square of `residual`, over the samples that exist."""
        values = self.residual(which)
        values = values[np.isfinite(values)]
        return float(np.sqrt(np.mean(values**2))) if len(values) else None

    @property
    def gain(self) -> float:
        """By how much the chosen model is nearer than the baseline, in `scale`."""
        before, after = self.rms("before"), self.rms("after")
        return (before - after) if before is not None and after is not None else -math.inf


@dataclass(frozen=True)
class Surface:
    """A residual force against what it depends on, with error bars; all arrays (n,)."""

    balance: str
    quantity: str
    unit: str
    y_unit: str
    x: Array
    y: Array
    error: Array


@dataclass(frozen=True)
class Evidence:
    """Everything beside the verdict that a report shows; each part may be empty."""

    title: str = ""
    trials: tuple[Mapping[str, Any], ...] = ()
    channels: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    traces: tuple[Trace, ...] = ()
    hypotheses: tuple[Mapping[str, Any], ...] = ()
    located: tuple[Mapping[str, Any], ...] = ()
    surfaces: tuple[Surface, ...] = ()
    whiteness: tuple[Mapping[str, Any], ...] = ()
    formulas: tuple[Mapping[str, Any], ...] = ()
    checks: tuple[Mapping[str, Any], ...] = ()
    timing: Mapping[str, Any] = field(default_factory=dict)
    body: str = "target"  # what the study calls what floats

    def with_body(self) -> Evidence:
        """The same with what floats called as the study calls it."""
        if self.body == "target":
            return self

        def renamed(item: Mapping[str, Any], key: str) -> dict[str, Any]:
            return {**item, key: floating(str(item.get(key) or ""), self.body)}

        return replace(
            self,
            hypotheses=tuple(
                {**h, "effects": [renamed(e, "where") for e in h.get("effects") or ()]} for h in self.hypotheses
            ),
            located=tuple(renamed(r, "balance") for r in self.located),
            surfaces=tuple(replace(s, balance=floating(s.balance, self.body)) for s in self.surfaces),
            formulas=tuple(renamed(f, "where") for f in self.formulas),
        )

    def without_after(self) -> Evidence:
        """The same without a second model's predictions: where none is named, the baseline's are what there is."""
        return replace(self, traces=tuple(replace(t, after=np.zeros(0)) for t in self.traces))

    @property
    def shown(self) -> tuple[Trace, ...]:
        """The held-out traces, or all where none is held out."""
        held = tuple(t for t in self.traces if t.held_out)
        return held or self.traces


def read_evidence(data: Mapping[str, Any]) -> Evidence:
    """Evidence from the JSON-ready dict that the diagnosis hands over.

    Raises:
        InputError: a trace whose lists differ in length, or a list that is not of numbers.
    """
    study = data.get("study") or {}
    return Evidence(
        title=str(study.get("title") or ""),
        trials=_dicts(study.get("trials")),
        channels=dict(study.get("channels") or {}),
        traces=tuple(_trace(item) for item in _dicts(data.get("traces"))),
        hypotheses=_dicts(data.get("hypotheses")),
        located=_dicts(data.get("located")),
        surfaces=tuple(s for s in (_surface(item) for item in _dicts(data.get("surfaces"))) if len(s.x)),
        whiteness=_dicts(data.get("whiteness")),
        formulas=_dicts(data.get("formulas")),
        checks=_dicts(data.get("checks")),
        timing=dict(data.get("timing") or {}),
        body=str(study.get("body") or "target"),
    )


def _dicts(items: Any) -> tuple[Mapping[str, Any], ...]:
    if items is None:
        return ()
    if not isinstance(items, Sequence) or not all(isinstance(item, Mapping) for item in items):
        raise InputError("evidence: expected a list of tables", given=str(items)[:60])
    return tuple(items)


def _trace(item: Mapping[str, Any]) -> Trace:
    name = f"trace of {item.get('channel')} in trial {item.get('trial')}"
    return Trace(
        trial=str(item.get("trial", "")),
        condition=str(item.get("condition") or ""),
        channel=str(item.get("channel", "")),
        unit=str(item.get("unit") or ""),
        sigma=finite(item.get("sigma")),
        held_out=bool(item.get("held_out", False)),
        **{key: _array(item.get(key), f"{key} of the {name}") for key in ("time", "measured", "before", "after")},
    )


def _surface(item: Mapping[str, Any]) -> Surface:
    x, y, error = (_array(item.get(key), f"{key} of a surface") for key in ("x", "y", "error"))
    error = error if len(error) else np.zeros(len(x))
    if not len(x) == len(y) == len(error):
        raise InputError("evidence: a surface's lists differ in length", given=[len(x), len(y), len(error)])
    return Surface(
        balance=str(item.get("balance", "")),
        quantity=str(item.get("quantity", "")),
        unit=str(item.get("unit") or ""),
        y_unit=str(item.get("y_unit") or ""),
        x=x,
        y=y,
        error=error,
    )
