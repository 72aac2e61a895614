"""Glitches, clipped peaks, rounding and noise stated wrongly: found before anything is fitted, and nothing else is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.answer.record import written
from spacerobot.diagnosis.answer.spoiled import CLIPPED, GLITCH, left_out, noise_told
from spacerobot.diagnosis.fitting.glitches import CHANCE, glitches
from spacerobot.diagnosis.fitting.spoiled import clipped, quantum, repeats
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.forward.wrist_rig import WristRig
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.synthetic import FORCE_NOISE, POSITION_NOISE
from spacerobot.support.errors import InputError
from spacerobot.view.report.data_spoiled import spoiled as sentences
from tests.diagnosis.rigs import write_study
from tests.diagnosis.spoil import rewritten, spoiled

FRICTION = "coulomb_friction@wrist.force_N"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Study:
    planted = [("coulomb_friction", "wrist", {"force_N": 0.3})]
    return write_study(tmp_path_factory.mktemp("rig"), planted=planted, truth={"wrist.equivalent_damping": 0.0})


def test_nothing_is_left_out_of_good_recordings(whole: Study) -> None:
    """Touches, peaks and kinks are no glitches, and noise as stated stays as stated."""
    workshop = Workshop(whole)
    assert left_out(whole, workshop.trials) == []
    assert noise_told(whole, workshop.trials) == {}


def test_noise_alone_has_no_glitch() -> None:
    random = np.random.default_rng(3)
    assert sum(glitches(random.standard_normal(5000), 1.0).sum() for _ in range(20)) == 0
    assert CHANCE < 1e-3


@pytest.mark.parametrize("shape", ["kink", "step", "pulse", "swing"])
def test_what_moves_is_no_glitch(shape: str) -> None:
    time = np.arange(400.0)
    random = np.random.default_rng(4)
    moved = {
        "kink": 10.0 * np.maximum(time - 200.0, 0.0),
        "step": 100.0 * (time >= 200.0),
        "pulse": 100.0 * np.sin(np.pi * np.clip((time - 200.0) / 9.0, 0.0, 1.0)),
        "swing": 130.0 * np.sin(0.23 * time),
    }[shape]
    assert not glitches(moved + random.standard_normal(time.size), 1.0).any()


@pytest.mark.parametrize("at", [0, 1, 150, 398, 399])
def test_a_glitch_is_found_wherever_it_is(at: int) -> None:
    time = np.arange(400.0)
    value = 50.0 * np.sin(0.05 * time) + np.random.default_rng(5).standard_normal(time.size)
    value[at] += 40.0
    assert np.flatnonzero(glitches(value, 1.0)).tolist() == [at]


@pytest.mark.parametrize("where", [(200,), (200, 201), (200, 202), (200, 203, 207), (200, 201, 203)])
def test_glitches_close_together_are_told_from_what_is_between(where: tuple[int, ...]) -> None:
    random = np.random.default_rng(9)
    value = 50.0 * np.sin(0.1 * np.arange(400.0)) + random.standard_normal(400)
    value[list(where)] += 25.0 * np.where(np.arange(len(where)) % 2, 1.0, -1.0)
    assert np.flatnonzero(glitches(value, 1.0, pulses=True)).tolist() == list(where)


def test_a_pulse_of_few_readings_is_none() -> None:
    noise = np.random.default_rng(8).standard_normal(400)
    for pulse in ([40.0, 90.0, 40.0], [40.0, 60.0]):
        value = noise.copy()
        value[200 : 200 + len(pulse)] += pulse
        assert not glitches(value, 1.0, pulses=True).any()


def test_a_peak_that_is_cut_off_is_left_out_and_a_high_one_is_not() -> None:
    time = np.arange(300)
    pulse = 30.0 * np.sin(np.pi * np.clip((time - 100) / 40, 0.0, 1.0))
    assert clipped(np.minimum(pulse, 20.0), 0.25).sum() == (pulse >= 20.0).sum()
    assert not clipped(pulse, 0.25).any()
    assert not clipped(np.zeros(300), 0.25).any()  # a sensor that reads nothing is not at its end


def test_rounding_is_seen_where_it_is_coarser_than_the_noise() -> None:
    track = np.linspace(-0.1, 0.02, 500) + 1.5e-4 * np.random.default_rng(6).standard_normal(500)
    assert quantum(np.round(track, 3), 1.5e-4) == pytest.approx(1e-3)
    assert quantum(np.round(track, 3) - 0.0123, 1.5e-4) == pytest.approx(1e-3)
    assert quantum(np.round(track, 5), 1.5e-4) == 0.0
    assert quantum(track, 1.5e-4) == 0.0
    assert repeats(np.array([1.0, 1.0, 2.0, 3.0, 3.0, 3.0])).tolist() == [2.0, 2.0, 1.0, 3.0, 3.0, 3.0]


@pytest.mark.parametrize("way", ["glitch", "outliers", "half", "double", "rounded", "clipped", "cut", "jitter"])
def test_the_friction_is_what_it_is(whole: Study, tmp_path: Path, way: str) -> None:
    study = spoiled(whole, tmp_path / way, way)
    workshop = Workshop(study)
    told, noise = left_out(study, workshop.trials), noise_told(study, workshop.trials)
    expected = {"glitch": {GLITCH}, "outliers": {GLITCH}, "clipped": {CLIPPED}}
    assert {one.why for one in told} >= expected.get(way, set())
    if way in ("half", "double", "jitter"):
        assert told == []
    if way in ("half", "double"):
        assert {n: (f.sigma, f.stated) for n, f in noise.items()}.keys() == {"target.x", "wrist.x", "contact.force"}
        assert noise["wrist.x"].sigma == pytest.approx(POSITION_NOISE, rel=0.3)
        assert noise["contact.force"].sigma == pytest.approx(FORCE_NOISE, rel=0.3)
    if way == "rounded":
        assert noise["target.x"].sigma == pytest.approx(np.hypot(POSITION_NOISE, 1e-3 / np.sqrt(12.0)))
    fit = workshop.run(Task((("coulomb_friction", "wrist"),), {FRICTION: 0.3}))
    assert fit is not None
    assert fit.chi2 < 1.2 * fit.samples
    low, high = fit.errors()[FRICTION]
    assert abs(fit.values()[FRICTION] - 0.3) < 2.0 * (high - low)


def test_as_it_is_stated_the_noise_would_have_been_too_much(whole: Study, tmp_path: Path) -> None:
    """The same fit to readings that nobody looked at: what the cleaning is for."""
    from spacerobot.diagnosis.fitting.gauss_newton import Fitter
    from spacerobot.diagnosis.fitting.starts import fit_from
    from spacerobot.diagnosis.machines.rig_channels import readable
    from spacerobot.diagnosis.machines.wrist_rig import RigModel
    from spacerobot.diagnosis.terms.data import trial_data

    study = spoiled(whole, tmp_path / "outliers", "outliers")
    trials = trial_data(study, readable(study))
    model = RigModel(study, trials)
    sites = Task((("coulomb_friction", "wrist"),), {}).sites(model)
    fit = fit_from(Fitter(model, trials), model.believed, sites, {FRICTION: 0.3})
    assert fit.chi2 > 3.0 * fit.samples


def test_noise_a_thousand_times_off_is_refused(whole: Study, tmp_path: Path) -> None:
    rewritten_study = spoiled(whole, tmp_path / "odd", "none")
    text = rewritten_study.path.read_text()
    rewritten_study.path.write_text(text.replace("sigma = 0.00015", "sigma = 0.15"))
    with pytest.raises(InputError, match=r"noise of (target|wrist)\.x is not what its sigma says"):
        Workshop(load_study(rewritten_study.path))


def test_the_generator_spoils(whole: Study, tmp_path: Path) -> None:
    """Each way changes what is read: a test of friction on whole data would show nothing."""
    copy = spoiled(whole, tmp_path / "copy", "none")
    file = copy.path.parent / copy.trials[0].sources["mocap"].file
    before = file.read_text()
    rewritten(file, lambda t: t * [[1.0, 2.0, 1.0]])
    assert file.read_text() != before


def test_overlay_and_report_say_what_was_left_out(whole: Study, tmp_path: Path) -> None:
    study = spoiled(whole, tmp_path / "glitch", "glitch")
    said = WristRig.of(study).assumptions
    assert any(word.startswith("Left out of target.x in trial 01: 1, beyond") for word in said)
    workshop = Workshop(study)
    verdict = {"spoiled": [written(one) for one in left_out(study, workshop.trials)], "noise": {}}
    assert sentences(verdict) == (f"Left out of target.x: 1 reading {GLITCH} (trial 01).",)
    assert not any("Left out" in word for word in WristRig.of(whole).assumptions)
