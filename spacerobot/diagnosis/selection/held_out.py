"""Prediction of what a fit has not seen: folds by condition, and a held-out trial's own start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter

import numpy as np

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import common_level, levels_of
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.windows import FOLDS
from spacerobot.diagnosis.terms.data import TrialData, recorded_id
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.errors import SimulationError

MOST = 12
"""Conditions, or trials, that are left out one by one to try a candidate; of more, so many groups are in turn."""

MOST_FOLDS = 6
"""The same where everything is decided again without them."""

HEAD = 1.0
"""Share of a held-out trial that tells how it starts; how it starts is not what is tested."""

FAINTLY = 1e-6
"""What a start's first estimate counts, which is from a few readings about it, where a start is what fits its piece
best. Counted whole, under weights that count independent samples, it would overrule all the others (an air bed's
velocity, from a second of readings while thrusters fire, is off by ten of its standard deviations)."""

FIT_STEPS = 12
"""Of each fit to the other trials: it begins at what all of them led to."""

STEPS = 2
"""Gauss-Newton steps to a held-out trial's start; a start moves the track nearly in proportion."""


def folds(trials: Sequence[TrialData], most: int = MOST) -> list[tuple[str, tuple[str, ...]]]:
    """What is left out in turn: conditions; where there is but one, its trials; where there is but one, parts of it.

    Of more than `most` of them, so many groups.

    Returns:
        (label, trial ids) each; at least two, unless there is but one trial in one piece.
    """
    for label in (attrgetter("condition"), attrgetter("recorded")):
        names = list(dict.fromkeys(label(t) for t in trials))
        if len(names) > most:
            groups = [set(names[k::most]) for k in range(most)]
            return [(f"every {most}th", tuple(t.id for t in trials if label(t) in g)) for g in groups]
        if len(names) > 1:
            return [(n, tuple(t.id for t in trials if label(t) == n)) for n in names]
    # a piece in which the machine stands on goes with the one it repeats, or each would foretell the other
    own = {t.id: t.told_by for t in trials}
    if len(set(own.values())) == 1:  # it stands all along
        own = {name: name for name in own}
    told = list(dict.fromkeys(own.values()))
    parts = np.array_split(np.array(told), min(FOLDS, len(told)))
    return [(f"part {i + 1}", tuple(name for name, by in own.items() if by in p)) for i, p in enumerate(parts)]


def scheme_of(trials: Sequence[TrialData], most: int = MOST) -> str:
    """What `folds` leaves out in turn, in words."""
    for what, of in (("condition", attrgetter("condition")), ("trial", attrgetter("recorded"))):
        count = len({of(t) for t in trials})
        if count > most:
            return f"leave every {most}th {what} out"
        if count > 1:
            return f"leave one {what} out"
    return f"leave one part of {FOLDS} out"


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Prediction errors of trials that a fit had not seen.

    Attributes:
        residual: trial -> weighted residual, shape (S,), predicted minus measured, zero where not counted.
        counted: trial -> which samples count, shape (S,).
        paid: by trial, what its condition's own values cost under their prior where they were found from it.
        failed: trial -> why it could not be predicted; its residual is then that of predicting each channel's mean.
        cuts: trial -> where one channel's samples end and the next one's begin; all are one channel's where absent.
    """

    residual: Mapping[str, np.ndarray]
    counted: Mapping[str, np.ndarray]
    paid: Mapping[str, float] = field(default_factory=dict)
    failed: Mapping[str, str] = field(default_factory=dict)
    cuts: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    @property
    def chi2(self) -> dict[str, float]:
        """By trial, the sum of squares and what its condition's own values cost."""
        return {k: float(r @ r) + self.paid.get(k, 0.0) for k, r in self.residual.items()}

    @property
    def total(self) -> float:
        """chi-squared over all trials."""
        return float(sum(self.chi2.values()))

    @property
    def mean_square(self) -> float:
        """Over all samples."""
        return self.total / max(sum(int(c.sum()) for c in self.counted.values()), 1)

    @property
    def together(self) -> float:
        """Root of the channels' mean squares, of all as if each were told as well: their geometric mean."""
        rows: dict[int, list[tuple[float, int]]] = {}
        for trial in self.residual:
            for k, (piece, counted) in enumerate(self.pieces(trial)):
                rows.setdefault(k, []).append((float(piece @ piece), int(counted.sum())))
        squares, counts = np.array([np.sum(some, axis=0) for some in rows.values()]).reshape(-1, 2).T
        return float(np.sqrt(common_level(squares, counts)))

    def pieces(self, trial: str) -> list[tuple[np.ndarray, np.ndarray]]:
        """Residual of each channel of a trial, and which of its samples count, shape (T,) each."""
        cuts = self.cuts.get(trial, ())
        return list(zip(np.split(self.residual[trial], cuts), np.split(self.counted[trial], cuts), strict=True))

    def of(self, trials: Sequence[str]) -> HeldOut:
        """Of some of the trials alone."""
        return HeldOut(*({t: told[t] for t in trials if t in told} for told in vars(self).values()))

    def rms(self, trials: Sequence[TrialData]) -> dict[str, float]:
        """By channel, in the channel's unit."""
        return levels_of(self.residual, trials, self.counted)


