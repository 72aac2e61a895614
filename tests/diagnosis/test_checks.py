"""Every check of the product's own can fail, and a failed check takes the verdict's word back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from spacerobot.diagnosis import checks, confirm
from spacerobot.diagnosis.adequacy import Left
from spacerobot.diagnosis.candidates import contains, simpler
from spacerobot.diagnosis.fit import Fit
from spacerobot.diagnosis.judge import NAMED, NOT_TRUSTED, judge
from spacerobot.diagnosis.pool import Task, Workshop
from spacerobot.diagnosis.search import Found
from tests.diagnosis.rigs import write_study

LABEL = (("coulomb_friction", "wrist"),)


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("checks")
    return Workshop(write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.35})]))


@pytest.fixture(scope="module")
def base(shop: Workshop) -> Fit:
    fit = shop.run(Task((), {}))
    assert fit is not None
    return fit


@pytest.fixture(scope="module")
def chosen(shop: Workshop) -> Fit:
    fit = shop.run(Task(LABEL, {"coulomb_friction@wrist.force_N": 0.3}))
    assert fit is not None
    return fit


def found(base: Fit, chosen: Fit) -> Found:
    out = Found(base)
    out.keep(chosen)
    return out


def test_a_sound_fit_passes_all(shop: Workshop, base: Fit, chosen: Fit) -> None:
    assert checks.nested(found(base, chosen), chosen)["passed"]
    assert checks.synthetic(shop, chosen, 0)["passed"]
    assert confirm.confirm(shop, chosen)["passed"]


def test_a_smaller_model_that_costs_less_is_noticed(base: Fit, chosen: Fit) -> None:
    cheap = replace(base, chi2=chosen.chi2 - 50.0, prior=0.0)
    assert not checks.nested(found(cheap, chosen), chosen)["passed"]


def test_an_optimiser_that_stops_short_of_the_truth_is_noticed(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = Workshop.run

    def lazy(self: Workshop, task: Task) -> Fit | None:
        fit = run(self, replace(task, max_iterations=1))
        return None if fit is None else replace(fit, chi2=fit.chi2 + 100.0)

    monkeypatch.setattr(Workshop, "run", lazy)
    assert not checks.synthetic(shop, chosen, 0)["passed"]


def test_a_reduced_model_that_is_too_poor_is_noticed(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = confirm.scene_of

    def stiffer(*args: Any) -> Any:
        scene = whole(*args)
        return replace(scene, wrist=replace(scene.wrist, stiffness=1.05 * scene.wrist.stiffness))

    monkeypatch.setattr(confirm, "scene_of", stiffer)
    assert not confirm.confirm(shop, chosen)["passed"]


def test_a_failed_check_takes_the_name_back(base: Fit, chosen: Fit) -> None:
    fits = found(base, chosen)
    fine = Left((), 1.0)
    left = {id(base): fine, id(chosen): fine}
    assert judge(fits, left, None, ()).verdict == NAMED
    assert judge(fits, left, None, ["cost at truth"]).verdict == NOT_TRUSTED


def test_simpler_sets_are_contained_in_what_they_came_from() -> None:
    label = (("quadratic_drag", "target"), ("stribeck_friction", "wrist"))
    less = simpler(label)
    assert (("coulomb_friction", "wrist"), ("quadratic_drag", "target")) in less
    assert all(contains(label, one) for one in less)
    assert simpler((("coulomb_friction", "wrist"),)) == []
