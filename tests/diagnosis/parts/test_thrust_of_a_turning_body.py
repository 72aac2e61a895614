"""Commands along a body's own axes, held while it turns; and knocks beside thrusters that switch."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import split
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.stretches import bends, momentary
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_air_bed import HELD, INERTIAS, LEVELS, head

SECONDS, NOISE, CAMERA, COMMAND = 12.0, 1e-4, 0.05, 0.1
"""Length of a run [s], of the camera [m, rad], and steps of the logs [s]."""


def turning(folder: Path, knock: float = 0.0, runs: int = 3) -> Study:
    """Runs of a body that spins while its thrusters hold along its axes; in the second one it may be knocked.

    Args:
        folder: of the study.
        knock: when [s]; not at all where nothing.
        runs: how many.
    """
    random = np.random.default_rng(3)
    own = 'use = "input", frame = "body"'
    text = head("A spinning air bed").replace('force.x", use = "input"', f'force.x", {own}')
    text = text.replace('force.y", use = "input"', f'force.y", {own}')
    sides = '[streams.command]\ntime = "t"\n[streams.command.channels]\nfx'
    text = text.replace("fx", sides, 1)
    for run in range(runs):
        level = random.choice([-1.0, 0.0, 1.0], (round(SECONDS / HELD) + 1, 3)) * LEVELS
        state = np.array([0.0, 0.0, 0.0, 0.05, -0.03, 0.5 + 0.2 * run])
        time, shown = np.arange(0.0, SECONDS, CAMERA), []

        def rate(_: float, y: np.ndarray, command: np.ndarray) -> np.ndarray:
            cos, sin = np.cos(y[2]), np.sin(y[2])
            force = [cos * command[0] - sin * command[1], sin * command[0] + cos * command[1], command[2]]
            return np.concatenate([y[3:], np.array(force) / INERTIAS])

        for k in range(round(SECONDS / HELD)):
            begin = k * HELD
            struck = run == 1 and begin < knock <= begin + HELD
            ends = [knock, begin + HELD] if struck and knock < begin + HELD else [begin + HELD]
            for end in ends:
                some = time[(time >= begin - 1e-9) & (time < end - 1e-9)]
                at = np.append(some, end)
                found = solve_ivp(rate, (begin, end), state, "RK45", at, args=(level[k],), rtol=1e-10, atol=1e-12)
                shown.append(found.y[:3, :-1].T)
                state, begin = found.y[:, -1].copy(), end
                if struck and end == knock:
                    state[3:] += [0.01, -0.02, 0.03]
        seen = np.concatenate(shown) + NOISE * random.standard_normal((time.size, 3))
        np.savetxt(folder / f"{run}.csv", np.column_stack([time, seen]), "%.8g", ",", header="t,x,y,yaw", comments="")
        ticks = np.arange(0.0, SECONDS, COMMAND)
        logged = np.column_stack([ticks, level[(ticks / HELD + 1e-9).astype(int)]])
        np.savetxt(folder / f"{run}u.csv", logged, "%.8g", ",", header="t,fx,fy,tz", comments="")
        text += f'[[trials]]\nid = "r{run}"\nlog = "{run}.csv"\ncommand = "{run}u.csv"\n'
    (folder / "study.toml").write_text(text)
    return load_study(folder)


def baseline(study: Study) -> tuple[Bench, Growth]:
    (model,) = models_for(study)
    bench = Bench(model)
    fit = bench.baseline()
    bench.weigh(fit)
    grown = SimpleNamespace(bench=bench, after=SimpleNamespace(fit=bench.again(fit)))
    return bench, cast(Growth, grown)


def test_held_along_the_body_s_axes_thrust_leaves_the_camera_s_noise_and_no_more(tmp_path: Path) -> None:
    """Turned into the world where they begin to hold, forces would be late by half a step: far above that noise."""
    (model,) = models_for(turning(tmp_path))
    made = hypothesis(model.believed, ())
    fit = Fitter(model, model.trials).fit(made)
    for trial in model.trials:
        for channel, left in split(fit.trials[trial.id].residual, trial).items():
            assert np.sqrt(np.mean((left / trial.channel(channel)[2]) ** 2)) == pytest.approx(NOISE, rel=0.15)


@pytest.mark.parametrize("knock", [4.3, 7.0])
def test_a_knock_is_found_while_thrusters_switch_and_when_one_does(knock: float, tmp_path: Path) -> None:
    """The others' changes leave no corner: what bends one track at one of them is no fault of the drive."""
    bench, growth = baseline(turning(tmp_path, knock))
    found = bends(growth, momentary(all_effects().values(), bench.model))
    assert list(found) == ["r1"]
    (moment,) = found["r1"]
    assert moment.low - CAMERA < knock < moment.high + CAMERA


def test_a_knock_at_a_window_s_end_is_found_as_any_other(tmp_path: Path) -> None:
    """No corner can be told from the start of the window that it lies in."""
    turning(tmp_path, 6.1)
    text = (tmp_path / "study.toml").read_text()
    (tmp_path / "study.toml").write_text(text.replace("[baseline]", "horizon = 6.0\n[baseline]", 1))
    bench, growth = baseline(load_study(tmp_path))
    assert any(t.start == pytest.approx(6.0, abs=0.1) for t in bench.model.everything().trials)
    found = bends(growth, momentary(all_effects().values(), bench.model))
    assert [round(m.time, 1) for m in found["r1"]] == [6.1]


def test_where_thrusters_are_weak_every_change_bends_the_track_and_none_is_a_knock(tmp_path: Path) -> None:
    folder = tmp_path / "weak"
    folder.mkdir()
    turning(folder)
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace(", frame", ", scale = 1.5, frame"))
    bench, growth = baseline(load_study(folder))
    assert not bends(growth, momentary(all_effects().values(), bench.model))
