"""The contract of a machine: what locating, fits and a verdict ask of it, whatever it is."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Protocol, Self

import numpy as np

from spacerobot.diagnosis.machines.doubted import NONE, Doubted, beyond
from spacerobot.diagnosis.machines.sizes import scaled
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.terms.candidates import late
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site
from spacerobot.diagnosis.terms.parameters import zero_key
from spacerobot.diagnosis.terms.reach import started_there
from spacerobot.effects.effect import Effect
from spacerobot.effects.learned import Variable
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap
from spacerobot.effects.registry import all_effects
from spacerobot.effects.sizes import Sizes


@dataclass(frozen=True)
class Nuisance:
    """A number of a trial's own: an initial value, or what a clock is late by.

    Attributes:
        coordinate: whose; of a clock, CLOCK and its name.
        rate: whether it is the velocity.
        guess: first value.
        scale: step of one unit in a fit.
        least: smallest difference that a derivative can be taken by: less is lost in an integrator's error.
        beside: by doubted factor, what one more of it adds to where it truly is: it is counted as it was read.
        adds_to: channel that it is added to as it is read, and to nothing else.
    """

    coordinate: str
    rate: bool
    guess: float
    scale: float
    least: float = 0.0
    beside: tuple[tuple[str, float], ...] = ()
    adds_to: str = ""

    @property
    def floor(self) -> float:
        """That difference in units of a fit."""
        return self.least / self.scale

    def true(self, value: float, mechanism: Mechanism) -> float:
        """Where it is by a mechanism's factors, of a value as it was read."""
        return value + sum(beyond(mechanism, key) * by for key, by in self.beside)


FIRST_NOISE = 0.02
"""Noise of a channel as a share of its own size, before the best model's residual tells it."""

FACTORS = (0.5, 2.0, 3.0)
"""By how much another trial changes a speed, a drive or a mass."""

FURTHER = 0.3
"""Of the typical force at a port, as which a further force there is typical."""

CLOCK = "clock:"
"""Starts the name of a nuisance that is a clock's offset [s]: by how much its stream's readings are late."""


@dataclass(frozen=True, eq=False)
class Variant:
    """Trials as a lab might record them next.

    Attributes:
        change: what is different, by name; nothing where they are as they were.
        machine: that shows them.
        rates, masses, longer: factors on the trials' initial speeds, on the mass that is free, on their length.
    """

    change: Mapping[str, float | str]
    machine: Machine
    rates: float = 1.0
    masses: float = 1.0
    longer: float = 1.0


@dataclass(frozen=True)
class Predicted:
    """Predicted channels of a trial, block by block, and when something touched (never, where nothing can)."""

    blocks: tuple[np.ndarray, ...]  # (C, T) each, as the trial's blocks
    touches: tuple[float, ...] = ()
    late: tuple[float, ...] = ()  # by how much each block is late as its clock goes [s]; none where empty


class Baseline(Protocol):
    """What is believed of a machine, and the mechanism that this makes; all that locating needs.

    Attributes:
        base: values by dotted name, the trials' overrides apart.
        believed: values with their sigma, and what is unknown.
    """

    base: dict[str, float]
    believed: Believed

    def mechanism(self, values: Mapping[str, float], trial: TrialData, /) -> Mechanism:
        """The baseline of one trial with these values."""
        ...


TEN = 10
"""Numbers of a body at a link: its mass, that times its place, and its inertia (m, m c, I)."""


Refused = frozenset[tuple[str, str]]
"""Effects at places, (effect, where), of which it is known already that they are not there."""


def numbers_at(where: str) -> int:
    """How many numbers what is at a shared place has."""
    return TEN if where.startswith("link.") else 1 if where.startswith("joint.") else 3


