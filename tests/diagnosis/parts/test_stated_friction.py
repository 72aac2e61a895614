"""Dry friction that a study states of a joint acts in its baseline; nothing more is asked of what is known already."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.locate.of_model import locate_model
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from tests.overlay.studies import axis_study, write_csv

MASS, DAMPING, FRICTION, FINE = 3.0, 4.0, 1.5, 20


def rubbed(folder: Path, stated: str, horizon: float | None = None) -> Study:
    """A cart on a dry rail under three sines of force, by small steps of its own; what is stated of its friction."""
    axis_study(folder, baseline=f"mass = {MASS}\ndamping = {DAMPING}\n{stated}")
    time, step = np.arange(0.0, 4.0, 1e-3), 1e-3 / FINE
    waves = ((6.0, 0.7, 0.2), (5.0, 1.9, 1.0), (4.0, 4.3, 2.5))
    drive = sum(a * np.cos(2.0 * np.pi * f * time + p) for a, f, p in waves)
    fine = np.interp(np.arange(time.size * FINE) * step, time, drive).tolist()
    place, rate, places = 0.0, 0.0, []
    for number, force in enumerate(fine):
        if number % FINE == 0:
            places.append(place)
        push = force - DAMPING * rate
        if rate == 0.0 and abs(push) <= FRICTION:
            continue
        new = rate + step * (push - FRICTION * float(np.sign(rate or push))) / MASS
        new = 0.0 if rate * new < 0.0 else new
        place, rate = place + 0.5 * step * (rate + new), new
    noise = 1e-6 * np.random.default_rng(0).standard_normal(time.size)
    write_csv(folder / "log.csv", {"t": time, "u": np.asarray(drive), "x": np.array(places) + noise})
    if horizon:
        path = folder / "study.toml"
        path.write_text(path.read_text().replace("title =", f"horizon = {horizon}\ntitle =", 1))
    return load_study(folder)


@pytest.mark.parametrize("horizon", [None, 0.5], ids=["torque", "motion"])
@pytest.mark.parametrize("stated", [f"friction = {FRICTION}", 'friction = "unknown"', ""])
def test_friction_is_missing_only_where_nothing_is_stated_of_it(
    stated: str, horizon: float | None, tmp_path: Path
) -> None:
    (model,) = models_for(rubbed(tmp_path, stated, horizon))
    growth = grow(model, effects=[effect("coulomb_friction"), effect("viscous_friction")], most=2)
    assert growth.after.label == (() if stated else (("coulomb_friction", "joint.slide"),))
    found = {"": "coulomb_friction@joint.slide.force_N"}.get(stated, "joint.slide.friction")
    assert {**model.base, **growth.after.fit.values()}[found] == pytest.approx(FRICTION, rel=2e-3)


@pytest.mark.parametrize("stated", [f"friction = {FRICTION}", 'friction = "unknown"'])
def test_the_overlay_slides_and_sticks(stated: str, tmp_path: Path) -> None:
    study = rubbed(tmp_path / "right", stated)
    (right,) = forward_model(study).simulate(study.trials[0]).channels
    assert np.abs(right.residual).max() < 2e-5
    study = rubbed(tmp_path / "without", "")
    (wrong,) = forward_model(study).simulate(study.trials[0]).channels
    assert np.abs(wrong.residual).max() > 20.0 * np.abs(right.residual).max()


def test_known_friction_is_located_nowhere(tmp_path: Path) -> None:
    shares = {}
    for stated in (f"friction = {FRICTION}", ""):
        (model,) = models_for(rubbed(tmp_path / str(len(stated)), stated, 0.5))
        located = locate_model(model, model.trials)
        assert located is not None
        chi2 = {t.balance: t.chi2 for t in located.totals}
        shares[stated] = chi2["joint.slide"]
    assert shares[f"friction = {FRICTION}"] < 0.05 * shares[""]
