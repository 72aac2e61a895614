"""A driven axis simulated in windows: a planted spring comes back, and a real circuit's."""

from __future__ import annotations

import numpy as np
import pytest
from helpers_models import real_study
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.machines.axis import axis
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import Drive, band_limited, commanded, cut, local, refinement
from spacerobot.diagnosis.selection.held_out import folds, predict_held_out
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, hypothesis
from spacerobot.effects.primitives import ChannelMap
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.sensors import read_channels

NAME = "joint.axis"
TRUE = {f"{NAME}.mass": 2.0, f"{NAME}.damping": 3.0, f"{NAME}.stiffness": 800.0}


def duffing(k3: float, noise: float) -> Simulated:
    """Twelve seconds of an axis on a spring with a cubic part, driven by a multisine."""
    build = axis("axis", "box", angular=False)
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 12.0, 0.005)
    phases = rng.uniform(0, 2 * np.pi, 20)
    drive = sum(3.0 * np.cos(2 * np.pi * f * time + p) for f, p in zip(np.linspace(0.5, 8, 20), phases, strict=True))
    block = Block("box", (f"{NAME}.position",), time, np.zeros((1, time.size)), np.ones((1, time.size)))
    blank = TrialData("run", "all", {}, (block,), 0.0, float(time[-1]))
    plain = build(TRUE, blank)
    full = effect("cubic_stiffness").edit(plain, NAME, {"k3_N_m3": k3})
    fine, value = band_limited(time, drive, 4)
    run = simulate(
        full, start=0.0, end=float(time[-1]) + 1e-9, inputs=(fine, {f"{NAME}.torque": value}), max_step=0.005
    )
    x = read_channels(run, full, [f"{NAME}.position"], time)[f"{NAME}.position"]
    sizes = sizes_of(drive, x, np.gradient(x, time))
    weight = np.full((1, time.size), 1.0 / noise)
    seen = TrialData(
        "run",
        "all",
        {},
        (Block("box", block.channels, time, (x + noise * rng.standard_normal(x.size))[None], weight),),
        0.0,
        float(time[-1]),
    )
    unknown = {k: 0.7 * v for k, v in TRUE.items()}
    drives = {"run": Drive(fine, {f"{NAME}.torque": value})}
    return Simulated(
        "axis",
        build,
        [seen],
        drives,
        believed=Believed({}, {}, {}, ("all",), unknown),
        sizes={"": sizes},
        window=1.0,
        budget=1500,
    )


@settings(max_examples=5, deadline=None)
@given(st.floats(0.05, 40.0), st.floats(-2.0, 2.0))
def test_an_axis_moves_alike_in_whatever_unit_its_drive_is_logged(gain: float, bias: float) -> None:
    """A stated motor constant and zero undo what the log did to the drive; a wrong one moves it elsewhere."""
    time = np.arange(0.0, 1.0, 0.005)
    drive = 3.0 * np.cos(9.0 * time)
    block = Block("box", (f"{NAME}.position",), time, np.zeros((1, time.size)), np.ones((1, time.size)))
    trial = TrialData("run", "all", {}, (block,), 0.0, 1.0)

    def moved(log: np.ndarray, **said: float) -> np.ndarray:
        made = axis("axis", "box", angular=False)({**TRUE, **{f"{NAME}.{k}": v for k, v in said.items()}}, trial)
        run = simulate(made, start=0.0, end=1.0, inputs=(time, {f"{NAME}.torque": log}), max_step=0.005)
        return read_channels(run, made, [f"{NAME}.position"], time)[f"{NAME}.position"]

    true, log = moved(drive), (drive + bias) / gain
    size = float(np.abs(true).max())
    np.testing.assert_allclose(moved(log, gain=gain, bias=bias), true, atol=1e-4 * size)
    assert np.abs(moved(log, gain=1.3 * gain, bias=bias) - true).max() > 0.05 * size


def test_a_planted_cubic_spring_comes_back() -> None:
    model = duffing(4e5, 2e-5)
    site = next(s for s in model.sites() if s.label == ("cubic_stiffness", NAME))
    plain = Fitter(model, model.trials).fit(hypothesis(model.believed, []))
    fit = Fitter(model, model.trials).fit(
        hypothesis(model.believed, [site]), warm=plain.values(), initials=plain.initials()
    )
    assert plain.chi2 > 3.0 * plain.samples
    assert fit.chi2 / fit.samples == pytest.approx(1.0, abs=0.15)
    found = fit.values()
    assert found[f"cubic_stiffness@{NAME}.k3_N_m3"] == pytest.approx(4e5, rel=0.03)
    for name, value in TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.02)


