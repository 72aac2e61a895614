"""What every part of a machine feels by one shape is found by all of them together, before each is searched.

A load in the hand asks for torque at every joint that carries it, a base that leans at every joint, and so does an
encoder whose zero is wrong. One joint alone tells little of it, and takes it for a sensor that reads too much or for a
rotor; together they tell many times over. So each joint says what the numbers of all these would do for it, beside all
that it might lack itself, and what leaves least over all joints is offered to each; one after the other, while more
than chance is won. How much of it there is each joint then says alone, as of any effect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.screen import Projector, Screener
from spacerobot.diagnosis.machines.contract import Machine, Refused
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.felt import Felt
from spacerobot.diagnosis.selection.nameable import only_way
from spacerobot.diagnosis.selection.nested_laws import by_chance
from spacerobot.diagnosis.selection.shared_sources import (
    ROUNDING,
    Found,
    Source,
    amounts,
    at_once,
    best_of,
    gained,
    placed,
    without,
)
from spacerobot.diagnosis.terms.decision import PENALTY
from spacerobot.effects.effect import Effect

NEARER = 5
"""How often at most what was found is found again near where it was found, before one further is sought (Gauss-Newton):
a zero of 0.1 rad beside a load of the arm's own weight took four."""

FEW = 3
"""Most of what all feel that may be left out at once. An arm whose links are not quite as its model has them takes in
ever more (the panda of the real recordings six and on): that is no load, and no base that leans."""

ROUNDS = 3
"""How often parts are weighed by what was found before left of them, and each found again beside the others."""


Shapes = Mapping[tuple[str, str], str]
"""Effect and place -> form; empty where it has none."""

Asked = Callable[[Sequence[int], Sequence[str], Mapping[str, np.ndarray]], Sequence[tuple[Felt, Felt]]]
"""Numbers of machines, places, and what is known to be at some of them -> what `felt_by` says of each."""


def shapes_of(models: Sequence[Machine], effects: Iterable[Effect], asked: Asked) -> Shapes:
    """In which form the machines of a study feel effects together; nothing where they do not."""
    wanted = [e for e in effects if e.together]
    feeling = [k for k, m in enumerate(models) if m.shared and not m.not_measured]
    if not wanted or len(feeling) < 2:
        return {}
    some = [models[k] for k in feeling]
    places = list(dict.fromkeys(place for m in some for place in m.shared))
    sources = placed(wanted, places, some)
    first = asked(feeling, places, {})
    near = partial(asked, feeling, places)
    # one load that all carry is nearly as much a scale of each one's own sensor: beside all that a part may lack little
    # of it is left, and that may be of any sign
    beside, plainly = (_sought(view, sources, first, near) for view in (lambda one: one.beside_own, lambda one: one))
    if beside is None:
        return {}
    nothing = _beside_found(first, [], np.zeros(first[0][0].columns.shape[1]))
    tried = [nothing, *beside, *(plainly or ())]
    if not all(m.proportional for m in some):
        for begun in _other_places(sources, first):
            tried += _sought(lambda one: one, sources, first, near, begun) or ()
    noise = np.min([[one.noise(t.brought) for one in t.stated] for t in tried], axis=0)
    best = min(tried, key=lambda one: one.costs(noise))
    # what is stated of the links may be wrong: what only says so is none of these
    borne_out = still_there(best.freely, best.found, len(sources))
    every = (one for leading, same in borne_out for one in (leading, *same))
    return {(one.source.effect.name, one.source.where): one.form for one in every}


@dataclass(frozen=True, eq=False)
class Sought:
    """What all parts feel together, and they beside what each shows of its own; K parts, N numbers.

    Attributes:
        found: what they feel.
        stated, freely: parts as they were asked near it, with believed values held or free.
    """

    found: list[Leading]
    stated: list[Felt]
    freely: list[Felt]

    @cached_property
    def brought(self) -> np.ndarray:
        """How much there is of all numbers, shape (N,)."""
        return brought_by(self.stated, self.found)

    def costs(self, noise: np.ndarray) -> float:
        """What is left over in units of the parts' noise, shape (K,), with each number at its price, their own too."""
        left = [one.unit**2 * one.squares(self.brought) for one in self.stated]
        numbers = sum(one.spent for one in self.stated) + sum(one.source.free for one, _ in self.found)
        return float(np.sum(np.array(left) / noise**2)) + PENALTY * numbers


