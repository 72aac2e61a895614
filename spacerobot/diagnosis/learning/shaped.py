"""Words of a formula that have numbers of their own, where they come nearest to a curve: a rise, a wave, a power."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from spacerobot.effects.formula import WORDS
from spacerobot.effects.learned import Shape

BUMPS = 24
"""Places, and half as many widths, at which a local rise is tried before it is moved to its best."""

CROWDED = 12
"""Waves that the range of a curve holds at most, to be read off its coefficients."""

POWERS = (0.2, 4.0)
"""Exponents between which a power is looked for."""


@dataclass(frozen=True)
class Term:
    """A word, of a local rise or a wave with its place and width or length, of a power with its exponent as width."""

    word: str
    place: float = 0.0
    width: float = 1.0

    def numbers(self, key: str) -> dict[str, float]:
        """By parameter, beside its coefficient."""
        both = {"place": self.place, "width": self.width, "length": self.width, "exponent": self.width}
        return {f"{key}_{name}": both[name] for name in WORDS[self.word].further}


def shaped(shape: Shape, word: str, cost: Callable[[Term], float]) -> Iterator[Term]:
    """The best wave, of a force of the displacement; the best power, of one of a rate or a displacement."""
    from scipy.optimize import minimize, minimize_scalar

    reach = shape.high - shape.low
    if shape.kind != "force" or (word == "power" and shape.of == "q") or (word == "wave" and shape.of == "v"):
        return
    if word == "power":
        found = minimize_scalar(lambda n: cost(Term("power", 0.0, n)), bounds=POWERS, method="bounded")
        yield Term("power", 0.0, float(found.x))
        return
    lengths = [reach] if shape.of == "q" else (reach / np.arange(1.0, CROWDED + 0.5, 0.5)).tolist()
    starts = [Term("wave", shape.low + phase * n, n) for n in lengths for phase in np.arange(8) / 8.0]
    start = min(starts, key=cost)
    if shape.of == "q":
        found = minimize_scalar(
            lambda x: cost(Term("wave", x, reach)), bounds=(start.place - reach / 8.0, start.place + reach / 8.0)
        )
        yield Term("wave", float(found.x), reach)
        return

    def moved(step: np.ndarray) -> Term:
        return Term("wave", start.place + 0.1 * start.width * step[0], start.width * float(np.exp(0.02 * step[1])))

    def price(step: np.ndarray) -> float:
        return cost(moved(step))

    yield moved(minimize(price, np.zeros(2), method="Nelder-Mead").x)


def bumps(shape: Shape, cost: Callable[[Term], float]) -> Iterator[Term]:
    """The best local rise there is."""
    if shape.kind == "memory":
        return
    from scipy.optimize import minimize

    low, high = shape.low, shape.high
    places = np.linspace(low, high, BUMPS)
    widths = np.geomspace(0.03, 0.5, BUMPS // 2) * (high - low)
    start = min((Term("rise", p, w) for p in places.tolist() for w in widths.tolist()), key=cost)
    scale = 0.05 * (high - low)

    narrow = (high - low) / shape.cells

    def moved(step: np.ndarray) -> Term:
        place = float(np.clip(start.place + scale * step[0], low, high))
        return Term("rise", place, float(max(start.width * np.exp(step[1]), narrow)))

    def price(step: np.ndarray) -> float:
        return cost(moved(step))

    yield moved(minimize(price, np.zeros(2), method="Nelder-Mead").x)
