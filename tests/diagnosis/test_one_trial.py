"""A knock in one trial: found in that trial alone, with its size and moment, by the diagnosis of a clean campaign."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.selection.one_trial import odd_one_out
from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study
from spacerobot.simulation.rig import rig
from tests.overlay.studies import DATA

TRIAL, MOMENT, IMPULSE = "05", 2.0, -0.05


def test_an_effect_of_one_trial_is_in_no_other() -> None:
    site = Site(effect("external_impulse"), "target", (TRIAL,))
    made = hypothesis(Believed({}, {}, {}, ()), [site, Site(effect("coulomb_friction"), "wrist")])
    values = made.values(made.start())
    plain = rig({})
    assert len(made.edit(plain, values, TRIAL).impulses) == 1
    assert len(made.edit(plain, values, "06").impulses) == 0
    assert len(made.edit(plain, values, "06").frictions) == 1
    assert made.idle(TRIAL) == frozenset()
    assert made.idle("06") == {"external_impulse@target.impulse_Ns", "external_impulse@target.time_s"}


@pytest.mark.parametrize(("levels", "odd"), [((1, 1, 1, 9), "3"), ((1, 1, 1, 1), None), ((1, 9, 1, 9), None)])
def test_the_odd_one(levels: tuple[float, ...], odd: str | None) -> None:
    rng = np.random.default_rng(1)
    trials = tuple(SimpleNamespace(id=str(i)) for i in range(len(levels)))
    left = {str(i): SimpleNamespace(residual=np.sqrt(v) * rng.normal(size=2000)) for i, v in enumerate(levels)}
    found = odd_one_out(SimpleNamespace(trials=left), trials)  # type: ignore[arg-type]
    assert (None if found is None else found.id) == odd


@pytest.mark.slow
@pytest.mark.campaigns
def test_a_knock_is_named(tmp_path: Path) -> None:
    folder = tmp_path / "knocked"
    shutil.copytree(DATA / "clean", folder)
    (folder / "truth.json").unlink(missing_ok=True)
    study = load_study(folder)
    path = folder / f"{TRIAL}_mocap.csv"
    lines = path.read_text(encoding="utf-8").splitlines()
    column = lines[0].split(",").index("x_target_m")
    mass = study.values(study.trial(TRIAL))["target.mass"]
    for i, line in enumerate(lines[1:], start=1):
        cells = line.split(",")
        late = float(cells[0]) - MOMENT  # long after the last contact: nothing else is moved by it
        if late > 0.0:
            cells[column] = f"{float(cells[column]) + IMPULSE / mass * late:.9g}"
        lines[i] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    verdict = diagnose(load_study(folder), jobs=2).verdict
    assert verdict["verdict"] == "named"
    (named,) = verdict["effects"]
    assert (named["effect"], named["where"], named["trials"]) == ("external_impulse", "target", [TRIAL])
    assert named["parameters"]["impulse_Ns"]["value"] == pytest.approx(IMPULSE, rel=0.1)
    assert named["parameters"]["time_s"]["value"] == pytest.approx(MOMENT, abs=0.05)
