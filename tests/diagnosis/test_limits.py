"""Detection limits are those of the decision itself: its own constants, at full size, beside its rivals."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.stats import ncx2, norm

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.starts import effect_starts
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.limits import BESIDE, Column, Limit, Limits, _away, must_earn, must_lead
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.diagnosis.terms.decision import EARN, MARGIN, PENALTY
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site, hypothesis
from spacerobot.effects.registry import effect
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
        site = Task((label,), {key: share * limit}).sites(model)
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
    assert drag.instead[0] == ("coulomb_friction", "target")
    assert np.float64(drag.smallest) > 1.1 * np.float64(alone["viscous_drag", "target"])


@given(st.lists(st.booleans(), min_size=1, max_size=40))
def test_what_a_limit_rests_on_lies_away_from_what_is_masked(keep: list[bool]) -> None:
    mask = np.array(keep)
    counts = _away(mask)
    for i, one in enumerate(counts):
        near = mask[max(i - BESIDE, 0) : i + BESIDE + 1]
        assert one == near.all()


BELIEVED = Believed({"wrist.stiffness": 1000.0}, {"wrist.stiffness": 0.01}, {}, ("all",))


def fit_of(made: Hypothesis) -> Fit:
    return Fit(made, np.zeros(len(made.free)), {}, 100.0, 0.0, 100, None, True, 1)


@pytest.mark.parametrize("trials", [(), ("01",)])
@pytest.mark.parametrize("name", ["coulomb_friction", "asymmetric_friction"])
def test_an_effect_has_the_price_that_the_judge_asks(name: str, trials: tuple[str, ...]) -> None:
    site = Site(effect(name), "wrist", trials)
    whole, base = (fit_of(hypothesis(BELIEVED, sites)) for sites in ([site], []))
    assert Column(site, {}, 1.0, np.ones(1), 1.0).price == score(whole) - score(base)


class Straight(Limits):
    """Limits where effects do to the recordings what is written here, in proportion to their size."""

    def __init__(self, done: dict[tuple[str, str], np.ndarray]) -> None:
        self.fit, self.inflation, self.done = fit_of(hypothesis(BELIEVED, [])), 1.0, done
        self.project = self  # type: ignore[assignment]
        self.out: tuple[str, ...] = ()

    def free(self, change: np.ndarray, z: np.ndarray) -> np.ndarray:
        return change

    def shift(self, change: np.ndarray) -> np.ndarray:
        return np.array([9.0 if f.key in self.out else 0.0 for f in self.fit.hypothesis.free])

    def _change(self, site: Site, values: object) -> np.ndarray:
        (parameter,) = site.effect.parameters
        return self.done[site.label] * values[site.key(parameter.name)]  # type: ignore[index]

    def smallest(self, label: tuple[str, str]) -> float:
        columns = []
        for (name, where), done in self.done.items():
            site = Site(effect(name), where)
            start = effect_starts([site])[0]
            column = done * start[site.key(site.effect.parameters[0].name)]
            columns.append(Column(site, start, 1.0, column, float(column @ column)))
        units = np.array([c.column / np.linalg.norm(c.column) for c in columns])
        item = next(c for c in columns if c.site.label == label)
        found = self._limit(item, columns, units).smallest
        assert found is not None
        return found


ONE, DRAG, BIAS = ("coulomb_friction", "wrist"), ("viscous_drag", "target"), ("bias", "mocap")
ONE_TARGET = ("coulomb_friction", "target")


@given(st.floats(0.2, 0.7))
def test_a_rival_imitates_with_the_signs_that_it_may_have(angle: float) -> None:
    """Drag takes energy and cannot bring any; a bias may lie on either side."""
    assert effect("bias").two_sided
    assert not effect("viscous_drag").two_sided
    own = np.array([30.0, 0.0])
    beside = 30.0 * np.array([math.cos(angle), math.sin(angle)])
    alone = Straight({ONE: own}).smallest(ONE)
    for rival, either in ((DRAG, False), (BIAS, True)):
        toward, against = (Straight({ONE: own, rival: sign * beside}).smallest(ONE) for sign in (1.0, -1.0))
        assert toward > 1.05 * alone
        assert against == pytest.approx(toward if either else alone, rel=0.07)


@given(st.floats(0.2, 1.2), st.floats(0.2, 1.2), st.floats(0.2, 1.2))
def test_two_together_imitate_what_neither_does_alone(a: float, b: float, c: float) -> None:
    """A limit asks for what the nearest point of the cone that two rivals span leaves over, their price counted."""
    own = 30.0 * np.array([1.0, 0.0, math.tan(0.2 * c)])
    first = 30.0 * np.array([math.cos(a), math.sin(a), 0.0])
    second = 30.0 * np.array([math.cos(b), -math.sin(b), 0.0])
    alone, beside = (Straight({ONE: own, **rivals}) for rivals in ({DRAG: first}, {DRAG: first, ONE_TARGET: second}))
    cone = np.stack([first, second], axis=1)
    _, left = nnls(cone, own)
    pair = math.sqrt(must_lead(PENALTY - 2.0 * PENALTY)) / left
    wanted = max(alone.smallest(ONE), Straight({ONE: own, ONE_TARGET: second}).smallest(ONE), pair)
    assert beside.smallest(ONE) == pytest.approx(wanted, rel=0.07)


def test_beside_wrong_values_an_effect_pays_less_by_what_these_cost() -> None:
    """The judge's own count: the effect's parameters against the values that are given up."""
    limits = Straight({ONE: np.array([1.0])})
    limits.out = ("wrist.stiffness",)
    limits._loose = {limits.out: limits}  # type: ignore[dict-item]
    whole = fit_of(hypothesis(BELIEVED, [Site(effect(ONE[0]), ONE[1])]))
    freed = fit_of(hypothesis(BELIEVED.free_of(limits.out), []))
    asked = must_earn(score(whole) - score(freed), True)
    found = limits._wrong_instead(np.array([3.0]), PENALTY)
    assert found == pytest.approx(3.0 / math.sqrt(asked))
