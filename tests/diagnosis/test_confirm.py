"""The chosen model as a scene: the whole robot shows what the reduced model does, wherever effects move the touch."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection import confirm as module
from spacerobot.diagnosis.selection.confirm import confirm, difference
from spacerobot.proof.campaign import write_study
from spacerobot.proof.conceal import conceal
from spacerobot.proof.orders import Order
from spacerobot.recordings.study import load_study
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import reduced_start

pytestmark = pytest.mark.slow

LABEL = (("eccentric_contact", "target"),)
OFFSET = "eccentric_contact@target.offset_m"


@pytest.fixture(scope="module")
def spun(tmp_path_factory: pytest.TempPathFactory) -> tuple[Workshop, Fit]:
    """A target that spins, turned when its trial begins, and hit off the point where the study believes."""
    folder: Path = tmp_path_factory.mktemp("spun")
    made = conceal(Order("unlabelled", "spinning", 0, LABEL[0], limits=20.0, seed=5))
    write_study(folder, campaign=made.campaign, readings=made.readings)
    shop = Workshop(load_study(folder))
    fit = shop.run(Task(LABEL, {OFFSET: made.campaign.missing[0].values["offset_m"]}))
    assert fit is not None
    return shop, fit


def test_a_scene_starts_where_the_fit_has_the_trial_start(spun: tuple[Workshop, Fit]) -> None:
    shop, fit = spun
    for trial in shop.trials:
        start = dict(
            zip(
                [(n.coordinate, n.rate) for n in shop.model.nuisances(trial)],
                fit.trials[trial.id].initial,
                strict=True,
            )
        )
        position, velocity = reduced_start(scene_of(shop.study, shop.model, fit, trial.id))
        assert position["target"] == pytest.approx(start["target", False], abs=1e-9)
        assert position["target.yaw"] == pytest.approx(start["target.yaw", False], abs=1e-12)
        assert velocity["target"] == pytest.approx(start["target", True], abs=1e-12)


def test_the_whole_robot_shows_the_same(spun: tuple[Workshop, Fit]) -> None:
    shop, fit = spun
    assert difference(shop, fit, shop.trials[0]) < 0.02
    assert confirm(shop, fit).passed


def test_a_scene_that_starts_elsewhere_is_seen(spun: tuple[Workshop, Fit], monkeypatch: pytest.MonkeyPatch) -> None:
    shop, fit = spun

    def nearer(*args: Any) -> Scene:
        scene = scene_of(*args)
        return replace(scene, target=replace(scene.target, gap=0.95 * scene.target.gap))

    monkeypatch.setattr(module, "scene_of", nearer)
    assert not confirm(shop, fit).passed