def _sought(
    view: Callable[[Felt], Felt],
    sources: Sequence[Source],
    felt: Sequence[tuple[Felt, Felt]],
    asked: Callable[[Mapping[str, np.ndarray]], Sequence[tuple[Felt, Felt]]],
    begun: Sequence[Leading] = (),
) -> list[Sought] | None:
    """One after the other while more than chance is won, from what is begun with; None where that takes in ever more.

    Then all again beside what the parts show of their own, which is told anew, beside what is there, a few times.
    """
    found: list[Leading] = []
    seen = [view(one) for one, _ in felt]
    more = begun or found_in(seen, sources)
    while len(more) > len(found):
        found = list(more)
        if len(found) > FEW:
            return None
        for _ in range(NEARER):  # a pull pulls at a load too
            felt, before = asked(_numbers(found)), found
            seen = [view(one) for one, _ in felt]
            found = found_again(seen, sources, found)
            if by_chance(moved(seen, before, found), 1):
                break
        more = found_in(seen, sources, found)
    out: list[Sought] = []
    while found and len(out) < NEARER:
        if out:
            felt = asked(_numbers(found))
        beside = _beside_found(felt, found, out[-1].brought if out else brought_by(seen, found))
        before, found = found, found_again(beside.stated, sources, found)
        out.append(replace(beside, found=found))
        none = any(one.gain <= 0.0 for one, _ in found)
        if none or by_chance(moved(beside.stated, before, found), 1):
            break
    return out


def _beside_found(felt: Sequence[tuple[Felt, Felt]], found: list[Leading], brought: np.ndarray) -> Sought:
    """Parts beside what each shows of its own, where so much of the numbers, shape (N,), is there."""
    stated, freely = ([one.beside_shown(brought) for one in some] for some in zip(*felt, strict=True))
    return Sought(found, stated, freely)


def _other_places(sources: Sequence[Source], felt: Sequence[tuple[Felt, Felt]]) -> list[list[Leading]]:
    """Where else than at its best place a body does best near there, of all the best ones of a link."""
    plain = [one for one, _ in felt]
    normal, right = _summed(plain, _floors(plain, [one.floor(0.0) for one in plain], []))

    def alike(one: Found, other: Found) -> bool:
        apart = one.among(right.size) - other.among(right.size)
        return by_chance(float(apart @ normal @ apart), 1)

    out: list[list[Leading]] = []
    for source in sources:
        best, *others = source.minima(normal, right)
        known = [best]
        for one in others:
            told = not by_chance(one.gain, source.free, len(sources))
            if told and not any(alike(one, other) for other in known):
                known.append(one)
                out.append([(one, [])])
    return out


def _numbers(found: Sequence[Leading]) -> dict[str, np.ndarray]:
    """What was found at each place."""
    return {one.source.where: one.numbers for one, _ in found}


def told(model: Machine, shapes: Shapes, refused: Refused = frozenset()) -> Machine:
    """A machine that knows in which form it feels effects, and which are not there."""
    if not (shapes or refused):
        return model
    other = copy(model)
    other.shapes, other.refused = shapes, refused
    return other


@dataclass(frozen=True, eq=False)
class Alone:
    """A part before it is asked.

    Attributes:
        model: of the part.
        fit: its baseline near what is believed.
        own: what every effect that it may lack itself, and every believed value of its own that may be wrong, would do
            for its weighted readings, shape (S,) each, and more.
        ways: of each of these, see `Felt.ways`.
    """

    model: Machine
    fit: Fit
    own: Sequence[np.ndarray]
    ways: np.ndarray


