"""Where fits of a hypothesis begin, and the best of them: contact makes the cost jagged, so one start is not enough."""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.fitting.descent import BAD
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.valleys import FACTOR, deepest
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site, hypothesis
from spacerobot.diagnosis.terms.reach import reached_edge
from spacerobot.support.errors import SimulationError

MOMENTS = 24
"""Times at which a momentary effect is tried."""

EVERY = 2
"""Of these times, those at which a momentary effect is tried at full size."""

SIZES, SIZES_OF_LAWS = (0.4, 1.0, 2.5), (1.0,)
"""Multiples of the start values at which effects are tried at full size; of those that take a law's place."""

GOOD = 1.3
"""chi-squared per sample of the first guesses below which unstated values begin at their centres."""

REACH = 30.0
"""How far from its centre a scan goes either way, by the factor of the search for valleys: where a contact rings, that
of its damping is no wider than a quarter of it.
"""


def effect_starts(sites: Sequence[Site], known: Mapping[str, float] | None = None) -> list[dict[str, float]]:
    """Start values of the effects' parameters: the k-th of each together; keys in `known` keep their value."""
    known = known or {}
    count = max((len(p.starts) for s in sites for p in s.effect.parameters if s.key(p.name) not in known), default=1)
    out: list[dict[str, float]] = []
    for k in range(count):
        start = dict(known)
        for site in sites:
            for parameter in site.effect.parameters:
                key = site.key(parameter.name)
                if key not in known:
                    start[key] = parameter.starts[min(k, len(parameter.starts) - 1)]
        if start not in out:
            out.append(start)
    return out


