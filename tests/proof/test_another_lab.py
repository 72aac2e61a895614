"""Rigs of other labs: unlike the air bed's, and their recordings those of the rig that was built."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import fit_from
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.proof.air_bed import MASSES, SPRINGS
from spacerobot.proof.campaign import Campaign, noisy, perform, write_study
from spacerobot.proof.labs.orders import FAMILY
from spacerobot.proof.scenes import hideable, scene
from spacerobot.recordings.study import load_study

pytest.importorskip("mujoco")


def drawn(seed: int) -> Campaign:
    return scene(FAMILY, np.random.default_rng(seed))


def test_no_lab_has_the_air_beds_rig_and_nothing_is_hidden_at_an_instrument_that_is_not_there() -> None:
    some = [drawn(seed) for seed in range(40)]
    springs = [c.belief.values["wrist.stiffness"] for c in some]
    assert len(set(springs)) > 35
    assert not set(springs) & set(SPRINGS)
    assert not {t.overrides["target.mass"] for c in some for t in c.trials} & set(MASSES)
    assert len({tuple(c.belief.head["approach"]) for c in some}) == 4
    for campaign in some:
        there = {s.sensor for s in campaign.streams}
        assert {where for _, where in hideable(campaign) if where in ("force_sensor", "mocap")} == there
    assert {len(c.streams) for c in some} == {1, 2}


@pytest.mark.parametrize("seed", [1, 2, 5, 34])
def test_nothing_missing_leaves_the_noise_that_was_drawn(tmp_path: Path, seed: int) -> None:
    """In every direction, with noise stated or not: what a fit leaves is what the instruments were given."""
    campaign = drawn(seed)
    write_study(tmp_path, campaign, noisy(campaign, perform(campaign)))
    study = load_study(tmp_path)
    trials = trial_data(study)
    model = RigModel(study, trials)
    fit = fit_from(Fitter(model, trials), model.believed, (), {})
    sigma = {c.name: c.sigma for s in campaign.streams for c in s.channels}
    for trial in trials:
        row, left = 0, fit.trials[trial.id].residual
        for block in trial.blocks:
            for c, name in enumerate(block.channels):
                good = block.weight[c] > 0.0
                rms = np.sqrt(np.mean((left[row : row + good.size][good] / block.weight[c][good]) ** 2))
                row += good.size
                assert abs(rms / sigma[name] - 1.0) < 6.0 / np.sqrt(2.0 * good.sum()) + 0.02, (name, trial.id)
    built = campaign.as_built["wrist.stiffness"]
    assert fit.values()["wrist.stiffness"] == pytest.approx(built, rel=0.01)
