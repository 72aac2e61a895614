"""Campaigns as a lab would hand them over."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import fit_from
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.proof.air_bed import air_bed
from spacerobot.proof.campaign import noisy, perform, seal, write_study
from spacerobot.proof.conceal import WRONG, conceal
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.sensors import Channel, Reading, Stream, spoil
from spacerobot.proof.orders import Order
from spacerobot.recordings.study import load_study

pytest.importorskip("mujoco")


def test_a_labelled_campaign_loads(tmp_path: Path) -> None:
    hidden = Missing("coulomb_friction", "wrist", {"force_N": 0.3})
    campaign = air_bed(np.random.default_rng(3), per_mass=1, spinning=True).with_missing(hidden)
    readings = noisy(campaign, perform(campaign))
    write_study(tmp_path / "open", campaign, readings)
    sealed = seal(campaign, {"kind": "unlabelled"})
    study = load_study(tmp_path / "open")
    assert len(study.trials) == 3
    assert len(study.conditions()) == 3
    assert set(study.channels()) == {"target.x", "wrist.x", "target.y", "target.yaw", "contact.force"}
    assert study.value("wrist.stiffness") == campaign.belief.values["wrist.stiffness"]
    assert study.sigma["target.yaw_inertia"] == 0.02
    for trial in study.trials:
        recording = study.recording(trial)
        for name, series in recording.items():
            reading = readings[trial.id]["force" if name == "contact.force" else "mocap"]
            kept = reading.value[name][~reading.lost]
            np.testing.assert_allclose(series.value[series.valid], kept[~np.isnan(kept)], atol=1e-9)
    truth = json.loads(sealed)
    assert truth["effects"] == [{"effect": "coulomb_friction", "where": "wrist", "force_N": 0.3}]
    text = (tmp_path / "open" / "study.toml").read_text()
    assert "coulomb" not in text
    assert "unlabelled" not in text
    assert not list((tmp_path / "open").glob("truth*"))


def test_the_same_seed_gives_the_same_campaign() -> None:
    first, second, other = (air_bed(np.random.default_rng(s), per_mass=1) for s in (5, 5, 6))
    assert repr(first) == repr(second)  # what is not stated is NaN, which equals nothing
    assert repr(first) != repr(other)
    readings = [noisy(c, perform(c)) for c in (first, second)]
    a, b = (r["01"]["force"].value["contact.force"] for r in readings)
    np.testing.assert_array_equal(a, b)


def test_a_belief_that_was_drawn_far_off_is_known_as_such() -> None:
    drawn = air_bed(np.random.default_rng(8), per_mass=1, spring=1020.0)
    near = replace(drawn, as_built={**drawn.as_built, **drawn.belief.values, "target.mass over believed": 1.0})
    assert near.unlucky() == ()
    far = {"wrist.mass": near.as_built["wrist.mass"] * (1.0 - 3.0 * near.belief.sigma["wrist.mass"])}
    over = {"target.mass over believed": 1.0 + 3.0 * near.belief.sigma["target.mass"]}
    assert set(replace(near, as_built={**near.as_built, **far, **over}).unlucky()) == {"wrist.mass", "target.mass"}


def test_nothing_missing_is_fitted_to_the_noise_and_no_more(tmp_path: Path) -> None:
    campaign = air_bed(np.random.default_rng(8), per_mass=2, spring=1020.0)
    write_study(tmp_path, campaign, noisy(campaign, perform(campaign)))
    fit = baseline(tmp_path)
    assert abs(fit.chi2 / fit.samples - 1.0) < 5.0 * np.sqrt(2.0 / fit.samples)
    found = fit.values()
    assert found["wrist.stiffness"] == pytest.approx(campaign.as_built["wrist.stiffness"], rel=4e-3)
    assert found["contact.damping"] == pytest.approx(60.0, rel=0.02)


def test_hidden_friction_shows_in_the_misfit(tmp_path: Path) -> None:
    hidden = Missing("coulomb_friction", "wrist", {"force_N": 0.4})
    campaign = air_bed(np.random.default_rng(8), per_mass=2, spring=1020.0).with_missing(hidden)
    write_study(tmp_path, campaign, noisy(campaign, perform(campaign)))
    assert baseline(tmp_path).chi2 > 1.2 * baseline(tmp_path).samples


def baseline(folder: Path) -> Fit:
    study = load_study(folder)
    trials = trial_data(study)
    model = RigModel(study, trials)
    return fit_from(Fitter(model, trials), model.believed, (), {})


def test_noise_is_as_stated() -> None:
    channel = Channel("target.x", 1.5e-4, 1e-5)
    stream = Stream("mocap", "mocap", 120.0, (channel,), coloured=0.3, memory=0.9, dropouts=0.5)
    time = np.arange(40_000) / 120.0
    clean = Reading(time, {"target.x": np.zeros(time.size)}, np.zeros(time.size, dtype=bool))
    made = spoil(clean, stream, np.random.default_rng(0))
    noise = made.value["target.x"]
    good = noise[~np.isnan(noise)]
    assert good.std() == pytest.approx(1.5e-4, rel=0.03)
    assert np.mean(good[1:] * good[:-1]) / good.var() == pytest.approx(0.27, abs=0.05)
    assert np.allclose(good / 1e-5, np.round(good / 1e-5))
    gaps = made.lost.sum() + np.isnan(noise).sum()
    assert gaps == pytest.approx(0.5 * time[-1] * 3.0, rel=0.25)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("time_offset", {"delay_s": 0.003}),
        ("low_pass", {"cutoff_Hz": 60.0}),
        ("scale", {"factor": 1.03}),
        ("bias", {"value": 0.2}),
        ("sensor_inertia", {"mass_kg": 0.1}),
    ],
)
def test_sensor_faults_are_those_of_the_catalogue(tmp_path: Path, name: str, values: dict[str, float]) -> None:
    """A fit with the catalogue's effect recovers what the generator's own sensor code did."""
    from spacerobot.diagnosis.terms.hypothesis import Site
    from spacerobot.effects.registry import effect

    fault = Missing(name, "force_sensor", values)
    campaign = air_bed(np.random.default_rng(4), per_mass=1, spring=1020.0).with_missing(fault)
    write_study(tmp_path, campaign, noisy(campaign, perform(campaign)))
    study = load_study(tmp_path)
    trials = trial_data(study)
    model = RigModel(study, trials)
    ((parameter, value),) = values.items()
    key = f"{name}@force_sensor.{parameter}"
    fit = fit_from(Fitter(model, trials), model.believed, (Site(effect(name), "force_sensor"),), {key: value})
    assert fit.chi2 / fit.samples < 1.05
    at = fit.hypothesis.keys.index(key)
    assert fit.covariance is not None
    error = np.sqrt(fit.covariance[at, at]) * fit.hypothesis.free[at].slope(fit.z[at])
    assert error < 0.1 * abs(value)
    assert abs(fit.values()[key] - value) < 4.0 * error


@pytest.mark.parametrize("name", ["target.mass", "wrist.stiffness"])
def test_the_seal_of_a_wrong_value_says_what_was_performed(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setattr("spacerobot.proof.conceal.WRONG", {name: WRONG[name]})
    made = conceal(Order("wrong_value", "rig", 0, seed=11))
    assert made.parameters == (name,)
    built, trials = made.campaign.as_built, made.campaign.trials
    if name == "target.mass":
        factors = [t.values.target_mass / t.overrides[name] for t in trials]
        np.testing.assert_allclose(factors, built["target.mass over believed"], rtol=1e-4)  # three decimals of a mass
        assert abs(built["target.mass over believed"] - 1.0) > 0.01
    else:
        spread = [t.values.wrist_stiffness / built[name] - 1.0 for t in trials]  # mounted anew for every mass
        assert np.max(np.abs(spread)) < 0.05
        assert abs(built[name] / made.campaign.belief.values[name] - 1.0) > 0.03
