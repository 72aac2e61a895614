"""Which further fits a search begins where single effects, screened while they are faint, do not explain the data."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import pairs
from spacerobot.diagnosis.selection import search as whole
from spacerobot.diagnosis.selection.search_state import Found, noise_of, run_tasks
from tests.diagnosis.rigs import write_study

DRAG, RUB = ("viscous_drag", "target"), ("coulomb_friction", "target")
EITHER, WRIST = ("asymmetric_friction", "wrist"), ("coulomb_friction", "wrist")
FORCE = "coulomb_friction@target.force_N"


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    planted = [(*WRIST, {"force_N": 0.3}), (*RUB, {"force_N": 0.05})]
    return Workshop(write_study(tmp_path_factory.mktemp("pairs"), planted=planted))


@pytest.fixture(scope="module")
def found(shop: Workshop) -> Found:
    base = shop.run(Task((), {}))
    assert base is not None
    out = Found(base)
    for one in (DRAG, RUB, EITHER, WRIST):
        out.keep(shop.run(Task((one,), {}, near=base)))
    assert len(out.fits) == 4
    return out


def test_the_best_singles_are_paired_by_what_each_was_fitted_to(found: Found) -> None:
    tasks = pairs._of_singles(found)
    labels = [t.label for t in tasks]
    assert tuple(sorted((RUB, WRIST))) in labels
    assert tuple(sorted((EITHER, WRIST))) not in labels  # the one holds the other
    assert len(set(labels)) == len(labels)
    for task in tasks:
        assert task.near is not None
        (first,) = task.near.hypothesis.label
        (other,) = set(task.label) - {first}
        alone = found.fits[(other,)]
        assert task.near.cost <= alone.cost
        assert task.start == {k: v for k, v in alone.values().items() if "@" in k}
    costs = [t.near.cost for t in tasks if t.near is not None]
    assert costs == sorted(costs)


def test_such_a_pair_is_the_truth(shop: Workshop, found: Found) -> None:
    (task,) = [t for t in pairs._of_singles(found) if t.label == tuple(sorted((RUB, WRIST)))]
    fit = shop.run(task)
    assert fit is not None
    assert found.explains(fit)
    assert fit.values()[FORCE] == pytest.approx(0.05, rel=0.1)


def test_the_best_singles_move_on_along_their_strengths(shop: Workshop, found: Found) -> None:
    alone = found.fits[(RUB,)]
    z = alone.z.copy()
    index = alone.hypothesis.keys.index(FORCE)
    z[index] = alone.hypothesis.free[index].z(3.0 * alone.values()[FORCE])
    far = Found(found.baseline)
    far.keep(replace(alone, chi2=alone.chi2 + 40.0, z=z))
    (task,) = whole._resized(far)
    fit = shop.run(task)
    assert fit is not None
    assert fit.cost < alone.cost + 0.5
    assert fit.values()[FORCE] == pytest.approx(alone.values()[FORCE], rel=0.1)


def test_full_size_is_fitted_only_where_it_promises_more_than_was_found(shop: Workshop, found: Found) -> None:
    pool = Pool(shop, 1)
    sites = [s for fit in found.fits.values() for s in fit.hypothesis.sites]
    fresh = Found(found.baseline)
    asked = pairs.at_full_size(pool, fresh, found.baseline, sites, lambda *a: None)
    assert {t.label for t in asked} >= {(RUB,), (WRIST,)}
    assert pairs.at_full_size(pool, found, found.baseline, sites, lambda *a: None) == []


def test_a_low_cost_that_is_no_noise_explains_nothing(shop: Workshop, found: Found) -> None:
    fit = shop.run(Task(tuple(sorted((RUB, WRIST))), {}, near=found.fits[(WRIST,)]))
    assert fit is not None
    assert isinstance(shop.left_by(fit), Left)
    seen: list[Fit] = []

    def never(fit: Fit) -> bool:
        seen.append(fit)
        return False

    assert Found(found.baseline, noise=lambda fit: True).explains(fit)
    assert not Found(found.baseline, noise=never).explains(fit)
    assert seen == [fit]
    assert not Found(found.baseline, noise=never).explains(found.baseline)
    assert seen == [fit]  # one of high cost is not asked about


def test_a_search_asks_whether_what_is_left_is_noise(shop: Workshop) -> None:
    asks = noise_of(shop)
    fit = shop.run(Task((), {}))
    assert fit is not None
    assert asks(fit) is shop.left_by(fit).adequate is False  # two effects are missing


def test_laws_of_one_thing_fill_one_place(found: Found) -> None:
    first = [f.hypothesis.label for f in found.one_of_each()]
    assert (WRIST,) in first
    assert (EITHER,) not in first


@pytest.mark.slow
def test_a_set_at_the_wrong_moment_is_found_at_the_right_one(tmp_path: Path) -> None:
    """In one trial it strikes before the touch, in another after it: everything that follows is another."""
    gap, knock, key = ("backlash", "wrist"), ("external_impulse", "target"), "external_impulse@target.time_s"
    planted = [(*gap, {"half_gap_m": 1.5e-4}), (*knock, {"impulse_Ns": 0.08, "time_s": 0.25})]
    workshop = Workshop(write_study(tmp_path, planted=planted))
    start = {"backlash@wrist.half_gap_m": 1.5e-4, "external_impulse@target.impulse_Ns": -0.03, key: 0.9}
    base, wrong = workshop.run(Task((), {})), workshop.run(Task((gap, knock), start))
    assert base is not None
    assert wrong is not None
    assert abs(wrong.values()[key] - 0.25) > 0.1
    with Pool(workshop, 1) as pool:
        found = Found(base, {wrong.hypothesis.label: wrong})
        run_tasks(pool, found, pairs._other_moments(pool, found), lambda *_: None, "at other moments")
    assert found.best.cost < wrong.cost - 100.0
    assert found.best.values()[key] == pytest.approx(0.25, abs=0.02)
