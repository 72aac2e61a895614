"""Locate: which balance does not close, in which phase, and what its residual depends on."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.hypothesis import Believed
from spacerobot.diagnosis.locate import significance
from spacerobot.diagnosis.locate.balances import Balance, balances
from spacerobot.diagnosis.locate.beliefs import deviations, directions
from spacerobot.diagnosis.locate.clock import clocks
from spacerobot.diagnosis.locate.dependence import FREQUENCY, Extent, extents, oscillation, regressors
from spacerobot.diagnosis.locate.integral import stacked
from spacerobot.diagnosis.locate.located import ALL, Located, Row, Total
from spacerobot.diagnosis.locate.sensors import faults
from spacerobot.diagnosis.locate.surfaces import surfaces
from spacerobot.diagnosis.locate.weak_trial import WeakTrial
from spacerobot.diagnosis.locate.whitening import Whitener, noise, with_directions
from spacerobot.effects.mechanism import Mechanism

Key = tuple[str, str, str]
"""(balance, phase, depends_on)"""

TOO_FAINT = 1e-6
"""A pattern with less than this share of the information of its balance's strongest is not there to be seen."""


class BalanceModel(Protocol):
    """What locating needs of a model."""

    believed: Believed
    base: dict[str, float]


@dataclass(frozen=True, eq=False)
class Prepared:
    """One trial, ready to be tested."""

    weak: WeakTrial
    mechanism: Mechanism
    found: dict[str, Balance]
    wrong: dict[str, dict[str, np.ndarray]]  # balance -> value -> (I,) one standard deviation


def mechanism_of(model: BalanceModel, values: Mapping[str, float], trial: TrialData) -> Mechanism:
    """The baseline of one trial, from a rig (one mechanism for all) or a model whose mechanism asks for the trial."""
    make = model.mechanism  # type: ignore[attr-defined]
    asks = make.__code__.co_argcount - 1 if hasattr(make, "__code__") else 1
    return make(values) if asks == 1 else make(values, trial)  # type: ignore[no-any-return]


def believed_values(model: BalanceModel, trials: Sequence[TrialData]) -> dict[str, dict[str, float]]:
    """Trial id -> the values as believed, the trial's overrides on top."""
    return {t.id: {**model.believed.unknown, **model.base, **t.overrides} for t in trials}


def locate(
    model: BalanceModel,
    trials: Sequence[TrialData],
    values_by_trial: Mapping[str, Mapping[str, float]] | None = None,
    *,
    seed: int = 0,
) -> Located:
    """Test every balance that the channels allow against the sensors' noise.

    Args:
        model: a rig or another model with `mechanism`, `believed` and `base`.
        trials: the recordings.
        values_by_trial: trial id -> values to balance with, by dotted name (those of the refitted baseline); as
            believed where absent.
        seed: of random sign flips.

    Raises:
        InputError: a trial too short for a balance, or without a channel that measures the model.
    """
    values = values_by_trial if values_by_trial is not None else believed_values(model, trials)
    prepared = {t.id: _prepare(model, t, values[t.id], trials) for t in trials}
    reach = extents({k: p.weak for k, p in prepared.items()}, {k: p.found for k, p in prepared.items()})
    names = list(dict.fromkeys(n for p in prepared.values() for n in p.found))
    tests: dict[Key, _Test] = {}
    totals = []
    cuts = math.ceil(significance.ENOUGH_UNITS / len(trials))
    for name in names:
        total = _test_balance(name, prepared, reach[name], tests, cuts)
        totals.append(total)
    sensor_totals = _test_sensors(prepared, tests, cuts)
    rows = _rows(tests, {**{t.balance: t for t in totals}, **sensor_totals}, seed)
    return Located(
        rows,
        surfaces(prepared, names),
        tuple(totals),
        clocks(prepared),
        {k: p.weak.phases for k, p in prepared.items()},
    )


def _prepare(
    model: BalanceModel, trial: TrialData, values: Mapping[str, float], trials: Sequence[TrialData]
) -> Prepared:
    mechanism = mechanism_of(model, values, trial)
    weak = WeakTrial(trial, mechanism)
    found = balances(weak, mechanism)
    sizes = deviations(model.believed, values, trials)
    clean = weak.without_noise()
    wrong = directions(
        values, sizes, balances(clean, mechanism), lambda v: balances(clean, mechanism_of(model, v, trial))
    )
    return Prepared(weak, mechanism, found, wrong)


