"""Every way of spoiling does what its name says to what the lab holds, and leaves what happened as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from spacerobot.proof.campaign import Campaign, Readings, noisy, perform
from spacerobot.proof.conceal import RELATIVES, conceal
from spacerobot.proof.judge import judge
from spacerobot.proof.orders import Order
from spacerobot.proof.scenes import scene
from spacerobot.proof.spoiled import WAYS


@pytest.fixture(scope="module")
def campaign() -> tuple[Campaign, Readings]:
    made = scene("rig", np.random.default_rng(12))
    return made, perform(made)


def spoilt(campaign: tuple[Campaign, Readings], way: str) -> tuple[Campaign, Readings]:
    return WAYS[way].spoil(*campaign, np.random.default_rng(5))


def off(campaign: tuple[Campaign, Readings], readings: Readings, stream: str, channel: str) -> np.ndarray:
    """Readings over those of the plain noise, all trials."""
    plain = noisy(*campaign)
    return np.concatenate([readings[t][stream].value[channel] - plain[t][stream].value[channel] for t in plain])


def test_few_readings_are_far_off_and_the_others_as_they_were(campaign: tuple[Campaign, Readings]) -> None:
    one = off(campaign, spoilt(campaign, "one glitch")[1], "mocap", "target.x")
    assert np.flatnonzero(np.nan_to_num(one)).size == 1
    assert np.nanmax(np.abs(one)) == pytest.approx(5e-3, rel=1e-6)
    many = off(campaign, spoilt(campaign, "outliers")[1], "force", "contact.force")
    assert 0.002 < np.mean(np.nan_to_num(many) != 0.0) < 0.01
    cut = off(campaign, spoilt(campaign, "cut short")[1], "mocap", "wrist.x")
    assert np.flatnonzero(np.nan_to_num(cut)).size <= 1


def test_noise_is_as_wide_as_stated_with_heavy_tails_and_otherwise_where_sigmas_are_wrong(
    campaign: tuple[Campaign, Readings],
) -> None:
    made, clean = campaign
    _, heavy = spoilt(campaign, "heavy tails")
    sigma = {c.name: c.sigma for s in made.streams for c in s.channels}
    for channel in ("target.x", "wrist.x"):
        noise = np.concatenate([heavy[t]["mocap"].value[channel] - clean[t]["mocap"].value[channel] for t in clean])
        assert np.mean(np.abs(noise) > 5.0 * sigma[channel]) > 1e-4
    for way, factor in (("sigma halved", 0.5), ("sigma doubled", 2.0), ("sigma of another unit", 1000.0)):
        stated = {c.name: c.sigma for s in spoilt(campaign, way)[0].streams for c in s.channels}
        assert stated["target.x"] == pytest.approx(factor * sigma["target.x"])
        assert stated["contact.force"] == sigma["contact.force"]


def test_tracks_are_exchanged_smoothed_rounded_or_lost(campaign: tuple[Campaign, Readings]) -> None:
    plain = noisy(*campaign)
    swapped = spoilt(campaign, "swapped markers")[1]
    for trial, own in plain.items():
        here, there = (r["mocap"].value for r in (own, swapped[trial]))
        changed = np.nan_to_num(here["target.x"] - there["target.x"]) != 0.0
        np.testing.assert_array_equal(here["target.x"][changed], there["wrist.x"][changed])
    assert np.nanmax(np.abs(off(campaign, spoilt(campaign, "rounded")[1], "mocap", "target.x"))) <= 5.001e-4
    smooth = spoilt(campaign, "smoothed")[1]
    rough = [np.nanstd(np.diff(r[t]["mocap"].value["target.x"], 2)) for r in (plain, smooth) for t in list(plain)[:3]]
    assert max(rough[3:]) < 0.5 * min(rough[:3])
    gaps = spoilt(campaign, "gaps")[1]
    assert 0.03 < np.mean(np.concatenate([r["mocap"].lost for r in gaps.values()])) < 0.2


def test_clocks_ends_labels_and_days(campaign: tuple[Campaign, Readings]) -> None:
    made, clean = campaign
    jitter = spoilt(campaign, "jitter")[1]
    assert all((np.diff(r["mocap"].time) >= 0.0).all() for r in jitter.values())
    forces = [r["force"].value["contact.force"] for r in spoilt(campaign, "clipped")[1].values()]
    top = max(float(np.nanmax(f)) for f in forces)
    assert sum(int((f == top).sum()) for f in forces) > 3
    wrong, readings = spoilt(campaign, "mislabelled")
    differ = [a.id for a, b in zip(made.trials, wrong.trials, strict=True) if a.overrides != b.overrides]
    assert len(differ) == 1
    assert not np.nan_to_num(off(campaign, readings, "force", "contact.force")).any()
    day = spoilt(campaign, "second day")[1]
    peaks = {t: np.nanmax(day[t]["force"].value["contact.force"]) for t in day}
    plain = {t: np.nanmax(r["force"].value["contact.force"]) for t, r in noisy(made, clean).items()}
    ratio = [peaks[t] / plain[t] for t in plain]
    assert ratio[0] == pytest.approx(1.0)
    assert ratio[-1] == pytest.approx(1.05)


def said(**keys: Any) -> dict[str, Any]:
    return {"verdict": "unknown", "effects": [], "confidence": 0.9, **keys}


def test_a_judge_of_spoiled_recordings() -> None:
    friction = {"effect": "coulomb_friction", "where": "wrist", "force_N": 0.3}
    stop = {"effect": "end_stop", "where": "wrist", "parameters": {}}
    own = {**friction, "parameters": {}}
    truth: dict[str, Any] = {"expected": "spoiled", "effects": [friction], "parameters": [], "spoiled": "outliers"}
    assert judge(truth, said(verdict="named", effects=[own])).top
    assert judge(truth, said(spoiled=[{"trial": "01"}])).top
    assert not judge(truth, said()).top
    assert judge(truth, said(verdict="named", effects=[own, stop])).confidently_wrong
    assert judge(truth, said(verdict="nothing_missing")).confidently_wrong
    clean = {**truth, "effects": []}
    assert judge(clean, said(verdict="nothing_missing")).top
    assert judge(clean, said(verdict="named", effects=[own])).confidently_wrong
    day = {**clean, "spoiled": "second day"}
    scale = {"effect": "scale", "where": "force_sensor", "parameters": {}}
    assert judge(day, said(verdict="named", effects=[scale])).top
    unit = {**clean, "spoiled": "sigma of another unit"}
    assert judge(unit, None, "exit 2: the noise of target.x is not what its sigma says").top
    assert not judge(unit, None, "took more than 900 s").top


@pytest.mark.parametrize("number", range(len(RELATIVES)))
@pytest.mark.slow
def test_a_relative_is_hidden_in_its_form(number: int) -> None:
    made = conceal(Order("relative", "rig", number, seed=90 + number))
    effect, where, how = RELATIVES[number]
    (hidden,) = made.campaign.missing
    assert hidden.label == (effect, where)
    assert (hidden.form[0] > 1) == (how == "filter")
    assert bool(hidden.trend) == (how == "trend")
    assert hidden.at(0).values == hidden.values
