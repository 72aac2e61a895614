"""What verdict.json says, as one typed record: it is written out once, and its JSON Schema is made from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal, TypeAlias

import msgspec
from msgspec import UNSET, Meta, UnsetType

from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.kinds import Kind, LeadsTo, Told
from spacerobot.effects.effect import said_name
from spacerobot.support.jsonio import plain

FORMAT: Final = 1
"""Of verdict.json. A new kind of verdict, and a key that no format promises yet, raise it."""

Number: TypeAlias = float | Literal["inf", "-inf"]
Measure: TypeAlias = Number | None
Interval: TypeAlias = tuple[Measure, Measure] | None
Name: TypeAlias = Annotated[str, Meta(min_length=1)]
Share: TypeAlias = Annotated[float, Meta(ge=0.0, le=1.0)]
Count: TypeAlias = Annotated[int, Meta(ge=0)]


class Record(msgspec.Struct, frozen=True, kw_only=True):
    """A piece of the answer; what is UNSET is not written."""


class Value(Record, frozen=True, kw_only=True):
    """A number with its 95 % interval, both in the unit stated."""

    value: Number
    ci95: Interval
    unit: Annotated[str, Meta(description="of value and ci95")]


class Placed(Record, frozen=True, kw_only=True):
    """An effect at a place."""

    effect: Name
    where: Name


class Effect(Placed, frozen=True, kw_only=True):
    """An effect at a place, with what was fitted of it."""

    parameters: dict[str, Value]
    trials: (
        Annotated[list[str], Meta(min_length=1, description="the only trials in which it acts; all if absent")]
        | UnsetType
    ) = UNSET
    kind: (
        Annotated[
            str,
            Meta(description="of a filter: butterworth, bessel or zero_phase; of a stop on one side: above or below"),
        ]
        | UnsetType
    ) = UNSET
    part: Annotated[str, Meta(description="of several joints, bodies or axes, which lacks it")] | UnsetType = UNSET


class Alternative(Record, frozen=True, kw_only=True):
    """A set of effects that may stand in place of what is said."""

    effects: list[Placed]
    parameters: Annotated[dict[str, Number], Meta(description="values that would be wrong instead, SI")]
    score: Annotated[Measure, Meta(description="penalised log likelihood below the best [1]")]
    part: str | UnsetType = UNSET


class Believed(Value, frozen=True, kw_only=True):
    """A believed value that the data move; believed and sigma in the same unit."""

    believed: Annotated[Number, Meta(description="in the unit of value")]
    sigma: Annotated[Measure, Meta(description="one standard deviation of the belief, in the unit of value")]


class Moved(Record, frozen=True, kw_only=True):
    """A believed value that was free in the fit."""

    value: Annotated[Number, Meta(description="SI, or in the unit stated")]
    believed: Annotated[Number, Meta(description="SI, or in the unit stated")]
    in_sigmas: Annotated[Measure, Meta(description="value minus believed, in its stated sigmas [1]")]
    unit: Annotated[str, Meta(description="where not that of the name")] | UnsetType = UNSET


class Pattern(Record, frozen=True, kw_only=True):
    """Where recording and model part, and on what the difference depends."""

    balance: str
    phase: str
    depends_on: str | None
    share: Annotated[Measure, Meta(description="of the residual's square that it explains [1]")]
    p: Annotated[Share | None, Meta(description="of being noise, a probability [1]")]


_ERROR_UNIT = "of a channel: SI; overall and in folds: in sensor sigmas, or shares of the spread where unit says so [1]"


class Errors(Record, frozen=True, kw_only=True):
    """Root mean squares of what is held out: by the baseline, the chosen set, and what each fold chose itself."""

    rms_before: Annotated[Measure, Meta(description=_ERROR_UNIT)]
    rms_after: Annotated[Measure, Meta(description=_ERROR_UNIT)]
    rms_selected: Annotated[Measure, Meta(description=_ERROR_UNIT)] | UnsetType = UNSET


class Overall(Errors, frozen=True, kw_only=True):
    """Of all channels together."""

    noise_floor: Annotated[Measure, Meta(description="in the unit of the errors beside it [1]")]
    chi2_before: Annotated[Measure, Meta(description="per sample [1]")]
    chi2_after: Annotated[Measure, Meta(description="per sample [1]")]
    chi2_selected: Annotated[Measure, Meta(description="per sample [1]")] | UnsetType = UNSET


class Fold(Errors, frozen=True, kw_only=True):
    """What was decided without some of the trials."""

    left_out: list[str]
    selected: list[Placed]
    leads_to: LeadsTo
    part: str | UnsetType = UNSET


class NotForetold(Record, frozen=True, kw_only=True):
    """A trial that could not be predicted."""

    trial: str
    model: Told
    why: str
    part: str | UnsetType = UNSET


class HeldOut(Record, frozen=True, kw_only=True):
    """Errors on trials that were kept aside: by channel in SI, over all in sensor sigmas or shares of the spread."""

    scheme: str | None
    channels: dict[str, Errors]
    overall: Overall
    unit: Literal["sigma", "spread"] | UnsetType = UNSET
    decided: str | UnsetType = UNSET
    taken_from_unseen: list[str] | UnsetType = UNSET
    same_set: Annotated[Count, Meta(description="folds that chose the same set [1]")] | UnsetType = UNSET
    folds: list[Fold] | UnsetType = UNSET
    failed: list[NotForetold] | UnsetType = UNSET


class Instead(Placed, frozen=True, kw_only=True):
    """What a smaller one would not be told from; beside: two together."""

    beside: Placed | UnsetType = UNSET


class Detectable(Placed, frozen=True, kw_only=True):
    """The smallest size of an effect that these data would show, in its own unit."""

    parameter: str
    smallest: Measure
    unit: Annotated[str, Meta(description="of smallest")]
    instead: Instead | UnsetType = UNSET
    part: str | UnsetType = UNSET


class NextExperiment(Record, frozen=True, kw_only=True):
    """A trial that would separate two explanations."""

    change: Annotated[dict[str, float | str], Meta(description="what to change, by dotted name, SI")]
    separates: list[list[Placed]]
    why: str
    part: str | UnsetType = UNSET


class NotPredicted(Record, frozen=True, kw_only=True):
    """A recorded channel that no model predicts or takes as given."""

    channel: str
    unit: str
    use: str
    stream: str
    trials: Annotated[Count, Meta(description="that have it [1]")]


class Event(Record, frozen=True, kw_only=True):
    """When something touched an arm, on the clock of the named stream."""

    event: str
    trial: str
    seen_in: str
    clock: str
    time_s: Annotated[Value, Meta(description="[s]")]


class ClockOffset(Effect, frozen=True, kw_only=True):
    """By how much a stream's own clock is late against another's, as the effect time_offset."""

    trial: str
    against: str
    why: str


class Spoiled(Record, frozen=True, kw_only=True):
    """Readings of a channel in a trial that were left out, and why; the first of their times on the stream's clock."""

    trial: str
    channel: str
    why: str
    readings: Annotated[Count, Meta(description="how many [1]")]
    times_s: Annotated[list[float], Meta(description="[s]")]