def test_windows_cover_a_trial_and_start_where_it_is() -> None:
    model = duffing(0.0, 1e-6)
    whole = model.recorded["run"]
    windows = cut(whole, 1.0)
    assert len(windows) == 12
    assert sum(w.samples for w in windows) >= whole.samples - 12
    for nuisance in model.nuisances(windows[5]):
        assert abs(nuisance.guess) < (1.0 if nuisance.rate else 0.05)
    assert len(cut(whole, np.inf)) == 1


def test_local_readings_know_their_error() -> None:
    t = np.linspace(0, 1, 101)
    rng = np.random.default_rng(0)
    errors = []
    for _ in range(300):
        found = local(t, np.sin(t) + 0.01 * rng.standard_normal(t.size), 0.5, 0.1)
        value, slope = found.value - np.sin(0.5), found.slope - np.cos(0.5)
        errors.append([value / found.value_sigma, slope / found.slope_sigma])
    assert np.std(errors, axis=0) == pytest.approx([1.0, 1.0], abs=0.2)


def test_drives_between_their_readings() -> None:
    t = np.arange(200) * 0.1
    signal = np.sin(2.0 * np.pi * 2.0 * t)
    fine, value = band_limited(t, signal, 8)
    inner = (fine > 2.0) & (fine < 17.0)
    assert np.abs(value - np.sin(2.0 * np.pi * 2.0 * fine))[inner].max() < 0.02
    assert refinement(signal) > 1
    assert refinement(np.sin(0.05 * t)) == 1


def test_commands_hold_until_the_next_one() -> None:
    t = np.arange(200) * 0.1
    leaping = np.sign(np.sin(2.0 * np.pi * 0.26 * t + 0.1))
    drive = commanded({"f": (t, leaping), "g": (t[::2], np.ones(100))})
    leap = int(np.flatnonzero(np.diff(leaping))[0])
    assert np.interp(t[leap] + 0.0999, drive.time, drive.value["f"]) == leaping[leap]
    assert np.interp(t[leap] + 0.1001, drive.time, drive.value["f"]) == leaping[leap + 1]
    assert np.count_nonzero(np.diff(leaping)) == (drive.jumps.size - 2) / 2
    # a slow command pushes as much as its steps do, and no integrator has to stop for it
    slow = np.sin(2.0 * np.pi * 0.02 * t)
    smooth = commanded({"f": (t, slow)})
    assert smooth.jumps.size == 2
    pushed = np.trapezoid(smooth.value["f"], smooth.time)
    assert pushed == pytest.approx(0.1 * slow.sum(), rel=1e-3)


def test_a_late_command_is_the_same_command_later() -> None:
    t = np.arange(50) * 0.1
    drive = commanded({"f": (t, np.where(t > 2.0, 1.0, 0.0))})
    late = drive.through((ChannelMap("f", "delay", 0.03), ChannelMap("f", "gain", 2.0)), 0.0, 5.0)
    np.testing.assert_allclose(late.time - drive.time, 0.03, atol=1e-12)
    np.testing.assert_allclose(late.jumps - drive.jumps, 0.03, atol=1e-12)
    np.testing.assert_array_equal(late.value["f"], 2.0 * drive.value["f"])


@pytest.mark.real
def test_silverbox_has_a_cubic_spring() -> None:
    """Wigren and Schoukens built it as a Duffing oscillator: held-out error falls to a third, with its offset."""
    (model,) = models_for(real_study("silverbox"))
    assert isinstance(model, Simulated)
    few = tuple(t for i, t in enumerate(model.trials) if i % 4 == 0)
    by = {s.label: s for s in model.sites()}
    errors = []
    start: dict[str, float] = {"joint.axis.mass": 5.4e-6, "joint.axis.damping": 2.2e-4, "joint.axis.stiffness": 1.0}
    for names in ((), ("cubic_stiffness", "preload")):
        made = hypothesis(model.believed, [by[(n, "joint.axis")] for n in names])
        fit = Fitter(model, few).fit(made, warm=start, max_iterations=12)
        held_out = predict_held_out(model, few, made, fit.values(), folds(few), fit.initials())
        errors.append(held_out.mean_square**0.5)
    assert errors[1] < 0.35 * errors[0]
