"""A floating platform by its momentum: against integrated motion, whatever its joint is called, on any short record."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.measured import port_forces
from spacerobot.diagnosis.machines.platform import SMOOTH, STEP, Platform, _smoothed
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study
from tests.door.machines import MACHINES, rows


def made(folder: Path) -> Platform:
    (model,) = some_models_for(load_study(folder))
    assert isinstance(model, Platform)
    return model


def turning_on_and_on(folder: Path) -> Path:
    """The platform whose joint has no limits."""
    study = MACHINES["platform"](folder)
    path = study / "floater.urdf"
    head, _, rest = path.read_text().partition('type="revolute"')
    before, _, after = rest.partition("<limit")
    path.write_text(f'{head}type="continuous"{before}{after.partition("/>")[2]}')
    return study


def tracks(model: Platform) -> np.ndarray:
    trial = model.trials[0]
    start = np.array([0.0, 0.01, 0.0, -0.02, 0.2, 0.05])
    said = model.predict(model.mechanism(model.base, trial), trial, start)
    return np.array([v[0] for v in said.blocks])


def test_a_joint_without_limits_moves_the_base_as_one_with_limits(tmp_path: Path) -> None:
    limited, endless = made(MACHINES["platform"](tmp_path / "a")), made(turning_on_and_on(tmp_path / "b"))
    assert np.ptp(tracks(limited)[2]) > 0.1
    assert np.abs(tracks(endless) - tracks(limited)).max() < 1e-12


def test_both_ways_to_momentum_say_the_same(tmp_path: Path) -> None:
    """The diagnosis evaluates the balance in the plane; the overlay integrates the whole robot's motion."""
    folder = turning_on_and_on(tmp_path / "s")
    study, model = load_study(folder), made(folder)
    over = forward_model(study).simulate(study.trials[0])
    data = study.recording(study.trials[0])
    shown = {c.channel: c.residual + data[c.channel].value for c in over.channels}
    trial = model.trials[0]
    place = {c: shown[c][0] for c in shown}
    rate = {c: np.polyfit(data[c].time[:30], shown[c][:30], 1)[0] for c in shown}
    start = np.array([x for c in ("base.position.x", "base.position.y", "base.yaw") for x in (place[c], rate[c])])
    said = model.predict(model.mechanism(model.base, trial), trial, start)
    for block, value in zip(trial.blocks, said.blocks, strict=True):
        channel = block.channels[0]
        assert np.ptp(shown[channel]) > 0.01
        assert np.abs(value[0] - shown[channel]).max() < 0.01 * np.ptp(shown[channel]), channel


@pytest.mark.parametrize("kept", [2, 5, 9, 21])
def test_effects_are_evaluated_on_records_shorter_than_what_smooths_them(kept: int, tmp_path: Path) -> None:
    """Compiled code writes where it is told to: a rate longer than its record ended in an abort."""
    folder = MACHINES["platform"](tmp_path / "s")
    rows(0, kept)(folder)
    model = made(folder)
    for trial in model.trials:
        places, rates = model._seen[trial.id]
        assert {v.shape for v in (*places.values(), *rates.values())} == {model._grid[trial.id].shape}
        for name in ("viscous_drag", "quadratic_drag"):
            bare = model.mechanism(model.base, trial)
            edited = effect(name).edit(bare, "base", {p.name: 2.0 for p in effect(name).parameters})
            start = np.array([0.0, 0.01, 0.0, 0.0, 0.0, 0.0])
            for value in model.predict(edited, trial, start).blocks:
                assert np.isfinite(value).all()


def test_motions_of_unlike_length_are_refused(tmp_path: Path) -> None:
    model = made(MACHINES["platform"](tmp_path / "s"))
    trial = model.trials[0]
    edited = effect("viscous_drag").edit(model.mechanism(model.base, trial), "base", {"coefficient_Ns_m": 1.0})
    with pytest.raises(AssertionError):
        port_forces(edited, {"base": np.zeros(5)}, {"base": np.zeros(9)}, 0.05)


def test_a_mean_at_the_ends_is_of_what_there_is() -> None:
    """What is even stays even up to both ends; a mean over more than the record is that of the record."""
    assert np.allclose(_smoothed(np.full(50, 3.0), SMOOTH), 3.0)
    line = np.arange(50.0)
    beside = int(0.5 * SMOOTH / STEP)
    assert np.allclose(_smoothed(line, SMOOTH)[beside:-beside], line[beside:-beside])
    assert np.allclose(_smoothed(np.array([1.0, 2.0, 6.0]), SMOOTH), 3.0)