def alone(model: Machine, effects: Sequence[Effect]) -> Alone:
    """A part, and effects that it may lack."""
    bench = Bench(model)
    fit = bench.baseline()
    # beside what it lacks the values that fit best may be far from what is believed
    unbent = {k: x for k, x in fit.values().items() if k not in model.believed.fitted}
    fit = replace(fit, z=fit.hypothesis.start(unbent))
    screener = Screener(bench.fitter(), model.believed, plain=True)
    best = [s for s in screener.screen(fit, model.sites(effects)).best().values() if s.norm > 0.0]
    ways = [only_way(s.site, s.start, model.size_at(s.site.where)) for s in best]
    rows = bench.fitter().rows_at(fit)
    at = [k for k, f in enumerate(fit.hypothesis.free) if f.kind == "believed" and not f.key.startswith("link.")]
    values = [v for k in at if (v := np.concatenate([rows[t.id][:, k] for t in bench.trials])).any()]
    return Alone(model, fit, [*(s.column for s in best), *values], np.array([*ways, *(0.0 for _ in values)]))


def felt_by(part: Alone, places: Sequence[str], known: Mapping[str, np.ndarray]) -> tuple[Felt, Felt]:
    """What numbers of what is at these places would do for a part, and every effect that it may lack itself.

    Args:
        part: who is asked.
        places: that it shares with others.
        known: numbers at some of the places near which it is asked.

    Returns:
        With believed values held as they are stated, and with all of them free: a link that is heavier than believed
        is a wrong value, no body on it.
    """
    model, fit, own = part.model, part.fit, part.own
    bench, near = Bench(model), model.near(known)
    every = tuple(model.believed.sigma)

    def felt(*free: Sequence[str]) -> list[Felt]:
        """Under the present weights, with each of these sets of believed values free."""
        fitter = bench.fitter()
        state = Screener(fitter, model.believed).state_of(fit)
        rows = np.concatenate([np.concatenate([near.felt(t, n) for t in bench.trials], axis=1) for n in places])
        bent = np.concatenate([near.bent(t) for t in bench.trials])
        out = []
        for loose in free:
            project = Projector(fitter, fit, state, robust=False, loose=loose)
            left = -project.free(project.stack(state.raw), fit.z)
            left = left - project.free(bent, np.zeros_like(project.pull))
            whole = [c[: rows.shape[1]] for c in own]
            mine = _freed(project, whole) if own else np.zeros((left.size, 0))
            more = np.linalg.norm(mine, axis=0) > ROUNDING * np.array([np.linalg.norm(c) for c in whole])
            own_left = _freed(project, rows), left, mine[:, more], part.ways[more]
            out.append(Felt(bench.trials, *own_left, unit=max(bench.weights.values(), default=1.0)))
        return out

    # whatever all of these leave over is noise: beliefs are held by as much as readings then count
    first = felt(every)[0].beside_own
    best, _, rank, _ = np.linalg.lstsq(first.columns, first.left, rcond=ROUNDING)
    if rank < sum(t.samples for t in first.trials) - first.spent:  # else they leave nothing, and tell of no noise
        bench.weights = dict.fromkeys((c for t in bench.trials for c in t.channels), first.floor(first.columns @ best))
    stated, freely = felt((), every)
    return stated, freely


def _freed(project: Projector, rows: Iterable[np.ndarray]) -> np.ndarray:
    """What no free parameter can imitate of what readings may do, shape (S,) each, as columns."""
    return np.stack([project.free(row, np.zeros_like(project.pull)) for row in rows], axis=1)


Leading = tuple[Found, list[Found]]
"""What does best, and what none can tell from it."""


def found_in(felt: Sequence[Felt], sources: Sequence[Source], begun: Sequence[Leading] = ()) -> list[Leading]:
    """What all parts together feel more of than chance would make: what was begun with, found again, and one more.

    The parts are weighed by what all of these leave over. A place has one: a link one body.
    """
    known = found_again(felt, sources, begun)
    if {s.where for s in sources} <= {one.source.where for one, _ in known}:
        return known
    more = found_again(felt, sources, known, further=True)
    # what comes may take the place of what was found: all of them together must leave less
    floors = _floors(felt, [one.floor(0.0) for one in felt], [one for one, _ in more])
    fewer, less = (_left_over(felt, floors, [one for one, _ in some]) for some in (known, more))
    last, _ = more[-1]
    return known if by_chance(min(last.gain, fewer - less), last.source.free, len(sources)) else more


