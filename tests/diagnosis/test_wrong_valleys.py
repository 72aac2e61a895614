"""Fits that contacts, many readings and unstated values would trap: where they end, whatever they began at."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.starts import unstated
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.rebase import rebased
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.recordings.study import load_study
from tests.diagnosis.rigs import BELIEVED, write_study

RINGING = {"contact.stiffness": 250_000.0, "wrist.mass": 0.5, "contact.damping": 79.0}
"""A light slider behind a hard tip: the contact rings, and its damping has a valley as narrow as it rings clearly."""


@pytest.fixture(scope="module")
def ringing(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    believed = {k: v for k, v in RINGING.items() if k in BELIEVED}
    study = write_study(tmp_path_factory.mktemp("ringing"), truth=RINGING, believed=believed)
    return Workshop(study)


def right(fit: Fit | None) -> Fit:
    assert fit is not None
    return fit


def test_an_unstated_value_begins_in_its_valley(ringing: Workshop) -> None:
    begun = unstated(ringing.fitter(), ringing.model.believed)
    assert begun["contact.damping"] == pytest.approx(79.0, rel=0.25)
    fit = right(ringing.run(Task((), {})))
    assert fit.chi2 / fit.samples == pytest.approx(1.0, abs=6.0 * np.sqrt(2.0 / fit.samples))
    assert fit.values()["contact.damping"] == pytest.approx(79.0, rel=0.05)


def test_a_baseline_in_another_minimum_is_fitted_again_from_where_a_set_stands(ringing: Workshop) -> None:
    best = right(ringing.run(Task((), {})))
    trapped = replace(best, chi2=best.chi2 + 1000.0, z=best.z + 1.0)
    found = Found(trapped)
    found.keep(right(ringing.run(Task((("coulomb_friction", "wrist"),), {}, near=best))))
    with Pool(ringing, 1) as pool:
        fall = rebased(pool, found, lambda *_: None)
    assert found.baseline.cost < best.cost + 3.84
    assert fall == pytest.approx(trapped.cost - found.baseline.cost)


def test_a_baseline_that_is_at_its_best_stays(ringing: Workshop) -> None:
    found = Found(right(ringing.run(Task((), {}))))
    with Pool(ringing, 1) as pool:
        assert rebased(pool, found, lambda *_: None) == 0.0


def test_an_instrument_has_one_noise_in_all_trials(tmp_path: Path) -> None:
    """Each trial shows it by few readings; as many weights would call the luckiest trial unlike the others."""
    study = write_study(tmp_path, masses=(9.0, 23.2, 51.0), speeds=(0.06, 0.11))
    path = tmp_path / "study.toml"
    path.write_text(re.sub(r", sigma = [^ ]+ }", " }", path.read_text(encoding="utf-8")), encoding="utf-8")
    assert len(study.trials) == 6
    weights: dict[str, set[float]] = {}
    for trial in trial_data(load_study(tmp_path)):
        for block in trial.blocks:
            for channel, row in zip(block.channels, block.weight, strict=True):
                weights.setdefault(channel, set()).update(row[row > 0.0].tolist())
    assert {len(found) for found in weights.values()} == {1}