class _Test:
    """Scores of one pattern, unit by unit. A unit is a trial, or a stretch of one."""

    def __init__(self) -> None:
        self.score: list[float] = []
        self.information: list[float] = []
        self.oscillations: list[np.ndarray] = []  # per trial: fall of chi-squared at each frequency, shape (F,)
        self.frequencies: np.ndarray | None = None

    def add(self, residual: np.ndarray, pattern: np.ndarray, cuts: int) -> None:
        for part in np.array_split(np.arange(residual.size), cuts):
            self.score.append(float(pattern[part] @ residual[part]))
            self.information.append(float(pattern[part] @ pattern[part]))


def _test_balance(
    name: str, prepared: Mapping[str, Prepared], extent: Extent, tests: dict[Key, _Test], cuts: int
) -> Total:
    chi2, freedom, unit = 0.0, 0, "N"
    grid = _frequencies(prepared)
    for one in prepared.values():
        if name not in one.found:
            continue
        balance, weak = one.found[name], one.weak
        keep, unit = balance.keep, balance.unit
        residual = balance.residual.rows(keep)
        wrong = {k: v[keep] for k, v in one.wrong[name].items()}
        whiten = Whitener(with_directions(noise(weak, residual), wrong))
        white = whiten(residual.value)
        chi2 += float(white @ white)
        freedom += white.size
        patterns: dict[Key, np.ndarray] = {}
        for depends_on, b in regressors(weak, one.mechanism, balance, extent).items():
            if not np.any(b):
                continue
            patterns[name, ALL, depends_on] = b
            if len(weak.phases) > 1:
                for phase, (begin, end) in weak.phases.items():
                    part = np.where((weak.nodes >= begin) & (weak.nodes < end), b, 0.0)
                    if np.any(part):
                        patterns[name, phase, depends_on] = part
        waves = np.concatenate([oscillation(weak, f) for f in grid])
        columns = np.stack([*(weak.integral(0, b)[keep] for b in patterns.values())], axis=1)
        seen = whiten(np.concatenate([columns, np.asarray(weak.integral(0, waves.T))[keep]], axis=1))
        for key, column in zip(patterns, seen.T, strict=False):
            tests.setdefault(key, _Test()).add(white, column, cuts)
        test = tests.setdefault((name, ALL, FREQUENCY), _Test())
        test.frequencies = grid
        test.oscillations.append(_falls(white, seen[:, len(patterns) :]))
    return Total(name, unit, chi2, freedom, math.exp(significance.log_p_chi2(chi2, max(freedom, 1))))


def _frequencies(prepared: Mapping[str, Prepared]) -> np.ndarray:
    """Frequencies [Hz] from two periods a trial to what the test functions resolve, half a period a trial apart."""
    longest = max(p.weak.end - p.weak.start for p in prepared.values())
    finest = max(p.weak.spacing for p in prepared.values())
    step = max(0.5 / longest, (0.25 / finest - 2.0 / longest) / 120.0)
    return np.arange(2.0 / longest, 0.25 / finest, step)


def _falls(white: np.ndarray, waves: np.ndarray) -> np.ndarray:
    """Fall of chi-squared by the sine and cosine of each frequency, columns in pairs; shape (F,)."""
    pairs = waves.reshape(white.size, -1, 2)
    gram = np.einsum("rfi,rfj->fij", pairs, pairs)
    right = np.einsum("rfi,r->fi", pairs, white)
    ridge = 1e-9 * (np.trace(gram, axis1=1, axis2=2)[:, None, None] + 1e-300) * np.eye(2)
    solved = np.linalg.solve(gram + ridge, right[..., None])[..., 0]
    return np.asarray(np.einsum("fi,fi->f", right, solved))


