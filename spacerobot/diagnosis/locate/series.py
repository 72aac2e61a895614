"""Locate in residuals that are already seen through test functions, such as the torque balances of joint logs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spacerobot.diagnosis.locate import significance
from spacerobot.diagnosis.locate.dependence import Extent, patterns_of_motion
from spacerobot.diagnosis.locate.located import ALL, BINS, Located, Surface, Total
from spacerobot.diagnosis.locate.search import Search
from spacerobot.support.errors import InputError


@dataclass(frozen=True, eq=False)
class BalanceSeries:
    """One balance along one trial. R readings, Q points of the measured motion.

    Attributes:
        balance: whose, e.g. "joint.NAME".
        angular: whether its coordinate is an angle.
        trial: id.
        residual: the known forces, the drive's among them, less those that the motion needs [N or N m], shape (R,).
        sigma: standard deviation of its noise, or any guess of it, shape (R,).
        displacement, velocity: of the coordinate, shape (Q,).
        see: from patterns at the points, shape (Q, K), to the readings, shape (R, K), as the residual was seen.
        wrong: believed value's name -> change of the residual by one standard deviation of it, shape (R,).
    """

    balance: str
    angular: bool
    trial: str
    residual: np.ndarray
    sigma: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    see: Callable[[np.ndarray], np.ndarray]
    wrong: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.residual.shape != self.sigma.shape or not np.all(self.sigma > 0.0):
            raise InputError(
                "a residual needs a positive sigma for each reading", where=f"{self.balance}, {self.trial}"
            )

    @property
    def unit(self) -> str:
        """Of the residual."""
        return "N m" if self.angular else "N"


def locate_series(series: Sequence[BalanceSeries], *, noise_known: bool = False) -> Located:
    """Test the residuals of some balances for what they depend on.

    Args:
        series: all trials of all balances.
        noise_known: whether the sigmas are those of the sensors; else the residuals' own spread stands for them.

    Raises:
        InputError: nothing to test.
    """
    if not series:
        raise InputError("no balance to locate in")
    names = list(dict.fromkeys(s.balance for s in series))
    search = Search()
    drawn: list[Surface] = []
    for name in names:
        own = [s for s in series if s.balance == name]
        reach = [(float(s.displacement.min()), float(s.displacement.max())) for s in own]
        extent = Extent(min(r[0] for r in reach), max(r[1] for r in reach), 0.0)
        chi2, freedom = 0.0, 0
        for one in own:
            clean = _LowRank(one.wrong, one.sigma)
            white = clean(one.residual)
            chi2, freedom = chi2 + float(white @ white), freedom + white.size
            quiet = np.zeros(one.velocity.shape)
            found = patterns_of_motion(one.displacement, one.velocity, np.sign(one.velocity), quiet, extent)
            for depends_on, pattern in found.items():
                if np.any(pattern.values):
                    rows = one.see(pattern.values.T)
                    score = search.score((name, ALL, depends_on), pattern.at)
                    score.add(white, clean(rows), rows / one.sigma[:, None])
        p = math.exp(significance.log_p_chi2(chi2, max(freedom, 1))) if noise_known else math.nan
        # noise that is not known accounts for none of it: a pattern's share is one of all that is left over
        search.totals[name] = Total(name, own[0].unit, chi2, freedom if noise_known else 0, p)
        drawn += _surfaces(own)
    return Located(search.rows(noise_known), tuple(drawn), tuple(search.totals[n] for n in names))


class _LowRank:
    """Whitens independent noise with a few directions of believed values on top: (I + N N^T)^(-1/2)."""

    def __init__(self, wrong: Mapping[str, np.ndarray], sigma: np.ndarray) -> None:
        self.sigma = sigma
        columns = np.array([c / sigma for c in wrong.values()]).reshape(len(wrong), sigma.size).T
        self.basis, size, _ = np.linalg.svd(columns, full_matrices=False)
        self.shrink = 1.0 - 1.0 / np.sqrt(1.0 + size**2)

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        """Whitened rows, shape (R,) or (R, K)."""
        scaled = (rows.T / self.sigma).T
        return np.asarray(scaled - self.basis @ ((self.basis.T @ scaled).T * self.shrink).T)


def _surfaces(own: Sequence[BalanceSeries]) -> list[Surface]:
    """Mean residual by displacement and by velocity, with the standard error that its own spread gives."""
    length = "rad" if own[0].angular else "m"
    y = np.concatenate([s.residual for s in own])
    out = []
    for quantity, unit in (("displacement", length), ("velocity", f"{length}/s")):
        x = np.concatenate([s.see(getattr(s, quantity)[:, None])[:, 0] for s in own])
        edges = np.linspace(float(x.min()), float(x.max()), BINS + 1)
        index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, BINS - 1)
        counts = np.bincount(index, minlength=BINS)
        use = np.flatnonzero(counts > 2)
        if use.size < 2:
            continue
        means = [(float(x[index == k].mean()), float(y[index == k].mean())) for k in use]
        errors = [float(y[index == k].std(ddof=1) / np.sqrt(counts[k])) for k in use]
        centres, values = np.array(means).T
        out.append(Surface(own[0].balance, quantity, unit, centres, values, np.array(errors), own[0].unit))
    return out