def _left_over(felt: Sequence[Felt], floors: Sequence[float], found: Sequence[Found]) -> float:
    """Chi-squared of all parts beside as much of what was found as pays best."""
    brought = _brought(felt, floors, found)
    return sum(one.squares(brought) / f**2 for one, f in zip(felt, floors, strict=True))


def found_again(
    felt: Sequence[Felt], sources: Sequence[Source], begun: Sequence[Leading], *, further: bool = False
) -> list[Leading]:
    """The same many, and perhaps one further, each as it does best beside the others."""
    tried = list(begun)
    floors = _floors(felt, [one.floor(0.0) for one in felt], [one for one, _ in tried])
    many = len(tried) + further
    for k in [*([len(tried)] if further else []), *[*range(many)] * (ROUNDS - 1)]:
        normal, right = _summed(felt, floors)
        others = [one for one, _ in (*tried[:k], *tried[k + 1 :])]
        taken = {one.source.where for one in others}
        rest = [s for s in sources if s.where not in taken]
        free = without(normal, right, [one.among(right.size) for one in others])
        tried[k:] = [best_of(*free, rest), *tried[k + 1 :]]
        floors = _floors(felt, floors, [one for one, _ in tried])
    every = at_once(*_summed(felt, floors), [one for one, _ in tried]) if tried else []
    return [(one, same) for one, (_, same) in zip(every, tried, strict=True)]


def moved(felt: Sequence[Felt], before: Sequence[Leading], after: Sequence[Leading]) -> float:
    """By how much chi-squared tells what was found before from what was found after."""
    normal, right = _beside(felt, after)
    more, less = (sum((one.among(right.size) for one, _ in some), np.zeros(right.size)) for some in (after, before))
    return float((more - less) @ normal @ (more - less))


def still_there(felt: Sequence[Felt], found: Sequence[Leading], looks: int) -> list[Leading]:
    """Those of which the parts feel more than chance would make of so many, each beside the others."""
    if not found:
        return []
    normal, right = _beside(felt, found)
    out = []
    for k, (one, same) in enumerate(found):
        others = [other.among(right.size) for other, _ in (*found[:k], *found[k + 1 :])]
        gain = gained(*without(normal, right, others), one.among(right.size))
        if not by_chance(gain, 1, looks):
            out.append((one, same))
    return out


def _beside(felt: Sequence[Felt], found: Sequence[Leading]) -> tuple[np.ndarray, np.ndarray]:
    """Normal matrix and right-hand side of all numbers, the parts weighed by what all that was found leaves over."""
    return _summed(felt, _floors(felt, [one.floor(0.0) for one in felt], [one for one, _ in found]))


def _floors(felt: Sequence[Felt], floors: Sequence[float], found: Sequence[Found]) -> list[float]:
    """By what the parts' weights must fall for what all that was found leaves over to be noise."""
    brought = _brought(felt, floors, found)
    return [one.floor(one.columns @ brought) for one in felt]


def brought_by(felt: Sequence[Felt], found: Sequence[Leading]) -> np.ndarray:
    """How much there is of all numbers, shape (N,), as all parts together tell."""
    best = [one for one, _ in found]
    return _brought(felt, _floors(felt, [one.floor(0.0) for one in felt], best), best)


def _brought(felt: Sequence[Felt], floors: Sequence[float], found: Sequence[Found]) -> np.ndarray:
    normal, right = _summed(felt, floors)
    if not found:
        return np.zeros(right.size)
    directions = [one.among(right.size) for one in found]
    return np.asarray(np.stack(directions, axis=1) @ amounts(normal, right, directions))


def _summed(felt: Sequence[Felt], floors: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Normal matrix, shape (N, N), and right-hand side of all numbers, of all parts."""
    sized = [(one.columns / f, one.left / f) for one, f in zip(felt, floors, strict=True)]
    normal = np.sum([columns.T @ columns for columns, _ in sized], axis=0)
    return normal, np.sum([columns.T @ left for columns, left in sized], axis=0)