class Machine(ABC):
    """Base of what fits can run. An implementer sets the attributes and gives `mechanism` and `predict`.

    Attributes:
        name: what it models, for reports: a joint, a body, a part of the study.
        trials: the recordings as this model compares them (filtered, or cut into windows).
        believed: values with their sigma, and what is unknown, for hypotheses.
        base: values by dotted name, the trials' overrides apart.
        sizes: what is typical, by place; "" for all others.
        stated: channels whose noise the study states; the weights of others come from what the best model leaves.
        relative_to: values that are not known and take part as 1: forces are told per unit of them.
        given: channels that it takes as they were recorded: drives, motion that is followed.
        no_balance: why nothing can be located in its balance, where it has none.
        not_measured: why its readings tell nothing of it; the study's verdict does not hang on such a part.
        predicts_readings: whether what is predicted are the sensors' own readings, not a balance of them.
        doubted: zeros of its channels and factors of other columns in them, which its fit finds.
        met: by recorded trial, when it met something, a floor or a hand, that the baseline does not know; cut there.
        moment: values, believed to be zero, of when its inputs acted within a sample [s] or what an encoder reads where
            it hangs [rad], with their deviations; held there unless they are worth being free.
        metric: what the residual is, for tables, e.g. "torque balance" or "simulated motion".
    """

    name: str
    trials: tuple[TrialData, ...]
    believed: Believed
    base: dict[str, float]
    sizes: Mapping[str, Sizes]
    metric: str
    stated: frozenset[str] = frozenset()
    relative_to: tuple[str, ...] = ()
    given: frozenset[str] = frozenset()
    no_balance: str = ""
    predicts_readings: bool = False
    moment: Mapping[str, float] = MappingProxyType({})
    doubted: Doubted = NONE
    met: Mapping[str, tuple[Moment, ...]] = MappingProxyType({})
    not_measured: str = ""
    otherwise: Mapping[str, str] = MappingProxyType({})
    """What else could be measured where no other trial tells more."""
    free_mass: str = "body.mass"
    """Name of the mass that another trial may change."""
    one_lag: bool = False
    """Whether what is sluggish is asked how it changes, so that a filter can be of the first order alone."""
    shared: tuple[str, ...] = ()
    """Places of which other parts of its machine feel what it feels: links, "link.NAME" from base to tip, that may
    carry a body; the base, in gravity; joints, "joint.NAME", whose encoders may have another zero."""
    refused: Refused = frozenset()
    """What is not offered."""
    proportional: bool = True
    """Whether what it reads rises in proportion to bodies at shared places, more or less."""

    shapes: Mapping[tuple[str, str], str] = MappingProxyType({})
    """By effect and place, the form in which what all parts feel together was found (`Effect.together`)."""
    strides: bool = True
    """Whether a step of a fit may double what a value stands at."""

    @abstractmethod
    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """The baseline of one trial with these values."""

    @abstractmethod
    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """What the trial's channels would show; `initial` has one value a nuisance."""

    def expected(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Channel -> noise of what is compared [SI], where it is no reading but made of several whose noise is stated.

        Args:
            values: by dotted name; the believed ones where a name is missing.
        """
        return {}

    def stated_noise(self, values: Mapping[str, float]) -> dict[str, float]:
        """Channel -> noise that is stated of what is compared, readings among it [SI]; empty where none is."""
        found = dict(self.expected(values))
        for trial in self.trials:
            for block in trial.blocks:
                for channel, weight in zip(block.channels, block.weight, strict=True):
                    if channel in self.stated and weight.any():
                        found.setdefault(channel, 1.0 / float(weight.max()))
        return found

    def logged(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """The same as the logs themselves show noise, or a study states that of readings; a lower bound of it."""
        return {}

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """What is free in this trial alone."""
        return ()

    def approach_start(self, trial: TrialData, initial: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """Initial values to try again from, where a trial's cost has several minima; here it has one."""
        return initial

    def in_step(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> np.ndarray:
        """Initial values with every clock of the trial's own where its readings fit best; here it has none."""
        return initial

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData) -> Mechanism:
        """The edited mechanism of one trial."""
        values = hypothesis.trial_values(z, dict(self.base), trial.condition, trial.overrides)
        free = hypothesis.values(z)
        return hypothesis.edit(self.mechanism(values, trial).with_map(*self.zeros(free)), free, trial.id)

    def zeros(self, free: Mapping[str, float]) -> Iterable[ChannelMap]:
        """Zeros of channels, and what factors have beyond what is believed, as maps; of free parameters' values."""
        return (ChannelMap(c, "offset", free.get(zero_key(c), 0.0)) for c in self.believed.zeros)

    def take_off_beside(self, blocks: Sequence[np.ndarray], mechanism: Mechanism, trial: TrialData) -> None:
        """Take what other columns bring into the channels of a trial, by factors that are doubted, off what is shown.

        With a factor larger than believed the channel's readings, as they are made, lack that much of the column.

        Args:
            blocks: what was predicted, shape (channels, times) each; changed in place.
            mechanism: with the factors.
            trial: whose times.
        """
        self.doubted.take_off(blocks, mechanism, trial.recorded, ((b.channels, b.time) for b in trial.blocks))

    def felt(self, trial: TrialData, where: str) -> np.ndarray:
        """By how much its weighted readings rise with each number of what is at a shared place, shape (N, S): the ten
        of a body at a link, three of a pull at the base, the zero of a joint's encoder."""
        return np.zeros((numbers_at(where), trial.valid.size))

    def near(self, numbers: Mapping[str, np.ndarray]) -> Machine:
        """The same, telling what it feels near where these numbers are at some shared places."""
        return self

    def bent(self, trial: TrialData) -> np.ndarray:
        """What its weighted readings show there beside what is in proportion to the numbers, shape (S,)."""
        return np.zeros(trial.valid.size)

    def numbers(self, where: str, place: np.ndarray | None) -> np.ndarray:
        """Those of a body of 1 kg at a place of a link [m], or spread as the link is, shape (10,)."""
        return np.zeros(TEN)

    def carried(self, where: str, place: np.ndarray | None) -> float:
        """Mass that a link may have at a place [m], or all of it [kg]: no more can be missing; infinite of no link."""
        return np.inf

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """Every effect at every place where it could sit, its parameters scaled to what is typical there.

        But for what strikes once: nothing that is kept aside foretells it. It is found by the moment itself
        (`selection/stretches.py`). Of two clocks only the difference shows: each may be late. Where the inputs' moment
        is free none may: two offsets that nearly cancel would explain what neither is.
        """
        plain = self.plain()
        found = []
        timed = any(name.endswith(".delay") for name in self.believed.within)
        for effect in all_effects().values() if effects is None else effects:
            if effect.once or (effect.relative and timed):
                continue
            for where in dict.fromkeys(effect.places(plain)):
                if effect.together and not effect.settings:
                    form = self.shapes.get((effect.name, where))
                    if form is not None:
                        found.append(self.site(effect.in_form(form) if form else effect, where))
                    continue
                found.append(self.site(effect, where))
                if any(p.reach for p in effect.parameters):  # from where on it acts, and to which side, is the place's
                    found += self.in_forms(effect, where)
        found = [s for s in found if s.label not in self.refused]
        clocks = [s.where for s in found if s.effect.relative]
        return [late(s) if s.effect.relative and len(clocks) > 1 else s for s in found]

    def site(self, effect: Effect, where: str, trials: tuple[str, ...] = ()) -> Site:
        """An effect at a place, in all trials or in some, its parameters scaled to what is typical there."""
        return Site(started_there(scaled(effect, self.size_at(where)), self.visited(where)), where, trials)

    def in_forms(self, effect: Effect, where: str) -> list[Site]:
        """An effect of the catalogue in each of its other forms that is another thing at a place, scaled likewise."""
        return [self.site(effect.in_form(form), where) for form in effect.forms_at(self.visited(where))]

    def moment_free(self) -> Self | None:
        """The same with its inputs' moment free within a sample; None where it has none.

        No further, whatever that explains: later than that is an effect, with a price and a name.
        """
        if not self.moment:
            return None
        other = copy(self)
        other.moment = {}
        within = {name: MOVED * size for name, size in self.moment.items()}
        other.believed = replace(self.believed, absolute={**self.believed.absolute, **self.moment}, within=within)
        return other

    @property
    def window(self) -> float:
        """How long it predicts before it starts anew from the recording [s]; infinite where whole trials are."""
        return math.inf

    def everything(self) -> Self:
        """The same with every window of its recordings, where a fit looks at some of them."""
        return self

    def but_for(self, out: Sequence[str]) -> Self:
        """The same with its other trials alone."""
        other = copy(self)
        other.trials = tuple(t for t in self.trials if t.id not in out)
        return other

    def divided(self) -> Self:
        """Where there is but one trial, the same with that in parts, if it can be cut: a choice is tried on some.

        Raises:
            SimulationError: it is too short to be cut.
        """
        return self

    def cut_at(self, moments: Mapping[str, Sequence[Moment]]) -> Self:
        """The same with recorded trials cut at moments: each stretch has a start of its own; here none has one."""
        return self

    def apart(self, met: Mapping[str, Sequence[Moment]]) -> Self:
        """The same cut wherever it met something."""
        other = self.cut_at(met)
        other.met = {trial: tuple(some) for trial, some in met.items()}
        return other

    def contradiction(self) -> tuple[str, str]:
        """How its recordings contradict each other whatever the values are, and what would mend it; "" if not."""
        return "", ""

    def steady(self, trial: TrialData, start: float, end: float) -> bool:
        """Whether what drives it did not change between two moments [s]; so where nothing does."""
        return True

    def impulse(self, mechanism: Mechanism, trial: TrialData, rates: Mapping[str, float]) -> dict[str, float]:
        """What changes the coordinates' rates by so much at a trial's end, by place [N s or N m s]."""
        return {name: mechanism.coordinates[name].mass * rate for name, rate in rates.items()}

    def shocks(self) -> Mapping[str, Moment]:
        """By trial, when its balance is first shaken by a touch."""
        return {}

    def size_at(self, where: str) -> Sizes:
        """What is typical at a place."""
        return self.sizes.get(where, self.sizes[""])

    def visited(self, where: str) -> np.ndarray:
        """Where a place was read, in any order, shape (T,) [m or rad from its zero]; empty where nothing reads it."""
        name = f"{where}.position"
        shown = [t.channel(name)[1] for t in self.trials if name in t.channels]
        return np.concatenate([np.zeros(0), *shown])

    def travelled(
        self, port: str, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> Mapping[Variable, np.ndarray]:
        """What a law at a port reads in a trial: displacement "d" and rate "v", and where there is such a thing the
        normal force "N" and what is remembered, "z"; shape (T,) each, in any order. Nothing where nobody knows.

        Args:
            port: of the mechanism.
            mechanism: the trial's, edited.
            trial: which.
            initial: its own values, one a nuisance.
        """
        return {}

    def typical_law(self, port: str, seen: Mapping[Variable, tuple[float, float]]) -> tuple[float, float]:
        """How large a further force [N] and stiffness [N/m] at a port may well be, by the ranges that it visited."""
        size = self.size_at(port)
        return FURTHER * size.force, FURTHER * size.force / size.length

    def variants(self, trial: TrialData) -> Iterable[Variant]:
        """How trials like this one could be recorded otherwise; none where nothing can be changed."""
        return ()

    def plain(self) -> Mechanism:
        """The baseline of the first trial."""
        trial = self.trials[0]
        return self.mechanism({**self.base, **self.believed.unknown, **trial.overrides}, trial)

    def touched(self, site: Site) -> frozenset[str]:
        """What an effect edits of the baseline: names of the mechanism's fields."""
        plain = self.plain()
        edited = site.effect.edit(plain, site.where, {p.name: p.starts[0] for p in site.effect.parameters})
        return frozenset(f.name for f in fields(Mechanism) if getattr(edited, f.name) != getattr(plain, f.name))


def conditions_of(trials: Sequence[TrialData]) -> tuple[str, ...]:
    """Names of the trials' conditions, in order of appearance."""
    return tuple(dict.fromkeys(t.condition for t in trials))