class NoiseFound(Record, frozen=True, kw_only=True):
    """A channel's noise as its free approach shows it, rounding included, beside what is stated."""

    sigma: Number
    stated: Number
    unit: Annotated[str, Meta(description="of sigma and stated")]


class FoundModel(Record, frozen=True, kw_only=True):
    """Where the found model of a machine without a wrist is written, and what runs it."""

    file: str
    run: str


class Part(Record, frozen=True, kw_only=True):
    """What is said of one joint, body or axis alone."""

    part: str
    verdict: Kind
    confidence: Annotated[Share, Meta(description="a probability [1]")]
    effects: list[Effect]
    compared: str
    error_ratio: Annotated[Measure, Meta(description="held-out error after over before [1]")]
    values: Annotated[dict[str, Number], Meta(description="as fitted, by dotted name, SI")]
    relative_to: list[str]
    not_measured: Annotated[str, Meta(description="why its readings tell nothing; the whole hangs on no such part")] | (
        UnsetType
    ) = UNSET
    rms_over_stated_noise: (
        Annotated[dict[str, Number], Meta(description="by channel, of what is left over [1]")] | UnsetType
    ) = UNSET


class Table(Record, frozen=True, kw_only=True):
    """A learned curve over the range that the recordings visited; beyond it nothing is known."""

    variable: Literal["d", "v", "z", "N", "q"]
    unit: Annotated[str, Meta(description="of x")]
    value_unit: Annotated[str, Meta(description="of law, total, low and high")]
    x: list[float]
    law: list[float]
    total: Annotated[list[float], Meta(description="with the believed values that it can be traded for")]
    low: Annotated[list[float], Meta(description="of the total; low and high hold it everywhere at once, 95 %")]
    high: list[float]
    total_with: list[str]


