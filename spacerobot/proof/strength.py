"""How strong a hidden effect is in a campaign: the oracle's likelihood ratio, and sizes that reach a given strength.

A test that knows which effect may be there, and fits it, gains the noncentrality lambda over the baseline: what the
baseline, refitted to the readings without noise, cannot explain. At the 5 % level it finds the effect in 95 % of
repetitions where lambda reaches `critical(p)`, p being the number of the effect's parameters. The detection limit is
the size at which it does; the strength is the square root of lambda over that, since lambda grows as the square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, ncx2

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import fit_from
from spacerobot.diagnosis.machines.bent import NOTHING, Bent, Beyond
from spacerobot.diagnosis.machines.whole_rig import rig_model
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.proof.campaign import Campaign, Readings, perform, write_study
from spacerobot.proof.sizes import Kind
from spacerobot.proof.whole.scene import WholeMachine
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.support.scratch import scratch

LEVEL, POWER = 0.05, 0.95

NEAR = 1.15
"""A size has reached its strength within this factor, where a row of the tables or a point of a curve states it."""

DRAWN = 1.3
"""And within this one where the strength was drawn at random."""

ATTEMPTS = 6


@cache
def critical(parameters: int) -> float:
    """Noncentrality at which a likelihood-ratio test with so many parameters has its power."""
    threshold = chi2.isf(LEVEL, parameters)
    return float(brentq(lambda x: ncx2.sf(threshold, parameters, x) - POWER, 1e-3, 200.0))


@dataclass(frozen=True, eq=False)
class Strength:
    """How visible the hidden physics of a campaign is.

    Attributes:
        noncentrality: lambda.
        samples: readings that count.
        parameters: of the hidden effects.
        clean: the readings without noise.
    """

    noncentrality: float
    samples: int
    parameters: int
    clean: Readings

    @property
    def limits(self) -> float:
        """Size in detection limits."""
        return math.sqrt(self.noncentrality / critical(self.parameters))

    @property
    def variance_ratio(self) -> float:
        """Residual variance after the baseline's refit, over the noise variance."""
        return 1.0 + self.noncentrality / self.samples


def measure(campaign: Campaign, plain: Readings | None = None) -> Strength:
    """Refit the baseline to the readings without noise; believed values are centred on the truth.

    Args:
        campaign: with what is hidden in it.
        plain: as `nothing_missing` has them; played here if None.

    Raises:
        SimulationError: the baseline cannot be fitted.
    """
    clean = perform(campaign)
    centred = _centred(campaign)
    plain = plain or nothing_missing(campaign)
    beyond, left = (NOTHING, 0.0) if plain is None else _left(centred, plain)
    fit = _refit(centred, clean, beyond)
    remounted = {t.overrides.get("target.mass", 0.0): t.values.wrist_stiffness for t in campaign.trials}
    scatter = campaign.belief.scatter.get("wrist.stiffness")
    owed = left
    if scatter and len(remounted) > 1 and plain is None:
        own = np.array(list(remounted.values())) / campaign.as_built["wrist.stiffness"] - 1.0
        owed = float(np.sum((own / scatter) ** 2))
    count = sum(len(m.values) for m in campaign.missing)
    return Strength(max(fit.cost - owed, 0.0), fit.samples, max(count, 1), clean)


def nothing_missing(campaign: Campaign) -> Readings | None:
    """What is recorded with nothing missing, of a machine that is fitted by its small motions; None of any other.

    What small motions leave of it is nothing hidden.
    """
    return perform(campaign.with_missing()) if isinstance(campaign, WholeMachine) else None


def _centred(campaign: Campaign) -> Campaign:
    named = {n: campaign.as_built[n] for n in campaign.belief.values if n in campaign.as_built}
    belief = replace(campaign.belief, values={**campaign.belief.values, **named})
    over = campaign.as_built.get("target.mass over believed", 1.0)
    trials = tuple(
        replace(t, overrides={n: v * (over if n == "target.mass" else 1.0) for n, v in t.overrides.items()})
        for t in campaign.trials
    )
    return replace(campaign, belief=belief, trials=trials)


def _refit(campaign: Campaign, clean: Readings, beyond: Beyond) -> Fit:
    """To its end, as the diagnosis fits: short of its minimum a baseline leaves what no oracle can gain."""
    model = _model(campaign, clean, beyond)
    return fit_from(Fitter(model, model.trials), model.believed, (), {})


def _model(campaign: Campaign, clean: Readings, beyond: Beyond = NOTHING) -> RigModel:
    with scratch() as folder:
        write_study(folder, campaign, clean, exact=True)
        study = load_study(folder)
        return rig_model(study, trial_data(study), beyond=beyond)


def _left(campaign: Campaign, plain: Readings) -> tuple[Beyond, float]:
    """What small motions, as believed, leave of a machine with nothing missing, and what a fit leaves beside that."""
    model = _model(campaign, plain)
    made = hypothesis(model.believed, [])
    beyond: dict[str, Bent] = {}
    for trial in model.trials:
        initial = np.array([n.guess for n in model.nuisances(trial)])
        seen = model.predict(model.trial_mechanism(made, made.start(), trial), trial, initial)
        shown = {
            channel: (block.time, (read - said)[None, :])
            for block, values in zip(trial.blocks, seen.blocks, strict=True)
            for channel, read, said in zip(block.channels, block.value, values, strict=True)
        }
        beyond[trial.recorded] = Bent({}, initial, (), shown)
    return beyond, _refit(campaign, plain, beyond).cost


def reach(
    campaign: Campaign,
    kind: Kind,
    *,
    limits: float | None = None,
    variance_ratio: float | None = None,
    near: float = NEAR,
) -> tuple[Campaign, Strength]:
    """The campaign with the effect hidden at the size that makes it as strong as asked; as near as it comes.

    Args:
        campaign: with nothing missing.
        kind: the effect.
        limits: size in detection limits.
        variance_ratio: residual variance after refit over the noise variance, instead.
        near: factor within which it is reached.

    Raises:
        SimulationError: no size can be run.
    """
    if (limits is None) == (variance_ratio is None):
        raise InputError("a size is asked for either in detection limits or as a variance ratio")
    plain = nothing_missing(campaign)
    size, low, high = 1.0, 0.0, math.inf
    best: tuple[float, Campaign, Strength] | None = None
    for _ in range(ATTEMPTS):
        hidden = campaign.with_missing(*campaign.missing, kind.at(size))
        try:
            found = measure(hidden, plain)
        except (SimulationError, InputError):
            size, high = 0.5 * size, size
            continue
        if limits is not None:
            ratio = limits / max(found.limits, 0.02)
        else:
            assert variance_ratio is not None
            ratio = math.sqrt((variance_ratio - 1.0) / max(found.variance_ratio - 1.0, 1e-6))
        off = abs(math.log(ratio))
        if best is None or off < best[0]:
            best = off, hidden, found
        if off < math.log(near) or (ratio > 1.0 and size >= kind.largest):
            break
        low, high = (size, high) if ratio > 1.0 else (low, size)
        step = size * min(max(ratio, 0.05), 20.0)
        if not low < step < high:
            step = math.sqrt(max(low, 0.05 * high) * high) if math.isfinite(high) else 2.0 * size
        size = min(step, kind.largest)
    if best is None:
        raise SimulationError(f"no size of {kind.effect} could be run")
    return best[1], best[2]
