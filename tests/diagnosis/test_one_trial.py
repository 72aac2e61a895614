"""A knock in one trial: found in that trial alone, with its size and moment, by the diagnosis of a clean campaign."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.one_trial import knocks
from spacerobot.diagnosis.selection.search import search
from spacerobot.diagnosis.selection.search_state import silent
from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import load_study
from spacerobot.simulation.rig import rig
from tests.diagnosis.rigs import write_study
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


def test_a_knock_is_sought_although_a_law_for_all_trials_leaves_little(tmp_path: Path) -> None:
    """Diluted in the other trials' readings, all that it leaves over without it is less than noise may."""
    knock = ("external_impulse", "target", {"impulse_Ns": 0.04, "time_s": 0.5})
    study = write_study(tmp_path, masses=(9.0, 23.2, 51.0), speeds=(0.05, 0.065, 0.08, 0.1), alone={"23": [knock]})
    workshop = Workshop(study)
    law, own = ("cubic_stiffness", "wrist"), ("external_impulse", "target")
    sites = [workshop.model.site(effect(name), where) for name, where in (law, own)]
    with Pool(workshop, 1) as pool:
        found = search(pool, sites, silent)
    assert found.explains(found.baseline)
    chosen = found.preferred([found.baseline, *found.fits.values()])
    assert chosen.hypothesis.label == (own,)
    assert chosen.hypothesis.only == ((own, ("23",)),)
    assert chosen.values()["external_impulse@target.impulse_Ns"] == pytest.approx(0.04, rel=0.2)


def test_no_knock_is_sought_where_noise_alone_is_left(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path))
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    site = workshop.model.site(effect("external_impulse"), "target")
    assert not knocks(workshop.fitter(), workshop.model.believed, baseline, [site])


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


@pytest.mark.parametrize("stated", [8.98, 8.94])
def test_a_target_weighed_a_little_wrong_is_no_knock(stated: float, tmp_path: Path) -> None:
    """A target that is in no other trial: its mass may be off within what is stated of it, in that trial alone."""
    study = write_study(tmp_path, masses=(9.0, 15.0, 23.2, 51.0), speeds=(0.1,), tracking=2e-5)
    text = study.path.read_text()
    study.path.write_text(text.replace("target.mass = 9\n", f"target.mass = {stated}\n", 1))
    right, wrong = Workshop(study), Workshop(load_study(tmp_path))
    fits = [shop.run(Task((), {})) for shop in (right, wrong)]
    assert fits[0] is not None
    assert fits[1] is not None
    assert fits[1].cost > fits[0].cost + 60.0  # a knock would earn its place
    site = wrong.model.site(effect("external_impulse"), "target")
    assert not knocks(wrong.fitter(), wrong.model.believed, fits[1], [site])