def informed_starts(site: Site, trials: Sequence[TrialData]) -> list[dict[str, float]]:
    """Starts that the recordings suggest: where a place hardly exceeds a displacement, at the largest one seen."""
    reach = [p for p in site.effect.parameters if p.reach]
    seen = [x for trial in trials for x in _displacements(site.where, trial)] if reach else []
    edge = reached_edge(site.effect, np.concatenate([np.zeros(0), *seen]))
    if edge is None:
        return []
    usual = effect_starts([site])
    at = {site.key(p.name): edge for p in reach}
    return [{**usual[len(usual) // 2], **at}, {**usual[-1], **at}]


def sized(site: Site, start: Mapping[str, float], share: float) -> dict[str, float]:
    """A start with its strengths at a share of their size.

    A stiffness or cut-off that is null at infinity acts by its inverse.
    """
    out = dict(start)
    for p in site.effect.parameters:
        key = site.key(p.name)
        if math.isinf(p.null):
            out[key] = min(max(start[key] / abs(share), p.lower), p.upper)
        elif not (p.shape or p.log):
            out[key] = min(max(p.null + share * (start[key] - p.null), p.lower), p.upper)
    return out


def full_starts(site: Site, trials: Sequence[TrialData]) -> list[dict[str, float]]:
    """Every start of how strongly an effect acts, at several sizes, with every start of how it acts."""
    parameters = site.effect.parameters
    strong = [{k: s[k] for p in parameters if not p.shape for k in [site.key(p.name)]} for s in effect_starts([site])]
    places: list[dict[str, float]] = [
        {k: s[k] for p in parameters if p.shape for k in [site.key(p.name)]}
        for s in [*moments(site, trials)[::EVERY], *informed_starts(site, trials)]
    ]
    keys = [site.key(p.name) for p in parameters if p.shape]
    if not any(p.moment for p in parameters):
        places += [
            dict(zip(keys, s, strict=True)) for s in itertools.product(*(p.starts for p in parameters if p.shape))
        ]
    sizes = (*SIZES, *(-s for s in SIZES)) if site.effect.two_sided else SIZES
    out: list[dict[str, float]] = []
    for one in strong:
        for size in SIZES_OF_LAWS if site.effect.removes else sizes:
            for place in places:
                start = sized(site, {**one, **place}, size)
                if start not in out:
                    out.append(start)
    return out


def _displacements(where: str, trial: TrialData) -> Iterator[np.ndarray]:
    """What was recorded of a place's own displacement: of a slider, against the hand that carries it."""
    for channel in (f"{where}.x", f"{where}.position"):
        if channel not in trial.channels:
            continue
        time, value, weight = trial.channel(channel)
        good = weight > 0.0
        if where == "wrist" and "hand.x" in trial.channels:
            when, hand, known = trial.channel("hand.x")
            if (known > 0.0).any():
                value = value - np.interp(time, when[known > 0.0], hand[known > 0.0])
        yield value[good]


def moments(site: Site, trials: Sequence[TrialData]) -> list[dict[str, float]]:
    """Starts of what happens at a moment, at times spread over the trials."""
    sought = [site.key(p.name) for p in site.effect.parameters if p.moment]
    if not sought or not trials:
        return []
    times = np.linspace(min(t.start for t in trials), max(t.end for t in trials), MOMENTS + 2)[1:-1]
    usual = effect_starts([site])[0]
    return [{**usual, **dict.fromkeys(sought, float(time))} for time in times]


def fit_from(
    fitter: Fitter,
    believed: Believed,
    sites: Sequence[Site],
    start: Mapping[str, float],
    initials: Mapping[str, np.ndarray] | None = None,
    max_iterations: int = 40,
    hopeless: float = np.inf,
) -> Fit:
    """Fit from one start; from where it ends on to lower valleys along what the study does not state.

    Where it ends badly, first once more with what is not stated back at its centres.

    Args:
        fitter: of the model.
        believed: what the study says.
        sites: the effects.
        start: start values by key; believed values where absent, absorbing constants that are replaced at zero.
        initials: start of the trials' initial values.
        max_iterations: of each fit.
        hopeless: cost above which a fit that hardly falls any more is given up.

    Raises:
        SimulationError: the start cannot be simulated.
    """
    made = hypothesis(believed, sites, start)
    replaced = {name for s in sites for name in s.effect.replaced(s.where)}
    warm = {f.key: 0.0 for f in made.free if f.kind == "absorbing" and f.key in replaced}
    warm.update({k: v for k, v in unstated(fitter, believed).items() if k in made.keys})
    warm.update({k: v for k, v in start.items() if k in made.keys})
    fit = fitter.fit(made, warm=warm, initials=initials, max_iterations=max_iterations, hopeless=hopeless)
    if fit.cost > hopeless or not believed.unknown:
        return fit
    if _bad(fit):
        warm = {k: v for k, v in fit.values().items() if k not in believed.unknown and not _contact(k)}
        with contextlib.suppress(SimulationError):
            own = fit.initials()
            fit = best(
                [fit, fitter.fit(made, warm=warm, initials=own, max_iterations=max_iterations, hopeless=hopeless)]
            )
    if _bad(fit):  # another valley would only make up for what is missing
        return fit
    return deepest(fitter, fit, believed.unknown, max_iterations=max_iterations, hopeless=hopeless)


def _bad(fit: Fit) -> bool:
    return fit.chi2 > (1.0 + BAD) * fit.samples


def _contact(key: str) -> bool:
    return "contact." in key


def unstated(fitter: Fitter, believed: Believed) -> Mapping[str, float]:
    """Where fits begin with what the study does not state: where a scan of it misfits least, all else as believed.

    Each value in turn, by the robust loss, for the trials' starts are first guesses; found once for all fits of a
    fitter. Centres serve where they fit already, or where nothing can be simulated.
    """
    if fitter.unstated is None:
        fitter.unstated = {}
        made, own = hypothesis(believed, []), fitter.guess()
        far = round(math.log(REACH) / math.log(FACTOR))
        state = fitter.state(made, made.start(), own)
        if state is None or state.chi2() < GOOD * state.samples:
            return fitter.unstated
        for name, centre in believed.unknown.items():
            losses = {}
            for value in (centre * FACTOR**k for k in range(-far, far + 1)):
                seen = fitter.state(made, made.start({**fitter.unstated, name: value}), own)
                if seen is not None:
                    losses[value] = seen.loss(fitter.trials, True)
            if losses:
                fitter.unstated[name] = min(losses, key=losses.__getitem__)
    return fitter.unstated


def fit_near(
    fitter: Fitter,
    believed: Believed,
    sites: Sequence[Site],
    near: Fit,
    start: Mapping[str, float],
    max_iterations: int = 8,
    hopeless: float = np.inf,
    loose: bool = False,
    eager: bool = False,
) -> Fit:
    """Fit that begins at another fit, with the new effects' strengths small: what the effect adds, and no more.

    Values that the study leaves open begin where `start` has them, if it does.
    """
    made = hypothesis(believed, sites, start)
    opened = {k: v for k, v in start.items() if k in believed.unknown}
    warm = {**start, **near.values(), **opened}
    return fitter.fit(
        made,
        warm=warm,
        initials=near.initials(),
        max_iterations=max_iterations,
        hopeless=hopeless,
        robust=False,
        rows=None if opened else known_rows(fitter, made, near),
        loose=loose,
        eager=eager,
    )


def known_rows(fitter: Fitter, made: Hypothesis, near: Fit) -> dict[str, np.ndarray] | None:
    """Derivatives at a fit as columns of a further hypothesis; None where that moves what the fit stands on."""
    keys = near.hypothesis.keys
    old = [f.key for f in made.free if f.kind != "effect" or f.key in keys]
    if made.removed != near.hypothesis.removed or not set(old) <= set(keys):
        return None
    source = [keys.index(k) for k in old]
    target = [made.keys.index(k) for k in old]
    # a value that is set free is counted in larger steps
    steps = [made.free[to].step / near.hypothesis.free[of].step for to, of in zip(target, source, strict=True)]
    out = {}
    for name, rows in fitter.rows_at(near).items():
        own = rows.shape[1] - len(keys)
        wide = np.zeros((rows.shape[0], len(made.free) + own), order="F")
        for to, of, step in zip(target, source, steps, strict=True):
            wide[:, to] = step * rows[:, of]
        wide[:, len(made.free) :] = rows[:, len(keys) :]
        out[name] = wide
    return out


def best(fits: Sequence[Fit]) -> Fit:
    """The fit of least cost."""
    return min(fits, key=lambda f: f.cost)


def label_of(made: Hypothesis) -> str:
    """A hypothesis in words, for progress and logs."""
    return " + ".join(f"{e} at {w}" for e, w in made.label) or "baseline"
