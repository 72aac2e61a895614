"""The wrist rig: every campaign runs, and what a campaign left out is where its residual is."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.residuals import by_channel
from spacerobot.diagnosis.forward.wrist_rig import WristRig
from spacerobot.recordings.study import load_study
from tests.overlay.studies import CAMPAIGNS, DATA, needs_campaigns


@pytest.mark.campaigns
@needs_campaigns
@pytest.mark.parametrize("name", CAMPAIGNS)
def test_every_campaign_is_laid_over_its_recordings(name: str) -> None:
    study = load_study(DATA / name)
    model = forward_model(study)
    assert isinstance(model, WristRig)
    trials = [model.simulate(trial) for trial in study.trials]
    for trial in trials:
        assert {c.channel for c in trial.channels} == set(study.recording(trial.id))
        assert trial.touches, "the target arrives"
        approach = next(c for c in trial.channels if c.channel == "target.x")
        before = approach.time < trial.touches[0] - 0.05
        chi2 = np.mean((approach.residual[before] / approach.sigma) ** 2)
        assert chi2 < 10.0, "the start is the trial's own (drag bends the approach a little)"
    found = by_channel(trials)
    assert found["wrist.x"].chi2_per_sample > 0.8
    assert found["wrist.x"].rms_sigmas < 20


@pytest.mark.campaigns
@needs_campaigns
def test_a_clean_campaign_leaves_less_than_one_with_something_left_out() -> None:
    def worst(name: str, channel: str) -> float:
        study = load_study(DATA / name)
        model = forward_model(study)
        return by_channel([model.simulate(t) for t in study.trials])[channel].rms_sigmas

    for name, channel in (("guide-friction", "target.x"), ("end-stop", "wrist.x"), ("hardening-spring", "wrist.x")):
        assert worst(name, channel) > 1.5 * worst("clean", channel), name


def test_what_the_study_does_not_say_is_said() -> None:
    model = forward_model(load_study("guide-friction"))
    (damping,) = [v for v in model.values if v.name == "contact.damping"]
    assert damping.source.startswith("default")
    assert any("contact.damping is not stated: 40 N s/m" in text for text in model.assumptions)
