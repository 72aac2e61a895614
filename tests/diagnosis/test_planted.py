"""Every effect that is planted in a rig, a newcomer's too, is found again by the fit that supposes it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.screen import faint
from spacerobot.diagnosis.fitting.starts import effect_starts, informed_starts
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.diagnosis.terms.decision import MISSED, SLACK
from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.effect import Parameter
from spacerobot.simulation.rig import rig

from .rigs import BELIEVED, write_study

LOUD = (150.0, 3000.0)
"""Chi-squared that the planted effect costs the baseline: it shows, and is no other machine."""

CLOSER, FURTHER, TRIED = 0.4, 2.1, 12
"""Factors by which a planted size comes nearer to what is loud enough, and how often it may."""

QUIET = 1.1
"""Chi-squared a reading that noise alone leaves, at most."""

LEAST = 1e-3
"""Of a standard error, in units of the parameter's scale, so that a bound that is met is no miss."""

REACHED = 0.004
"""Displacement [m] that every trial passes: what acts from one on must be reached."""


QUICK = (
    "coulomb_friction",
    "cubic_stiffness",
    "hertz_contact",
    "arm_compliance",
    "time_offset",
    "table_tilt",
    "preload",
)
"""One or two of a kind; all others are among the long tests."""


def candidates() -> list[Site]:
    """What a search along the approach would propose."""
    return candidate_sites(rig({}), Believed(BELIEVED, dict.fromkeys([*BELIEVED, "target.mass"], 0.01), {}, ("all",)))


def sized(parameter: Parameter, size: float) -> float:
    """Of a strength: so many times its start, from where it does nothing."""
    if parameter.reach:
        return REACHED
    start = parameter.starts[0]
    if parameter.shape:
        return start
    if math.isinf(parameter.null):
        return start / size
    return min(max(parameter.null + size * (start - parameter.null), parameter.lower), parameter.upper)


BESIDE = 9.0
"""What a reading beside a touch may cost that one of two fits leaves out: three of its sigmas."""


def planted(site: Site, size: float, folder: Path) -> tuple[Workshop, dict[str, float]]:
    numbers = {p.name: sized(p, size) for p in site.effect.parameters}
    where = folder / f"{size:.6g}"
    where.mkdir()
    study = write_study(where, planted=[(*site.label, numbers)], masses=(9.0,), speeds=(0.08, 0.11))
    return Workshop(study), {site.key(k): v for k, v in numbers.items()}


def best(shop: Workshop, site: Site, starts: Sequence[Mapping[str, float]]) -> Fit:
    fits = [shop.run(Task((site.label,), start)) for start in starts]
    return min((f for f in fits if f is not None), key=lambda f: f.cost)


def loud(site: Site, folder: Path) -> tuple[Workshop, Fit, dict[str, float]]:
    """A rig with enough of the effect in it, the fit that begins at the truth, and the truth."""
    size = 1.0
    for _ in range(TRIED):
        shop, truth = planted(site, size, folder)
        base, known = shop.run(Task((), {})), best(shop, site, [truth])
        assert base is not None
        gain = base.cost - known.cost
        if LOUD[0] <= gain <= LOUD[1]:
            return shop, known, truth
        size *= CLOSER if gain > LOUD[1] else FURTHER
    pytest.fail(f"{site.label} shows at no size")


@pytest.mark.parametrize(
    "site",
    [
        pytest.param(s, id="-".join(s.label), marks=[] if s.effect.name in QUICK else [pytest.mark.slow])
        for s in candidates()
    ],
)
def test_what_is_planted_is_found_again(site: Site, tmp_path: Path) -> None:
    """From the starts of a search, to the end: as good a fit as from the truth, and sizes that hold it.

    Of a law that comes to what it refines in a limit, the numbers that go there may not show: how far it has come is
    then any of a wide range, and no error by the slope.
    """
    shop, known, truth = loud(site, tmp_path)
    starts = [*effect_starts([site]), *informed_starts(site, shop.trials)]
    base = shop.run(Task((), {}))
    near = [shop.run(Task((site.label,), faint(site, start), near=base)) for start in starts]
    found = min([best(shop, site, starts), *(f for f in near if f is not None)], key=lambda f: f.cost)
    if not found.converged:
        on = shop.run(Task((site.label,), {}, near=found, max_iterations=40, patient=True))
        found = found if on is None else on
    assert found.cost < known.cost + SLACK + BESIDE * abs(found.samples - known.samples)
    assert found.chi2 < QUIET * found.samples
    assert found.covariance is not None
    hidden = {site.key(name) for name in site.effect.limits}
    assert not [key for key in _misses(found, truth) if key not in hidden]


def _misses(fit: Fit, truth: Mapping[str, float]) -> list[str]:
    """Effects' numbers that are too many of their errors from the truth."""
    assert fit.covariance is not None
    errors = np.sqrt(np.diag(fit.covariance))
    return [
        free.key
        for free, z, error in zip(fit.hypothesis.free, fit.z, errors, strict=True)
        if free.kind == "effect" and abs(z - free.z(truth[free.key])) >= MISSED * max(error, LEAST)
    ]


def test_what_is_not_planted_does_not_fit(tmp_path: Path) -> None:
    sites = {s.label: s for s in candidates()}
    shop, known, _ = loud(sites["coulomb_friction", "wrist"], tmp_path)
    other = sites["hertz_contact", "contact"]
    assert best(shop, other, [*effect_starts([other])]).cost > known.cost + SLACK
