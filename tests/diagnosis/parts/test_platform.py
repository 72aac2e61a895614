"""A floating platform by its momentum: against integrated motion, whatever its joint is called, on any short record."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.measured import port_forces
from spacerobot.diagnosis.machines.platform import STEP, Platform, _integral, _rate
from spacerobot.diagnosis.terms.hypothesis import Site
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


def test_at_their_null_values_effects_change_nothing_and_off_them_a_hose_does(tmp_path: Path) -> None:
    model = made(MACHINES["platform"](tmp_path / "s"))
    trial, sites = model.trials[0], model.sites()
    bare = model.mechanism(model.base, trial)
    start = np.array([0.0, 0.01, 0.0, -0.02, 0.2, 0.05])

    def moved(site: Site, values: Mapping[str, float]) -> float:
        said = model.predict(site.effect.edit(bare, site.where, values), trial, start)
        return max(float(np.abs(a - b).max()) for a, b in zip(said.blocks, plain.blocks, strict=True))

    plain = model.predict(bare, trial, start)
    assert "umbilical" in {s.effect.name for s in sites}
    for site in sites:
        assert moved(site, site.effect.nulls) < 1e-12, site.label
    hose = next(s for s in sites if s.effect.name == "umbilical")
    assert moved(hose, {**hose.effect.nulls, "aside_N": 0.1}) > 0.01


def test_motions_of_unlike_length_are_refused(tmp_path: Path) -> None:
    model = made(MACHINES["platform"](tmp_path / "s"))
    trial = model.trials[0]
    edited = effect("viscous_drag").edit(model.mechanism(model.base, trial), "base", {"coefficient_Ns_m": 1.0})
    with pytest.raises(AssertionError):
        port_forces(edited, {"base": np.zeros(5)}, {"base": np.zeros(9)}, 0.05)


@pytest.mark.parametrize("kept", [2, 3, 4, 9, 21, 60])
def test_the_rate_of_a_cubic_is_exact_up_to_both_ends(kept: int) -> None:
    """Of a record too short for a cubic that of a line, or of a parabola."""
    time = STEP * np.arange(kept)
    cubic = np.polynomial.Polynomial([0.3, -0.2, 0.5, 0.1][: max(min(kept - (kept + 1) % 2, 4), 2)])
    assert np.allclose(_rate(cubic(time)), cubic.deriv()(time), atol=1e-9)


def test_integrals_are_of_fourth_order() -> None:
    def error(count: int) -> float:
        grid = np.linspace(0.0, 2.0, count)
        return float(np.abs(_integral(np.cos(3.0 * grid), grid) - np.sin(3.0 * grid) / 3.0).max())

    assert error(41) < 2e-5
    assert error(41) / error(81) > 8.0  # the slopes at the ends are of third order
