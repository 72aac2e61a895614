"""What every part of a machine feels by one shape is found by all of them together, before each is searched.

A load in the hand asks for torque at every joint that carries it. One joint alone tells little of where it is, and
takes it for a sensor that reads too much or for a rotor; together they tell ten times over. So each joint says what the
ten numbers of a body at each link would do for it, beside all that it might lack itself, and the body of which least
is left over all joints is offered to each. How much of it there is each joint then says alone, as of any effect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from spacerobot.diagnosis.fitting.noise import floor_of
from spacerobot.diagnosis.fitting.screen import Projector, Screener
from spacerobot.diagnosis.machines.contract import TEN, Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.nested_laws import by_chance, chance_edge
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.effect import Effect
from spacerobot.effects.located_load import form_of

REACH = 1.0
"""Furthest that a load may be from its link's origin [m]: beyond that it is another link's."""

ASIDE = 0.1
"""How far from the origin a search for its place also begins [m]."""

ROUNDING = 1e-6
"""Share of the largest direction that what a part might lack itself spans, below which one is rounding."""

ROUNDS = 3
"""How often parts are weighed by what the body before left of them."""

Numbers = Callable[[str, np.ndarray | None], np.ndarray]
"""Link and place [m] -> the ten numbers of a body of 1 kg there; without a place, of one spread as the link is."""

Place = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Felt:
    """What bodies at links would do for one part, beside all that it may lack itself. K links, S readings.

    Attributes:
        trials: under the weights of its baseline.
        columns: by how much its weighted readings rise with each of a body's numbers, shape (S, K 10), or (S, K, 10).
        left: what its baseline leaves over, shape (S,), that a body would have to bring.
        spent: how many directions were taken out of both.
    """

    trials: tuple[TrialData, ...]
    columns: np.ndarray
    left: np.ndarray
    spent: int = 0

    def floor(self, brought: np.ndarray | float) -> float:
        """By what its weights must fall for chi-squared to count independent readings, with so much brought (S,)."""
        sizes = [t.valid.size for t in self.trials]
        rest = (self.left - brought)[: sum(sizes)]
        parts = np.split(rest, np.cumsum(sizes)[:-1])
        told = floor_of({t.id: p for t, p in zip(self.trials, parts, strict=True)}, self.trials)
        readings = sum(t.samples for t in self.trials)
        return max(*told.values(), np.finfo(float).tiny) * float(np.sqrt(readings / max(readings - self.spent, 1)))

    def beside(self, own: np.ndarray) -> Felt:
        """The same with all taken out that effects of the part's own, shape (S, E), can imitate.

        Where a body and a sensor's scale trade places exactly, the less of them is meant: an effect that explains all
        that is left costs as much as one reading.
        """
        sized = own / np.linalg.norm(own, axis=0)
        basis, size, _ = np.linalg.svd(sized, full_matrices=False)
        basis = basis[:, size > ROUNDING * size[0]]
        least = self.floor(basis @ (basis.T @ self.left)) / max(float(np.linalg.norm(self.left)), np.finfo(float).tiny)
        priced = np.concatenate([sized, least * np.eye(own.shape[1])])
        basis = np.linalg.qr(priced)[0]

        def freed(x: np.ndarray) -> np.ndarray:
            longer = np.concatenate([x, np.zeros((own.shape[1], *x.shape[1:]))])
            return np.asarray(longer - basis @ (basis.T @ longer))

        return Felt(self.trials, freed(self.columns), freed(self.left), own.shape[1])

    def by_link(self, links: int) -> Felt:
        """The same with columns by link, shape (S, K, 10), from (S, K 10)."""
        return replace(self, columns=self.columns.reshape(-1, links, TEN))


Shapes = Mapping[tuple[str, str], str]
"""Effect and place -> form; empty where it has none."""

Asked = Callable[[Sequence[int], Sequence[str]], Sequence[tuple[Felt, Felt]]]
"""Numbers of machines, and links -> what `felt_by` says of each."""


def shapes_of(models: Sequence[Machine], effects: Iterable[Effect], asked: Asked) -> Shapes:
    """In which form the machines of a study feel an effect together; nothing where they do not."""
    together = [e for e in effects if e.together]
    carrying = [k for k, m in enumerate(models) if m.carried and not m.not_measured]
    if not together or len(carrying) < 2:
        return {}
    links = list(dict.fromkeys(link for k in carrying for link in models[k].carried))
    felt, numbers = asked(carrying, links), models[carrying[0]].numbers
    if body_of([freely for _, freely in felt], links, numbers) is None:  # what is stated of the links may be wrong
        return {}
    found = body_of([stated for stated, _ in felt], links, numbers)
    if found is None:
        return {}
    where, place = found
    form = "" if place is None else form_of(place)
    return {(e.name, where): form for e in together if bool(form) == any(p.shape for p in e.parameters)}


def told(model: Machine, shapes: Shapes) -> Machine:
    """A machine that knows in which form it feels effects."""
    if not shapes:
        return model
    other = copy(model)
    other.shapes = shapes
    return other


def felt_by(model: Machine, links: Sequence[str], effects: Sequence[Effect]) -> tuple[Felt, Felt]:
    """What bodies at these links would do for a part, beside every effect that it may lack.

    Returns:
        With believed values held as they are stated, and with all of them free: a link that is heavier than believed
        is a wrong value, no body on it.
    """
    bench = Bench(model)
    fit = bench.baseline()
    screener = Screener(bench.fitter(), model.believed, plain=True)
    own = [s.column for s in screener.screen(fit, model.sites(effects)).best().values() if s.norm > 0.0]
    every = tuple(model.believed.sigma)

    def felt(*free: Sequence[str]) -> list[Felt]:
        """Under the present weights, with each of these sets of believed values free."""
        fitter = bench.fitter()
        state = Screener(fitter, model.believed).state_of(fit)
        bodies = np.concatenate([np.concatenate([model.felt(t, n) for t in bench.trials], axis=1) for n in links])
        out = []
        for loose in free:
            project = Projector(fitter, fit, state, robust=False, loose=loose)
            left = -project.free(project.stack(state.raw), fit.z)
            found = Felt(bench.trials, _freed(project, bodies), left)
            out.append(found.beside(_freed(project, [c[: bodies.shape[1]] for c in own])) if own else found)
        return out

    # whatever all bodies leave over is noise: beliefs are held by as much as readings then count
    (first,) = felt(every)
    best = np.linalg.lstsq(first.columns, first.left, rcond=ROUNDING)[0]
    bench.weights = dict.fromkeys((c for t in bench.trials for c in t.channels), first.floor(first.columns @ best))
    stated, freely = (one.by_link(len(links)) for one in felt((), every))
    return stated, freely


def _freed(project: Projector, rows: Iterable[np.ndarray]) -> np.ndarray:
    """What no free parameter can imitate of what readings may do, shape (S,) each, as columns."""
    return np.stack([project.free(row, np.zeros_like(project.pull)) for row in rows], axis=1)


def body_of(felt: Sequence[Felt], links: Sequence[str], numbers: Numbers) -> tuple[str, Place | None] | None:
    """The body that leaves least of all parts together: its link, of `links` from base to tip, and its place [m].

    A point mass; or, without a place, a link heavier than its model, where a point does no better than three numbers
    more would by chance. None where chance would do as much. Of links that do alike the last: what is carried is
    carried in the hand.
    """
    floors = [one.floor(0.0) for one in felt]
    best: tuple[str, Place | None] | None = None
    for _ in range(ROUNDS):
        points = [_point(felt, floors, k, link, numbers) for k, link in enumerate(links)]
        wholes = [_heavier(felt, floors, k, link, numbers) for k, link in enumerate(links)]
        most, whole = (max(gain for gain, _, _ in tried) for tried in (points, wholes))
        spread = whole >= most - chance_edge(3, len(links))
        tried, most = (wholes, whole) if spread else (points, most)
        k = max(k for k, (gain, _, _) in enumerate(tried) if gain >= most - chance_edge(1))
        gain, place, mass = tried[k]
        best = links[k], None if place is None else (float(place[0]), float(place[1]), float(place[2]))
        brought = [one.columns[:, k] @ (mass * numbers(links[k], place)) for one in felt]
        floors = [one.floor(own) for one, own in zip(felt, brought, strict=True)]
    return None if by_chance(gain, 1 if place is None else 4, 2 * len(links)) else best


def _summed(felt: Sequence[Felt], floors: Sequence[float], k: int) -> tuple[np.ndarray, np.ndarray]:
    """Normal matrix, shape (10, 10), and right-hand side of a link's numbers, of all parts."""
    sized = [(one.columns[:, k] / f, one.left / f) for one, f in zip(felt, floors, strict=True)]
    normal = np.sum([columns.T @ columns for columns, _ in sized], axis=0)
    return normal, np.sum([columns.T @ left for columns, left in sized], axis=0)