def _test_sensors(prepared: Mapping[str, Prepared], tests: dict[Key, _Test], cuts: int) -> dict[str, Total]:
    chi2: dict[str, float] = {}
    freedom: dict[str, int] = {}
    for one in prepared.values():
        sensors = suspects(one)
        if not sensors:
            continue
        used = list(one.found.values())
        stack = stacked([b.residual.rows(b.keep) for b in used])
        names = dict.fromkeys(v for b in used for v in one.wrong[b.name])
        wrong = {
            v: np.concatenate(
                [one.wrong[b.name].get(v, np.zeros(b.keep.size))[b.keep] for b in used]
            )
            for v in names
        }
        whiten = Whitener(with_directions(noise(one.weak, stack), wrong))
        white = whiten(stack.value)
        for sensor, channels in sensors.items():
            chi2[sensor] = chi2.get(sensor, 0.0) + float(white @ white)
            freedom[sensor] = freedom.get(sensor, 0) + white.size
            for depends_on, column in faults(one.weak, channels, stack).items():
                if np.any(column):
                    tests.setdefault((sensor, ALL, depends_on), _Test()).add(white, whiten(column), cuts)
    return {s: Total(s, "", chi2[s], freedom[s], 1.0) for s in chi2}


def suspects(one: Prepared) -> dict[str, tuple[str, ...]]:
    """Sensors to test, with their channels: all but the one that shows most positions, against which they are held."""
    shown = {
        name: tuple(c for c in channels if c in one.weak.series) for name, channels in one.mechanism.sensors.items()
    }
    shown = {name: channels for name, channels in shown.items() if channels}
    if not shown:
        return {}
    reference = max(shown, key=lambda n: sum(c in one.weak.observers.rows for c in shown[n]))
    return {n: c for n, c in shown.items() if n != reference}


def _rows(tests: Mapping[Key, _Test], totals: Mapping[str, Total], seed: int) -> tuple[Row, ...]:
    strongest: dict[tuple[str, str], float] = {}
    for (balance, _, depends_on), test in tests.items():
        if test.frequencies is None:
            pair = balance, depends_on
            strongest[pair] = max(strongest.get(pair, 0.0), sum(test.information))
    flips: dict[int, np.ndarray] = {}
    drafts: list[tuple[Key, float, float, float, float, float, float]] = []
    for key, test in tests.items():
        if test.frequencies is not None:
            drafts.append((key, *_oscillates(test)))
            continue
        information = sum(test.information)
        if information <= TOO_FAINT * strongest[key[0], key[2]] or information == 0.0:
            continue
        score = sum(test.score) / math.sqrt(information)
        units = len(test.score)
        if units not in flips:
            flips[units] = significance.sign_flips(units, seed)
        p_flips = significance.flip_p(np.array(test.score), flips[units])
        coefficient, error = sum(test.score) / information, 1.0 / math.sqrt(information)
        drafts.append((key, significance.log_p_normal(score), score, score**2, coefficient, error, p_flips))
    corrected = significance.holm([d[1] for d in drafts])
    rows = []
    for ((balance, phase, depends_on), log_p, score, fall, coefficient, error, p_flips), p in zip(
        drafts, corrected, strict=True
    ):
        total = totals[balance]
        share = min(fall / max(total.chi2 - total.freedom, fall), 1.0) if fall > 0.0 else 0.0
        bounded = p if math.isnan(p_flips) else max(p, p_flips)
        rows.append(
            Row(balance, phase, depends_on, share, bounded, score, coefficient, error, log_p, _or_one(p_flips))
        )
    rows.sort(key=lambda r: (r.p >= 0.05, r.log_p))
    return tuple(rows)


def _or_one(p: float) -> float:
    return 1.0 if math.isnan(p) else p


def _oscillates(test: _Test) -> tuple[float, float, float, float, float, float]:
    """log p, score, fall, frequency, resolution, no flips: of the frequency that all trials together show best."""
    assert test.frequencies is not None  # asked only of such tests
    falls = np.sum(test.oscillations, axis=0)
    best = int(np.argmax(falls))
    fall = float(falls[best])
    step = float(test.frequencies[1] - test.frequencies[0]) if test.frequencies.size > 1 else math.nan
    log_p = significance.log_p_chi2(fall, 2 * len(test.oscillations))
    log_p = significance.combined(log_p, max(1, test.frequencies.size))
    return log_p, math.sqrt(max(fall, 0.0)), fall, float(test.frequencies[best]), step, math.nan
