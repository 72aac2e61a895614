"""Detection limits are those of the decision itself: its own constants, at full size, beside its rivals."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import ncx2, norm

from spacerobot.diagnosis.candidates import candidate_sites
from spacerobot.diagnosis.hypothesis import Site, hypothesis
from spacerobot.diagnosis.judge import EARN
from spacerobot.diagnosis.limits import Limit, Limits, must_earn, must_lead
from spacerobot.diagnosis.weigh import MARGIN, PENALTY
from spacerobot.diagnosis.workshop import Task, Workshop
from tests.diagnosis.rigs import write_study

TELLING = (("coulomb_friction", "wrist"), ("coulomb_friction", "target"), ("viscous_drag", "target"))


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("limits")
    return Workshop(write_study(folder, seed=5))


def sites_of(shop: Workshop) -> list[Site]:
    mechanism = shop.model.mechanism({**shop.model.base, **shop.trials[0].overrides})
    return [s for s in candidate_sites(mechanism, shop.model.believed) if s.label in TELLING]


def limits(shop: Workshop, sites: list[Site], inflation: float = 1.0) -> dict[tuple[str, str], Limit]:
    base = shop.run(Task((), {}))
    assert base is not None
    found = Limits(shop.fitter(), shop.model.believed, base, inflation).of(sites)
    return {limit.site.label: limit for limit in found}


@given(st.integers(1, 4), st.booleans())
def test_what_must_be_earned_is_earned_in_97_of_100(count: int, first: bool) -> None:
    """Noncentral chi-squared of one degree of freedom, of scipy, against the judge's own bar."""
    bar = (EARN if first else MARGIN) + PENALTY * count
    assert ncx2.sf(bar, 1, must_earn(PENALTY * count, first)) == pytest.approx(0.975, abs=1e-3)


@given(st.floats(-9.0, 40.0))
def test_a_rival_stays_behind_in_97_of_100(dearer: float) -> None:
    mu = must_lead(dearer)
    assert norm.sf((MARGIN + dearer - mu) / (2.0 * math.sqrt(mu))) == pytest.approx(0.975, abs=1e-3)


def test_a_limit_is_where_the_decision_turns(shop: Workshop) -> None:
    """At its limit an effect earns what it must in data without noise; at half of it not."""
    alone = {s.label: s for s in sites_of(shop)}
    label = ("coulomb_friction", "wrist")
    limit = limits(shop, [alone[label]])[label].smallest
    assert limit is not None
    base = shop.run(Task((), {}))
    assert base is not None
    model = shop.model
    key = alone[label].key("force_N")
    earned = {}
    for share in (0.5, 1.0, 2.0):
        site = Task((label,), {key: share * limit}).sites()
        made = hypothesis(model.believed, site, {key: share * limit})
        values = {**base.values(), key: share * limit}
        trials = []
        for trial in shop.trials:
            mechanism = model.trial_mechanism(made, made.start(values), trial)
            shown = model.predict(mechanism, trial, base.trials[trial.id].initial)
            blocks = zip(trial.blocks, shown.blocks, strict=True)
            trials.append(replace(trial, blocks=tuple(replace(b, value=v) for b, v in blocks)))
        clean = Workshop(shop.study)
        clean.trials = tuple(trials)
        clean.model = clean.make_model(shop.study, clean.trials)
        fit = clean.run(Task((), {}))
        assert fit is not None
        earned[share] = fit.cost
    asked = must_earn(PENALTY, True)
    assert 0.7 * asked < earned[1.0] < 2.0 * asked
    assert earned[0.5] < asked < earned[2.0]


def test_more_noise_and_a_rival_ask_for_more(shop: Workshop) -> None:
    sites = sites_of(shop)
    alone = {s.label: limits(shop, [s])[s.label].smallest for s in sites}
    loud = {s.label: limits(shop, [s], 4.0)[s.label].smallest for s in sites}
    beside = limits(shop, sites)
    for label in TELLING:
        assert loud[label] == pytest.approx(2.0 * np.float64(alone[label]), rel=0.25)
        assert np.float64(beside[label].smallest) > 0.93 * np.float64(alone[label])
    drag = beside["viscous_drag", "target"]
    assert drag.instead == ("coulomb_friction", "target")
    assert np.float64(drag.smallest) > 1.1 * np.float64(alone["viscous_drag", "target"])