def _heavier(
    felt: Sequence[Felt], floors: Sequence[float], k: int, link: str, numbers: Numbers
) -> tuple[float, None, float]:
    """Fall of chi-squared by as much more of a link as does best, no place, and how much [kg]."""
    normal, right = _summed(felt, floors, k)
    own = numbers(link, None)
    norm = float(own @ normal @ own)
    return (float(own @ right) ** 2 / norm, None, float(own @ right) / norm) if norm > 0.0 else (0.0, None, 0.0)


def _point(
    felt: Sequence[Felt], floors: Sequence[float], k: int, link: str, numbers: Numbers
) -> tuple[float, np.ndarray, float]:
    """Fall of chi-squared by the best point mass at a link, its place, shape (3,), and mass."""
    normal, right = _summed(felt, floors, k)

    def loss(place: np.ndarray) -> float:
        own = numbers(link, place)
        norm = float(own @ normal @ own)
        return -(float(own @ right) ** 2) / norm if norm > 0.0 else 0.0

    starts = [np.zeros(3), *ASIDE * np.eye(3), *-ASIDE * np.eye(3)]
    ends = [minimize(loss, start, method="L-BFGS-B", bounds=[(-REACH, REACH)] * 3) for start in starts]
    place = np.asarray(min(ends, key=lambda end: float(end.fun)).x)
    own = numbers(link, place)
    return -loss(place), place, float(own @ right) / max(float(own @ normal @ own), np.finfo(float).tiny)
