"""The rig as fits run it: which way gravity pulls, how long a trial lasts, which force samples count."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.machines.contract import Predicted
from spacerobot.diagnosis.machines.rig_trials import ONSET_MASK, counted
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import Block, TrialData, trial_data
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study
from spacerobot.simulation.rig import rig
from tests.diagnosis.rigs import BELIEVED, write_study

RIG = {**BELIEVED, "target.mass": 9.0, "wrist.equivalent_damping": 5.0, "contact.damping": 60.0}


@pytest.mark.parametrize("pull", [0.05, -0.02])
@pytest.mark.parametrize("ahead", [1, -1])
def test_gravity_along_the_approach_brings_the_target(tmp_path: Path, pull: float, ahead: int) -> None:
    """x grows along the approach: before the touch x = x0 + v t + g.a t^2 / 2."""
    write_study(tmp_path, masses=(9.0,), speeds=(0.06,))
    file = tmp_path / "study.toml"
    text = file.read_text()
    assert "approach = [1, 0, 0]" in text
    assert "gravity = [0, 0, 0]" in text
    text = text.replace("approach = [1, 0, 0]", f"approach = [{ahead}, 0, 0]")
    file.write_text(text.replace("gravity = [0, 0, 0]", f"gravity = [{pull}, 0, 0]"))
    study = load_study(tmp_path)
    trials = trial_data(study)
    model = RigModel(study, trials)
    (trial,) = trials
    initial = np.array([0.06 if n.rate else -0.02 for n in model.nuisances(trial)])
    shown = model.predict(model.mechanism({**model.base, **trial.overrides}), trial, initial)
    block = next(b for b in trial.blocks if "target.x" in b.channels)
    free = block.time < 0.2
    t = block.time[free] - trial.start
    x = shown.blocks[trial.blocks.index(block)][block.channels.index("target.x")][free]
    np.testing.assert_allclose(x, -0.02 + 0.06 * t + 0.5 * ahead * pull * t**2, atol=1e-9)


@pytest.mark.parametrize("short", ["mocap", "force"])
def test_a_trial_lasts_as_long_as_any_of_its_streams(tmp_path: Path, short: str) -> None:
    study = write_study(tmp_path, masses=(9.0,), speeds=(0.06,))
    whole = trial_data(study)[0]
    file = tmp_path / f"00_{short}.csv"
    lines = file.read_text().splitlines()
    file.write_text("\n".join([lines[0], *lines[len(lines) // 4 : len(lines) // 2]]) + "\n")
    (cut,) = trial_data(load_study(tmp_path))
    other = next(b for b in whole.blocks if b.stream != short)
    assert (cut.start, cut.end) == (other.time[0], other.time[-1])


@given(st.lists(st.floats(0.01, 0.09), min_size=1, max_size=3), st.sampled_from([0.0, 2e-3, -1.5e-3]))
def test_forces_are_left_out_about_each_touch_as_their_sensor_sees_it(touches: list[float], late: float) -> None:
    time = np.arange(1000) * 1e-4
    slow = np.arange(10) * 1e-2
    blocks = (
        Block("mocap", ("target.x",), slow, np.zeros((1, 10)), np.ones((1, 10))),
        Block("force", ("contact.force",), time, np.zeros((1, 1000)), np.ones((1, 1000))),
    )
    trial = TrialData("t", "c", {}, blocks, 0.0, 0.1)
    mechanism = effect("time_offset").apply(rig(RIG), "force_sensor", {"delay_s": late})
    keep = counted(mechanism, trial, Predicted((), tuple(touches)))
    assert keep[:10].all()
    apart = np.abs(time[:, None] - (np.array(touches) + late)).min(axis=1)
    sure = np.abs(apart - ONSET_MASK) > 1e-9
    assert np.array_equal(keep[10:][sure], (apart > ONSET_MASK)[sure])
    by_its_clock = counted(rig(RIG), trial, Predicted((), tuple(touches), (0.0, late)))
    assert np.array_equal(by_its_clock, keep)


def test_sizes_are_alike_whatever_reads_the_wrist(tmp_path: Path) -> None:
    """From its marker, from the force alone, from the target's speed where neither is read; a spring not stated too."""
    write_study(tmp_path)
    path = tmp_path / "study.toml"
    whole = path.read_text()
    blind = re.sub(r"(?m)^x_wrist_m = .*\n", "", whole)
    numb = re.sub(
        r"(?m)^force = .*\n", "", re.sub(r"\[streams\.force\]\n(?:[^\[].*\n|\[streams\.force\..*\n)*", "", blind)
    )
    springless = re.sub(r'(?m)^(stiffness = 1020.*|"wrist.stiffness" = .*)\n', "", numb)
    found = []
    for text in (whole, blind, numb, springless):
        path.write_text(text)
        study = load_study(tmp_path)
        found.append(RigModel(study, trial_data(study)).size_at("wrist"))
    for size in found[1:3]:
        assert size.length == pytest.approx(found[0].length, rel=0.3)
        assert size.time == pytest.approx(found[0].time, rel=0.3)
    assert found[3].force == pytest.approx(found[0].force, rel=0.9)
