"""The search: every pattern in every balance and phase, every fault of every sensor."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from spacerobot.diagnosis.locate import significance
from spacerobot.diagnosis.locate.balances import BODY
from spacerobot.diagnosis.locate.dependence import FREQUENCY, Extent, Pattern, regressors
from spacerobot.diagnosis.locate.located import ALL, Row, Total
from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.locate.scores import Score, Verdict
from spacerobot.diagnosis.locate.sensor_faults import faults

Key = tuple[str, str, str]
"""(balance, phase, depends_on)"""

CLEAR = 0.05
"""Rows with a larger p come after all others."""

TOO_FAINT = 1e-3
"""A phase in which a pattern has less than this share of its information in the whole trial does not show it."""

MOST_FREQUENCIES = 120


class Search:
    """Collects the scores of all patterns."""

    def __init__(self) -> None:
        self.scores: dict[Key, Score] = {}
        self.totals: dict[str, Total] = {}

    def balance(self, name: str, prepared: Mapping[str, Prepared], extent: Extent) -> None:
        """Test one balance in all trials that have it."""
        chi2, freedom, unit = 0.0, 0, ""
        grid = _frequencies(prepared)
        for one in prepared.values():
            if name not in one.found:
                continue
            unit = one.found[name].unit
            tested = one.tested(name)
            chi2 += float(tested.white @ tested.white)
            freedom += tested.white.size
            patterns = _patterns(one, name, extent, grid)
            rows = one.seen(name, np.concatenate([p.values for p in patterns.values()]).T)
            white, exact = tested.whiten(rows), tested.exact(rows)
            first = 0
            for (phase, depends_on), pattern in patterns.items():
                part = slice(first, first + pattern.at.size)
                first = part.stop
                score = self.score((name, phase, depends_on), pattern.at)
                score.add(tested.white, white[:, part], exact[:, part])
        p = math.exp(significance.log_p_chi2(chi2, max(freedom, 1)))
        self.totals[name] = Total(name, unit, chi2, freedom, p)

    def sensors(self, prepared: Mapping[str, Prepared]) -> None:
        """Test the faults of every suspect sensor in all bodies' balances of each trial together.

        The bodies' balances share little noise: each trial's scores are added up as if they shared none.
        """
        for one in prepared.values():
            for sensor, channels in one.suspects.items():
                for name, balance in one.found.items():
                    if balance.kind != BODY:
                        continue
                    tested = one.tested(name)
                    columns = faults(one.weak, channels, tested.residual)
                    if not any(np.any(c) for c in columns.values()):
                        continue
                    old = self.totals.get(sensor, Total(sensor, "", 0.0, 0, 1.0))
                    chi2, freedom = old.chi2 + float(tested.white @ tested.white), old.freedom + tested.white.size
                    self.totals[sensor] = Total(sensor, "", chi2, freedom, 1.0)
                    for depends_on, column in columns.items():
                        score = self.score((sensor, ALL, depends_on), np.array([np.nan]))
                        rows = column[:, None]
                        score.add(tested.white, tested.whiten(rows), tested.exact(rows))

    def score(self, key: Key, at: np.ndarray) -> Score:
        """The collected scores of one test; `at` distinguishes its variants, shape (V,)."""
        return self.scores.setdefault(key, Score(at))

    def rows(self, noise_known: bool = True) -> tuple[Row, ...]:
        """All tests, most significant first, corrected for their number.

        Where the noise is not known, those found come in the order of how much of their residual they explain.
        """
        drafts: list[tuple[Key, Verdict]] = []
        for key, score in self.scores.items():
            whole = self.scores.get((key[0], ALL, key[2]))
            least = 0.0 if whole is None else TOO_FAINT * float(np.max(whole.information))
            found = score.verdict(least, noise_known)
            if found is not None:
                drafts.append((key, found))
        corrected = significance.holm([v.log_p for _, v in drafts])
        rows = [self._row(key, v, p, noise_known) for (key, v), p in zip(drafts, corrected, strict=True)]
        if noise_known:
            return tuple(sorted(rows, key=lambda r: (r.p >= CLEAR, r.log_p)))
        return tuple(sorted(rows, key=lambda r: (r.p >= CLEAR, -r.share if r.p < CLEAR else r.log_p)))

    def _row(self, key: Key, v: Verdict, p: float, noise_known: bool) -> Row:
        """A test as told. Noise that is not known accounts for none of what is left: a share is one of all of it."""
        total = self.totals[key[0]]
        left = total.chi2 - total.freedom * noise_known
        share = min(v.fall / max(left, v.fall), 1.0) if v.fall > 0.0 else 0.0
        return Row(*key, share, max(p, v.p_flips), v.score, v.coefficient, v.error, v.at, v.log_p, v.p_flips)


def _patterns(one: Prepared, name: str, extent: Extent, grid: np.ndarray) -> dict[tuple[str, str], Pattern]:
    """(phase, depends_on) -> pattern, whole and cut to each phase; a resonance is sought in the whole trial only."""
    out = {}
    nodes = one.weak.nodes
    for depends_on, whole in regressors(one.weak, one.mechanism, one.found[name], extent, grid).items():
        if not np.any(whole.values):
            continue
        out[ALL, depends_on] = whole
        if len(one.weak.phases) > 1 and depends_on != FREQUENCY:
            for phase, (begin, end) in one.weak.phases.items():
                inside = (nodes >= begin) & (nodes < end)
                if np.any(whole.values[:, inside]):
                    out[phase, depends_on] = Pattern(whole.values * inside, whole.at)
    return out


def _frequencies(prepared: Mapping[str, Prepared]) -> np.ndarray:
    """Frequencies [Hz] from two periods a trial to what the test functions resolve, half a period a trial apart."""
    longest = max(p.weak.end - p.weak.start for p in prepared.values())
    finest = max(p.weak.spacing for p in prepared.values())
    low, high = 2.0 / longest, 0.25 / finest
    return np.linspace(low, high, int(np.clip(2.0 * longest * (high - low), 2, MOST_FREQUENCIES)))
