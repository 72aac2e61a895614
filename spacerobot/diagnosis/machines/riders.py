"""What rides on a machine's coordinates where a window begins: as the trial up to there has shaken it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.reduced.run import ReducedRun

Beside = Mapping[str, tuple[float, float]]
"""By rider, its displacement and rate beside what carries it."""

SETTLED: Beside = {}
"""Riders that move along with what carries them."""

MOST = 256
"""Trials kept at a time, each under one mechanism: all columns of a Jacobian in a few trials."""

State = tuple[dict[str, float], dict[str, float]]
"""Positions and velocities by coordinate."""

Run = Callable[[TrialData, State], ReducedRun]


def riding(mechanism: Mechanism) -> list[str]:
    """Coordinates that another carries, and that no window's own readings tell where they are."""
    return [n for n in mechanism.coordinates if mechanism.carrier_of(n) is not None]


def placed(mechanism: Mechanism, state: State, beside: Beside) -> State:
    """A window's start with what rides put where it is beside its carrier."""
    position, velocity = (dict(of) for of in state)
    for name, (place, rate) in beside.items():
        carrier = str(mechanism.carrier_of(name))
        position[name] = mechanism.at_start(position)[carrier] + place
        velocity[name] = mechanism.at_start(velocity)[carrier] + rate
    return position, velocity


class Riders:
    """Where riders are as each window of a trial begins, found once for all windows of a trial under one mechanism."""

    def __init__(self) -> None:
        self._kept: dict[tuple[int, str], tuple[Mechanism, dict[float, Beside]]] = {}

    def beside(
        self,
        mechanism: Mechanism,
        window: TrialData,
        stretch: Callable[[], Iterable[tuple[TrialData, State | None]]],
        run: Run,
    ) -> Beside:
        """Of the window that begins there.

        From window to window what carries them begins anew where its readings have it, and they go on.

        Args:
            mechanism: with riders.
            window: whose start it is.
            stretch: all windows of its trial in order, each with where what is read begins by its own readings; None
                where these are kept aside, and it goes on from the window before.
            run: simulates a window.
        """
        key = id(mechanism), window.recorded
        found = self._kept.get(key)
        if found is None or found[0] is not mechanism:
            if len(self._kept) >= MOST:
                self._kept = {}
            found = self._kept[key] = mechanism, _along(mechanism, stretch(), run)
        starts = np.array(list(found[1]))
        return found[1][float(starts[np.argmin(np.abs(starts - window.start))])]


def _along(mechanism: Mechanism, stretch: Iterable[tuple[TrialData, State | None]], run: Run) -> dict[float, Beside]:
    names, found = riding(mechanism), {}
    shown = [n for n in mechanism.coordinates if n not in names]
    before: tuple[TrialData, State, Beside] | None = None
    for window, begins in stretch:
        beside, state = SETTLED, begins
        if before is not None and window.start <= before[0].end + 1e-6:  # it met nothing and was not left at rest
            made = run(before[0], placed(mechanism, *before[1:]))
            x, v = (of[0] for of in made.states(np.array([made.end])))
            at = {n: (float(x[k]), float(v[k])) for k, n in enumerate(mechanism.coordinates)}
            beside = {n: _difference(at[n], at[str(mechanism.carrier_of(n))]) for n in names}
            state = begins or ({n: at[n][0] for n in shown}, {n: at[n][1] for n in shown})
        found[window.start] = beside
        before = None if state is None else (window, state, beside)
    return found


def _difference(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    return one[0] - other[0], one[1] - other[1]
