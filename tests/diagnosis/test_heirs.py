"""A law that could be a plainer one costs no more than that: where it does, it begins there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.heirs import heirs
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.decision import SLACK
from tests.diagnosis.rigs import write_study

RUB, EITHER = ("coulomb_friction", "wrist"), ("asymmetric_friction", "wrist")


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(write_study(tmp_path_factory.mktemp("heirs"), planted=[(*RUB, {"force_N": 0.3})]))


@pytest.fixture(scope="module")
def found(shop: Workshop) -> Found:
    base, rub = shop.run(Task((), {})), shop.run(Task((RUB,), {"coulomb_friction@wrist.force_N": 0.2}))
    assert base is not None
    assert rub is not None
    all_sites = Found(base, singles=tuple(shop.model.sites()))
    all_sites.keep(rub)
    return all_sites


def costly(found: Found, shop: Workshop, over: float) -> tuple[Found, Fit]:
    """The same beside a richer law that costs so much more than the plain one."""
    rub = found.fits[(RUB,)]
    either = shop.run(Task((EITHER,), {}, near=rub))
    assert either is not None
    other = Found(found.baseline, singles=found.singles)
    other.keep(rub)
    other.keep(replace(either, chi2=rub.cost + over - either.prior))
    return other, rub


def test_every_richer_law_ends_no_higher(shop: Workshop, found: Found) -> None:
    rub = found.fits[(RUB,)]
    tasks = heirs(found, [rub], shop.model.in_forms)
    assert {t.label for t in tasks} >= {(EITHER,), (("stribeck_friction", "wrist"),), (("dahl_friction", "wrist"),)}
    for task in tasks:
        if task.label[0][0] in (EITHER[0], "stribeck_friction"):  # the others are it only in the limit
            fit = shop.run(task)
            assert fit is not None
            assert fit.cost < rub.cost + SLACK


def test_what_costs_less_already_is_not_begun_again(shop: Workshop, found: Found) -> None:
    trapped, rub = costly(found, shop, 50.0)
    assert (EITHER,) in {t.label for t in heirs(trapped, [rub], shop.model.in_forms)}
    better, rub = costly(found, shop, -1.0)
    assert (EITHER,) not in {t.label for t in heirs(better, [rub], shop.model.in_forms)}


def test_a_plain_law_that_explains_nothing_has_no_heirs(shop: Workshop, found: Found) -> None:
    idle = replace(found.fits[(RUB,)], chi2=found.baseline.chi2 - 1.0, prior=found.baseline.prior)
    assert heirs(found, [idle], shop.model.in_forms) == []
