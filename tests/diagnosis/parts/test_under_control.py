"""A body that a controller holds against what nobody logged: its commands answer that, and its balances show it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.learning.learned_part import settle_part
from spacerobot.diagnosis.locate.of_model import locate_model
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_air_bed import INERTIAS, NOISE, STEP, head

LIMITS = np.array([0.4, 0.4, 0.02])
STIFF, DAMPED = 0.3, 0.9
"""Of the controller: acceleration over displacement [1/s^2] and over velocity [1/s]."""

WANDER, MEMORY = 0.15, 2.0
"""Of what nobody logged: its rms as a share of the limits, and how long it stays alike [s]."""


def held_in_place(folder: Path, share: float, runs: int = 4, seconds: float = 40.0) -> Study:
    """Runs from a place aside back to the middle, against a force that wanders; `share` of the thrust comes out."""
    random, text = np.random.default_rng(7), [head("An air bed held in place")]
    fine, keep = 0.01, np.exp(-0.01 / MEMORY)
    for run in range(runs):
        place, rate, wander, rows = random.normal(0.0, 0.3, 3), np.zeros(3), np.zeros(3), []
        command = np.zeros(3)
        for step in range(round(seconds / fine)):
            if step % round(STEP / fine) == 0:
                aim = 0.5 * np.sin(0.02 * step * fine * np.array([9.0, 7.0, 5.0]) + run)
                wanted = INERTIAS * (STIFF * (aim - place) - DAMPED * rate)
                if step % round(0.2 / fine) == 0:
                    command = np.clip(wanted, -LIMITS, LIMITS)
                rows.append([step * fine, *(place + NOISE * random.standard_normal(3)), *command])
            wander = keep * wander + np.sqrt(1.0 - keep**2) * WANDER * LIMITS * random.standard_normal(3)
            rate = rate + fine * (share * command + wander) / INERTIAS
            place = place + fine * rate
        np.savetxt(folder / f"{run}.csv", rows, "%.7g", ",", header="t,x,y,yaw,fx,fy,tz", comments="")
        text.append(f'[[trials]]\nid = "r{run}"\nlog = "{run}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)


def judged(study: Study) -> Part:
    (model,) = models_for(study)
    growth = grow(model, effects=[effect(n) for n in ("scale", "coulomb_friction", "viscous_drag", "bias")])
    part = Part(growth, located=locate_model(model, model.trials))
    return settle_part(part, lambda *_: None)


def test_what_commands_bring_is_linear_in_them_though_some_leap_and_some_creep(tmp_path: Path) -> None:
    """Superposition: twice the change of every command is twice the change of every reading."""
    (model,) = models_for(held_in_place(tmp_path, 1.0, runs=1))
    (site,) = (s for s in model.sites([effect("scale")]) if s.where == "command")
    made = hypothesis(model.believed, (site,))
    fitter = Fitter(model, model.trials)
    for trial in model.trials:
        start = np.array([n.guess for n in model.nuisances(trial)])
        shown = [fitter.residual(made, made.start({site.key("factor"): f}), trial, start)[0] for f in (0.9, 1.0, 1.2)]
        np.testing.assert_allclose(shown[2] - shown[1], 2.0 * (shown[1] - shown[0]), atol=1e-3 * np.abs(shown).max())


@pytest.mark.slow
def test_what_a_controller_answers_is_no_force_of_the_body(tmp_path: Path) -> None:
    part = judged(held_in_place(tmp_path, 1.0))
    assert part.striking  # its commands follow what pushed it
    assert part.verdict == "nothing_missing"


@pytest.mark.slow
def test_thrusters_that_are_weak_are_told_from_what_the_controller_answers(tmp_path: Path) -> None:
    part = judged(held_in_place(tmp_path, 0.6))
    assert part.verdict in ("named", "ambiguous")
    assert ("scale", "command") in part.chosen.label
    assert part.fit.values()["scale@command.factor"] == pytest.approx(0.6, rel=0.1)