class Like(Record, frozen=True, kw_only=True):
    """What a learned law is a relative of; the effect is empty where it is none of the catalogue."""

    effect: str
    words: str


class Learned(Record, frozen=True, kw_only=True):
    """A law that no catalogue holds, as it was learned inside the simulation."""

    where: str
    kind: Literal["force", "friction", "memory"]
    depends_on: list[str]
    formula: Annotated[str | None, Meta(description="LaTeX; null where no short formula says as much as the table")]
    law: Annotated[str, Meta(description="how the curve acts, LaTeX")]
    parameters: dict[str, Value]
    table: Table
    like: Like | None
    lead: Annotated[Measure, Meta(description="log of its odds over the next other kind of law or place [1]")]
    part: Annotated[str, Meta(description="of several joints, bodies or axes, at which")] | UnsetType = UNSET


class Verdict(Record, frozen=True, kw_only=True):
    """Numbers are SI unless a unit says otherwise; infinity is "inf" or "-inf"; what could not be computed is null."""

    format: Literal[1]
    spacerobot: Annotated[str, Meta(description="version that wrote this")]
    input_hash: str
    seed: Annotated[int, Meta(description="as given; no answer hangs on it [1]")]
    study: str
    seconds: Annotated[float, Meta(ge=0.0, description="that it took [s]")]
    verdict: Kind
    confidence: Annotated[Share, Meta(description="a probability [1]")]
    effects: Annotated[list[Effect], Meta(description="empty unless named or learned")]
    alternatives: Annotated[
        list[Alternative], Meta(description="best first; the first is the favourite when ambiguous")
    ]
    parameters: Annotated[
        dict[str, Believed],
        Meta(description="believed values moved beyond 3 sigma; value, believed and sigma in the stated unit"),
    ]
    located: Annotated[
        list[Pattern],
        Meta(description="share: of the residual's square that it explains [1]; p: a probability [1]"),
    ]
    held_out: Annotated[
        HeldOut,
        Meta(
            description="channels: rms in SI; overall: in sensor sigmas, or as shares of each channel's spread where "
            "unit says so"
        ),
    ]
    detectable: Annotated[
        list[Detectable], Meta(description="smallest size that these data would show, in its own unit")
    ]
    next_experiment: NextExperiment | None
    exact: Annotated[list[str], Meta(description="names of believed values held exactly as stated")] | UnsetType = UNSET
    assumed: (
        Annotated[
            dict[str, float],
            Meta(description="believed values whose sigma is not stated: the relative one that was taken [1]"),
        ]
        | UnsetType
    ) = UNSET
    moved: (
        Annotated[
            dict[str, Moved],
            Meta(
                description="every believed value that was free in the fit, the absorbing one first; SI, and stated "
                "sigmas"
            ),
        ]
        | UnsetType
    ) = UNSET
    why: (
        Annotated[
            list[str],
            Meta(description="why an answer was taken back: each check that failed, and each set of effects not shown"),
        ]
        | UnsetType
    ) = UNSET
    not_predicted: (
        Annotated[
            list[NotPredicted],
            Meta(description="recorded channels that no model predicts or takes as given: nothing said rests on them"),
        ]
        | UnsetType
    ) = UNSET
    not_located: (
        Annotated[
            dict[str, str], Meta(description="of machines without a wrist: by part, why nothing is located in it")
        ]
        | UnsetType
    ) = UNSET
    events: list[Event] | UnsetType = UNSET
    clocks: list[ClockOffset] | UnsetType = UNSET
    spoiled: Annotated[list[Spoiled], Meta(description="readings that were left out")] | UnsetType = UNSET
    noise: (
        Annotated[dict[str, NoiseFound], Meta(description="channels weighed by another noise than stated; SI")]
        | UnsetType
    ) = UNSET
    model: FoundModel | UnsetType = UNSET
    learned: list[Learned] | UnsetType = UNSET
    parts: list[Part] | UnsetType = UNSET


def placed(label: Label) -> list[Placed]:
    """A set of effects, each at its place."""
    return [Placed(effect=said_name(e), where=w) for e, w in label]


def read(found: Mapping[str, Any]) -> Verdict:
    """What was `written`; `schema.validate` says where it breaks the promise."""
    return msgspec.convert(plain(dict(found)), Verdict)


def written(record: Record) -> Any:
    """A record as it stands in the file: builtins, infinity as "inf", what could not be computed as null."""
    return plain(msgspec.to_builtins(record, enc_hook=plain))