def start_of(
    fitter: Fitter,
    model: Machine,
    hypothesis: Hypothesis,
    z: np.ndarray,
    trial: TrialData,
    head: float = HEAD,
    trust: float = 1.0,
) -> np.ndarray:
    """How an unseen trial starts, shape (N,), given everything else: found from the trial itself.

    Gauss-Newton steps of the head's residual, with the reading at its start as a prior of its own standard deviation,
    which counts `trust` times.
    """
    nuisances = model.nuisances(trial)
    guess = np.array([n.guess for n in nuisances])
    if not nuisances or head <= 0.0:
        return guess
    early = np.concatenate(
        [np.tile(b.time <= trial.start + head * (trial.end - trial.start), len(b.channels)) for b in trial.blocks]
    )
    scales = np.array([n.scale for n in nuisances])
    start = guess
    for _ in range(STEPS):
        base, keep = fitter.residual(hypothesis, z, trial, start)
        columns = np.empty((base.size, scales.size))
        for n, scale in enumerate(scales):
            if (added := fitter.added(trial, n)) is not None:
                columns[:, n] = scale * added
                continue
            moved, by = start.copy(), max(1.0, nuisances[n].floor)
            moved[n] += by * scale
            columns[:, n] = (fitter.residual(hypothesis, z, trial, moved)[0] - base) / by
        j, r = columns[early & keep], base[early & keep]
        prior = (start - guess) / scales
        start = start - scales * np.linalg.solve(j.T @ j + trust * np.eye(scales.size), j.T @ r + trust * prior)
    return start


def predict_held_out(
    model: Machine,
    trials: Sequence[TrialData],
    made: Hypothesis,
    warm: Mapping[str, float],
    left_out: Sequence[tuple[str, tuple[str, ...]]],
    initials: Mapping[str, np.ndarray] | None = None,
    *,
    shown: Machine | None = None,
    head: float = HEAD,
    trust: float = 1.0,
) -> HeldOut:
    """Every trial predicted by a fit that has not seen its fold.

    Args:
        model: that is fitted.
        trials: its trials.
        made: which effects.
        warm, initials: where each fit begins.
        left_out: folds, each a name and ids of trials.
        shown: the same model cut into other pieces, which are predicted instead of the fold's own trials.
        head, trust: how an unseen trial's start is found, see `start_of`.

    Raises:
        SimulationError: a fold cannot be fitted, or a trial not be predicted.
    """
    residual: dict[str, np.ndarray] = {}
    counted: dict[str, np.ndarray] = {}
    cuts: dict[str, tuple[int, ...]] = {}
    for _, ids in left_out:
        seen = [t for t in trials if t.id not in ids]
        if not seen:
            raise SimulationError("nothing is left to fit when a fold is left out")
        own = None if initials is None else {t.id: initials[t.id] for t in seen}
        fit = Fitter(model, seen).fit(made, warm=warm, initials=own, max_iterations=FIT_STEPS, robust=False)
        if shown is None or shown is model:  # the pieces as they will be compared, with their own weights
            teller, unseen = model, [t for t in (trials if shown is None else shown.trials) if t.id in ids]
        else:
            whole = {recorded_id(i) for i in ids}
            teller, unseen = shown, [t for t in shown.trials if t.recorded in whole]
        fitter = Fitter(teller, unseen)
        for trial in unseen:
            start = start_of(fitter, teller, made, fit.z, trial, head, trust)
            r, keep = fitter.residual(made, fit.z, trial, start)
            residual[trial.id], counted[trial.id], cuts[trial.id] = np.where(keep, r, 0.0), keep, trial.cuts
    return HeldOut(residual, counted, cuts=cuts)
